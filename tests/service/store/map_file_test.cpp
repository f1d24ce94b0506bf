#include "store/map_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <planemap/block.hpp>
#include <planemap/mapper.hpp>
#include <random>

#include "../../core/rooms.hpp"
#include "store/block_codec.hpp"
#include "store/map_reader.hpp"
#include "store/plane_row_codec.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::service {
namespace {

using testing::looking;
using testing::render;
using testing::Wall;
using Snapshot = std::shared_ptr<const MapSnapshot>;

void look(Mapper& mapper, int step) {
  const std::vector<Wall> room = {{{0, 0, 1}, 0.0}, {{-1, 0, 0}, 2.5}, {{0, -1, 0}, 2.0}, {{0, 1, 0}, 2.0}};
  const auto T = looking({-1.0, 0.0, 1.2}, {1.0, 1.5 * std::sin(0.3 * step), 0.8});
  mapper.integrate(render(room, T, static_cast<std::uint64_t>(step), 1.0, 160, 120), T);
}

/// What a map is made of, as bytes: equal for maps that a file cannot tell apart.
std::string essence(const MapSnapshot& map) {
  std::string text = std::to_string(map.epoch()) + " " + std::to_string(map.revision()) + " " +
                     std::to_string(map.utime()) + " " + std::to_string(map.cell_count()) + "\n";
  for (const auto& block : map.blocks()) {
    const auto bytes = encode_block(*block);
    text.append(bytes.begin(), bytes.end());
  }
  for (const auto& plane : map.planes()) {
    const auto bytes = encode_plane(*plane);
    text += std::to_string(plane->id);
    text.append(bytes.begin(), bytes.end());
  }
  for (const auto& gone : map.removed()) text += std::to_string(gone.id) + ">" + std::to_string(gone.merged_into);
  return text;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

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

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "m.planemap";
};

TEST_F(MapFiles, KeepCellsPlanesAndFacts) {
  const auto map = closed_map();
  ASSERT_GE(map->planes().size(), 3u);
  const auto read = MapFile::read(path_);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(essence(*read->snapshot), essence(*map));
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
  EXPECT_EQ(essence(*MapFile::read(path_)->snapshot), essence(*map));  // while it is open
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
  EXPECT_EQ(essence(*MapFile::read(path_)->snapshot), essence(*map));
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

TEST_F(MapFiles, TruncationsAreSeen) {
  closed_map(1);
  const std::string whole = bytes_of(path_);
  const auto cut = folder_ / "cut";
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 400 + 1) {
    std::ofstream(cut, std::ios::binary | std::ios::trunc) << whole.substr(0, size);
    const auto read = MapFile::read(cut);
    ASSERT_FALSE(read) << size << " of " << whole.size() << " B were taken for a map";
    ASSERT_EQ(read.error().kind, StoreError::Kind::kDamaged) << read.error().message;
  }
}

TEST_F(MapFiles, NoFlippedBitMakesAnotherMap) {
  const std::string good = essence(*closed_map(1));
  const std::string whole = bytes_of(path_);
  const char* wish = std::getenv("PLANEMAP_BIT_FLIPS");
  const int flips = wish == nullptr ? 1500 : std::atoi(wish);
  std::mt19937_64 random(11);
  int seen = 0;
  for (int i = 0; i < flips; ++i) {
    std::string bytes = whole;
    const std::size_t bit = random() % (8 * bytes.size());
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << (bit % 8)));
    const auto flipped = folder_ / "flipped";
    std::ofstream(flipped, std::ios::binary | std::ios::trunc) << bytes;
    const auto read = MapFile::read(flipped);
    if (!read) ++seen;
    if (read) {
      ASSERT_EQ(essence(*read->snapshot), good) << "bit " << bit;
    }
  }
  EXPECT_GT(seen, flips / 3);
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
