// How planemapd opens its map file, and what it says of one that it cannot use.
#include "store/map_store.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "small_maps.hpp"
#include "store/map_reader.hpp"
#include "support/captured_log.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::service {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNewEpoch = 1000;

class MapStores : public ::testing::Test {
 protected:
  MapStores() { config_.store.path = path_.string(); }

  Snapshot write(const fs::path& path, int looks = 2, std::uint64_t epoch = 77) const {
    auto map = looked_around(epoch, looks, config_.mapper);
    auto file = MapFile::create(path, facts_of(config_));
    EXPECT_TRUE(file && file->close(map));
    return map;
  }
  static void damage(const fs::path& path) {
    Database(path, Database::Access::kWrite).execute("UPDATE block SET checksum=checksum+1 WHERE slot=3");
  }
  /// The file in the folder whose name begins so.
  std::optional<fs::path> beginning(const std::string& name) const {
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      if (entry.path().filename().string().rfind(name, 0) == 0) return entry.path();
    }
    return std::nullopt;
  }
  /// @return the error's sentence
  std::string refused() const {
    const auto store = open_store(config_, kNewEpoch);
    EXPECT_FALSE(store);
    return store ? "" : store.error().message;
  }

  TemporaryFolder folder_;
  const fs::path path_ = folder_ / "hall.planemap";
  ServiceConfig config_;
};

TEST_F(MapStores, ANewFileIsAMapFromTheStart) {
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_EQ(store->initial, nullptr);
  EXPECT_EQ(store->problem, "");
  const auto read = MapFile::read(path_);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->snapshot->epoch(), kNewEpoch);
  EXPECT_GT(read->reserved_ids, 1000u);
  EXPECT_EQ(read->facts.config, to_yaml(config_));
}

TEST_F(MapStores, AMapThatWasClosedGoesOnWhereItWas) {
  const auto map = write(path_);
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_TRUE(essence(*store->initial) == essence(*map));
  EXPECT_EQ(store->initial->state().next_plane_id, map->state().next_plane_id);
}

TEST_F(MapStores, AnotherProcesssFileIsRefused) {
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store);
  EXPECT_EQ(refused(), path_.string() + ": another process has the map open");
}

TEST_F(MapStores, AMapOfAnotherFrameIsRefusedAndLeftAlone) {
  write(path_);
  const std::string before = read_file(path_);
  config_.map.frame = "cellar";
  EXPECT_EQ(refused(),
            path_.string() +
                ": its frame is 'world', the configuration's 'cellar' (map.frame); set that, or use another file");
  EXPECT_TRUE(read_file(path_) == before);
}

TEST_F(MapStores, AMapOfOtherCellsIsRefusedAndLeftAlone) {
  write(path_);
  const std::string before = read_file(path_);
  config_.mapper.grid.cell_size_m = 0.05;
  EXPECT_EQ(refused(),
            path_.string() +
                ": its cells are 0.08 m wide, the configuration's 0.05 m (grid.cell_size_m); set that, or use "
                "another file");
  EXPECT_TRUE(read_file(path_) == before);
}

TEST_F(MapStores, ANewerFormatIsRefusedAndLeftAlone) {
  write(path_);
  Database(path_, Database::Access::kWrite)
      .execute("PRAGMA user_version=2; UPDATE meta SET value='2' WHERE key='format'");
  const std::string before = read_file(path_);
  EXPECT_EQ(refused(), path_.string() +
                           ": was written by a newer planemap (format 2, this one knows up to 1): use that version, or "
                           "another file");
  EXPECT_TRUE(read_file(path_) == before);
}

TEST_F(MapStores, AFileThatIsNoDatabaseIsRefusedAndLeftAlone) {
  folder_.write("hall.planemap", "Notes of the hall: it has a floor.\n");
  EXPECT_EQ(refused(), path_.string() + ": is no map file: it is none of SQLite's databases");
  EXPECT_EQ(read_file(path_), "Notes of the hall: it has a floor.\n");
}

