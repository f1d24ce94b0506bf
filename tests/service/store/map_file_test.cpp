#include "store/map_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <planemap/block.hpp>
#include <planemap/mapper.hpp>
#include <random>

#include "small_maps.hpp"
#include "store/map_reader.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::service {
namespace {

class MapFiles : public ::testing::Test {
 protected:
  /// A small map that was closed in good order.
  Snapshot closed_map(int scans = 4) {
    Mapper mapper({}, 77);
    auto file = MapFile::create(path_, {"hall", "0 0 -1", "config", ""});
    EXPECT_TRUE(file) << file.error().message;
    for (int i = 0; i < scans; ++i) {
      look(mapper, i);
      EXPECT_TRUE(file->commit(mapper.snapshot()));
    }
    const auto map = mapper.snapshot();
    EXPECT_TRUE(file->close(map));
    return map;
  }

  /// One of large cells.
  Snapshot closed_small_map() {
    MapperConfig config;
    config.grid.cell_size_m = 0.25;
    auto map = looked_around(77, 2, config);
    EXPECT_GE(map->planes().size(), 3u);
    EXPECT_TRUE(write_map_file(path_, {"hall", "0 0 -1", "config", ""}, map));
    return map;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "m.planemap";
};

TEST_F(MapFiles, KeepCellsPlanesAndFacts) {
  const auto map = closed_map();
  ASSERT_GE(map->planes().size(), 3u);
  const auto read = MapFile::read(path_);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(essence(*read->snapshot) == essence(*map));
  EXPECT_EQ(read->facts.frame, "hall");
  EXPECT_EQ(read->facts.gravity, "0 0 -1");
  EXPECT_TRUE(read->closed);
  for (std::size_t i = 0; i < map->planes().size(); ++i) {
    EXPECT_EQ(read->snapshot->planes()[i]->covariance, map->planes()[i]->covariance);
    EXPECT_EQ(read->snapshot->planes()[i]->plane.normal(), map->planes()[i]->plane.normal());
    EXPECT_EQ(read->snapshot->planes()[i]->plane.d(), map->planes()[i]->plane.d());
  }
  std::printf("%.1f B a cell, %zu cells\n",
              static_cast<double>(std::filesystem::file_size(path_)) / static_cast<double>(map->cell_count()),
              map->cell_count());
}

TEST_F(MapFiles, WriteOnlyWhatChanged) {
  Mapper mapper({}, 5);
  auto file = MapFile::create(path_, {});
  ASSERT_TRUE(file);
  for (int i = 0; i < 3; ++i) look(mapper, i);
  const auto map = mapper.snapshot();
  const auto first = file->commit(map);
  ASSERT_TRUE(first);
  EXPECT_GE(*first, map->block_count() + map->planes().size());
  EXPECT_EQ(file->commit(mapper.snapshot()).value(), 0u);
  EXPECT_TRUE(essence(*MapFile::read(path_)->snapshot) == essence(*map));  // while it is open
}

TEST_F(MapFiles, GoOnBehindWhatWasReserved) {
  Mapper mapper({}, 5);
  look(mapper, 0);
  const auto map = mapper.snapshot();
  {
    auto file = MapFile::create(path_, {});
    ASSERT_TRUE(file->commit(map));
  }  // not closed
  auto opened = MapFile::open(path_);
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_FALSE(opened->map.closed);
  const auto parts = opened->map.continued();
  EXPECT_EQ(parts.epoch, 5u);
  EXPECT_GE(parts.state.next_plane_id, map->state().next_plane_id + 512);
  EXPECT_GT(parts.revision, map->revision() + 30000);
  EXPECT_EQ(parts.removed_complete_since, parts.revision);
  // In good order nothing is skipped.
  ASSERT_TRUE(opened->file.close(map));
  const auto closed = MapFile::read(path_);
  ASSERT_TRUE(closed);
  EXPECT_EQ(closed->continued().state.next_plane_id, map->state().next_plane_id);
  EXPECT_EQ(closed->continued().revision, map->revision());
}

TEST_F(MapFiles, ANewEpochReplacesTheMap) {
  closed_map();
  auto opened = MapFile::open(path_);
  ASSERT_TRUE(opened);
  Mapper next({}, 78);
  look(next, 0);
  const auto map = next.snapshot();
  ASSERT_TRUE(opened->file.close(map));
  EXPECT_TRUE(essence(*MapFile::read(path_)->snapshot) == essence(*map));
}

TEST_F(MapFiles, OfANewerFormatAreRefused) {
  closed_map();
  {
    Database database(path_, Database::Access::kWrite);
    database.execute("PRAGMA user_version=2; UPDATE meta SET value='2' WHERE key='format'");
  }
  const auto read = MapFile::open(path_);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, StoreError::Kind::kNewer);
  EXPECT_NE(read.error().message.find("was written by a newer planemap (format 2, this one knows up to 1)"),
            std::string::npos);
}

TEST_F(MapFiles, OfOthersAreLeftAlone) {
  { Database(path_, Database::Access::kCreate).execute("CREATE TABLE bills (euros)"); }
  const auto read = MapFile::open(path_);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, StoreError::Kind::kOther);
  EXPECT_EQ(MapFile::open(folder_ / "none").error().kind, StoreError::Kind::kSystem);
}