TEST_F(MapStores, ADamagedFileIsSetAsideAndTheBackupGoesOnInANewEpoch) {
  write(path_, 3);
  const auto older = write(path_.string() + ".backup", 2);
  damage(path_);
  const std::string before = read_file(path_);
  std::string said;
  std::optional<MapStore> store;
  {
    const CapturedLog log;
    auto opened = open_store(config_, kNewEpoch);
    ASSERT_TRUE(opened) << opened.error().message;
    store = std::move(*opened);
    said = log.text();
  }
  const auto aside = beginning("hall.planemap.damaged-2");
  ASSERT_TRUE(aside);
  EXPECT_TRUE(read_file(*aside) == before);
  EXPECT_NE(
      said.find("THE MAP FILE IS DAMAGED: " + path_.string() + ": block 3: its checksum is wrong. It is kept as " +
                aside->string() + "; 'planemap recover " + aside->string() + " -o OUT' takes out what is whole"),
      std::string::npos)
      << said;
  EXPECT_NE(said.find(".backup: going on with the backup: " + std::to_string(older->planes().size()) + " planes"),
            std::string::npos)
      << said;
  ASSERT_NE(store->initial, nullptr);
  EXPECT_TRUE(content(*store->initial) == content(*older));
  EXPECT_EQ(store->initial->epoch(), kNewEpoch);
  EXPECT_TRUE(content(*MapFile::read(path_)->snapshot) == content(*older));
}

TEST_F(MapStores, WithoutABackupADamagedFileLeavesAnEmptyMap) {
  write(path_);
  damage(path_);
  const CapturedLog log;
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_EQ(store->initial, nullptr);
  EXPECT_TRUE(beginning("hall.planemap.damaged-2"));
  EXPECT_NE(log.text().find("there is no backup: the map begins empty"), std::string::npos) << log.text();
}

TEST_F(MapStores, ABackupThatCannotBeUsedIsKept) {
  write(path_);
  damage(path_);
  write(path_.string() + ".backup");
  damage(path_.string() + ".backup");
  const CapturedLog log;
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_EQ(store->initial, nullptr);
  EXPECT_TRUE(beginning("hall.planemap.backup.unused-2"));
  EXPECT_NE(log.text().find("the backup cannot be used either: "), std::string::npos) << log.text();
}

TEST_F(MapStores, ABackupWithoutItsMapIsKept) {
  write(path_.string() + ".backup");
  const CapturedLog log;
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_EQ(store->initial, nullptr);
  EXPECT_TRUE(beginning("hall.planemap.backup.unused-2"));
  EXPECT_NE(log.text().find("there is no such file, but a backup of one: it is not used, and kept as"),
            std::string::npos)
      << log.text();
}

TEST_F(MapStores, AFolderThatIsNotThereIsAProblemNotAFailure) {
  config_.store.path = (folder_ / "nowhere/hall.planemap").string();
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_EQ(store->file, nullptr);
  EXPECT_EQ(store->problem, config_.store.path + ": the map file cannot be made: unable to open database file");
}

TEST_F(MapStores, AMapThatCannotBeWrittenNowGoesOnInANewEpoch) {
  const auto map = write(path_);
  Database other(path_, Database::Access::kWrite);
  other.execute("BEGIN IMMEDIATE");  // it is locked, as by a backup program
  const CapturedLog log;
  const auto store = open_store(config_, kNewEpoch);
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_NE(store->problem.find("database is locked"), std::string::npos) << store->problem;
  EXPECT_TRUE(content(*store->initial) == content(*map));
  EXPECT_EQ(store->initial->epoch(), kNewEpoch) << "as ids of the old one could not be reserved";
  EXPECT_NE(log.text().find("mapping goes on in a new epoch, 1000, as nothing can be reserved in the old one"),
            std::string::npos)
      << log.text();
  other.execute("ROLLBACK");
  ASSERT_TRUE(store->file->commit(store->initial));
  EXPECT_TRUE(essence(*MapFile::read(path_)->snapshot) == essence(*store->initial));
}

}  // namespace
}  // namespace planemap::service