TEST_F(MapFiles, EveryTruncationIsSeen) {
  closed_small_map();
  const auto whole = std::filesystem::file_size(path_);
  for (std::uintmax_t size = whole; size-- > 0;) {
    std::filesystem::resize_file(path_, size);
    const auto read = MapFile::read(path_);
    ASSERT_FALSE(read) << size << " of " << whole << " B were taken for a map";
    ASSERT_EQ(read.error().kind, StoreError::Kind::kDamaged) << size << " of " << whole << ": " << read.error().message;
    ASSERT_FALSE(read.error().message.empty());
  }
}

TEST_F(MapFiles, NoFlippedBitMakesAnotherMap) {
  const std::string good = essence(*closed_small_map());
  const std::uint64_t bits = 8 * std::filesystem::file_size(path_);
  constexpr int kFlips = 10'000;
  std::mt19937_64 random(11);
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  const auto flip = [&](std::uint64_t bit) {
    const auto at = static_cast<std::streamoff>(bit / 8);
    file.seekg(at);
    const auto byte = static_cast<char>(file.get() ^ (1 << (bit % 8)));
    file.seekp(at);
    file.put(byte).flush();
  };
  int seen = 0;
  for (int i = 0; i < kFlips; ++i) {
    const std::uint64_t bit = random() % bits;
    flip(bit);
    const auto read = MapFile::read(path_);
    flip(bit);
    if (!read) ++seen;
    if (read) {
      ASSERT_TRUE(essence(*read->snapshot) == good) << "bit " << bit;
    }
  }
  EXPECT_GT(seen, kFlips / 2) << "what is left over in pages does not matter";
  EXPECT_TRUE(MapFile::read(path_));
  std::printf("%llu B; %d of %d flipped bits were of no importance\n", static_cast<unsigned long long>(bits / 8),
              kFlips - seen, kFlips);
}

TEST_F(MapFiles, RecoveryTakesWhatIsWhole) {
  const auto map = closed_map();
  {
    Database database(path_, Database::Access::kWrite);
    database.execute(
        "UPDATE block SET checksum=checksum+1 WHERE slot=3; DELETE FROM block WHERE slot=5;"
        "UPDATE plane SET checksum=0 WHERE id=1");
  }
  const auto read = MapFile::read(path_);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, StoreError::Kind::kDamaged);
  const auto recovered = recover_map(path_);
  ASSERT_TRUE(recovered) << recovered.error().message;
  EXPECT_EQ(recovered->lost_blocks, 2u);
  EXPECT_EQ(recovered->lost_planes, 1u);
  EXPECT_EQ(recovered->map.snapshot->block_count(), map->block_count() - 2);
  EXPECT_EQ(recovered->map.snapshot->planes().size(), map->planes().size() - 1);
  EXPECT_TRUE(Mapper::restore({}, *recovered->map.snapshot));
}

TEST_F(MapFiles, WhatCannotBeWrittenIsSaid) {
  const auto map = closed_map();
  const auto file = MapFile::create(folder_ / "nowhere/m.planemap", {});
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().kind, StoreError::Kind::kSystem);
  EXPECT_NE(file.error().message.find("nowhere/m.planemap"), std::string::npos);
}

}  // namespace
}  // namespace planemap::service
