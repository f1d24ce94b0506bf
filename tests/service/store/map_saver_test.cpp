// The thread that keeps the map while the mapper goes on.
#include "store/map_saver.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "small_maps.hpp"
#include "store/map_reader.hpp"
#include "support/captured_log.hpp"
#include "support/process.hpp"
#include "support/room_service.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::service {
namespace {

constexpr std::chrono::seconds kLong(60);

/// A mapper whose map is kept, as in planemapd.
class Kept {
 public:
  explicit Kept(const ServiceConfig& config, std::uint64_t new_epoch = 1000)
      : Kept(config, new_epoch, open_store(config, new_epoch).value()) {}
  ~Kept() { stop(); }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;

  /// Maps one more look, and waits until it is in the snapshot.
  void look() {
    const auto T = testing::looking({-1.0, 0.0, 1.2}, {1.0, 1.5 * std::sin(0.3 * looks_), 0.8});
    counters_.scan_received();
    mapping_.push({0, testing::render({{{0, 0, 1}, 0.0}, {{-1, 0, 0}, 2.5}}, T, 1, 1.0, 160, 120), T});
    std::unique_lock lock(mutex_);
    ++looks_;
    ASSERT_TRUE(mapped_.wait_for(lock, kLong, [&] { return done_ >= looks_; }));
  }
  Expected<void> save() { return mapping_.save(kLong); }
  void wait_for_backups(int count) const {
    const auto end = std::chrono::steady_clock::now() + kLong;
    while (counter("store.backups") < count && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    EXPECT_GE(counter("store.backups"), count);
  }
  void stop() {
    mapping_.stop();
    mapping_.set_keeper(nullptr);
    saver_.stop();
  }
  MappingService& mapping() { return mapping_; }
  std::int64_t counter(const std::string& name) const { return counters_.value(name); }

 private:
  Kept(const ServiceConfig& config, std::uint64_t epoch, MapStore store)
      : mapping_(
            config, epoch, counters_,
            [this] {
              const std::lock_guard lock(mutex_);
              ++done_;
              mapped_.notify_all();
            },
            store.initial.get()),
        saver_(config.store, std::move(store), mapping_, counters_) {
    mapping_.set_keeper(&saver_);
  }

  std::mutex mutex_;
  std::condition_variable mapped_;
  int done_ = 0;
  int looks_ = 0;
  Counters counters_;
  MappingService mapping_;
  MapSaver saver_;
};

class MapSavers : public ::testing::Test {
 protected:
  MapSavers() {
    config_.store.path = path_.string();
    config_.store.interval_s = 60.0;  // so that only what a test asks for is saved
  }
  Snapshot stored() const {
    auto read = MapFile::read(path_);
    EXPECT_TRUE(read) << read.error().message;
    return read ? read->snapshot : nullptr;
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "there/hall.planemap";
  ServiceConfig config_;
};

class InAFolder : public MapSavers {
 protected:
  InAFolder() { std::filesystem::create_directories(path_.parent_path()); }
};

TEST_F(InAFolder, SaveCommitsTheMapAsItIsNow) {
  Kept kept(config_);
  kept.look();
  kept.look();
  ASSERT_TRUE(kept.save());
  EXPECT_TRUE(essence(*stored()) == essence(*kept.mapping().snapshot()));
  EXPECT_GT(kept.mapping().snapshot()->planes().size(), 0u);
  EXPECT_EQ(kept.counter("store.degraded"), 0);
  EXPECT_EQ(kept.counter("store.failures"), 0);
}

TEST_F(InAFolder, EachIntervalIsSavedWithoutBeingAsked) {
  config_.store.interval_s = 0.05;
  Kept kept(config_);
  kept.look();
  const auto end = std::chrono::steady_clock::now() + kLong;
  while (stored()->cell_count() == 0 && std::chrono::steady_clock::now() < end) {
  }
  EXPECT_TRUE(essence(*stored()) == essence(*kept.mapping().snapshot()));
}

TEST_F(InAFolder, StoppingClosesTheFileAndLetsAnotherHaveIt) {
  Snapshot map;
  {
    Kept kept(config_);
    kept.look();
    map = kept.mapping().snapshot();
    EXPECT_FALSE(open_store(config_, 2000)) << "it is another's";
  }
  EXPECT_TRUE(MapFile::read(path_)->closed);
  EXPECT_FALSE(std::filesystem::exists(path_.string() + "-wal"));
  Kept again(config_, 2000);
  EXPECT_TRUE(essence(*again.mapping().snapshot()) == essence(*map)) << "the epoch, too";
  again.look();
  EXPECT_EQ(again.mapping().snapshot()->epoch(), map->epoch());
  EXPECT_GT(again.mapping().snapshot()->revision(), map->revision());
}

TEST_F(InAFolder, AResetIsKept) {
  {
    Kept kept(config_);
    kept.look();
    ASSERT_TRUE(kept.save());
    ASSERT_TRUE(kept.mapping().reset(kLong));
    ASSERT_TRUE(kept.save());
    EXPECT_EQ(stored()->cell_count(), 0u);
    EXPECT_EQ(stored()->epoch(), kept.mapping().snapshot()->epoch());
  }
  Kept again(config_, 2000);
  EXPECT_EQ(again.mapping().snapshot()->epoch(), 1001u);
  EXPECT_EQ(again.mapping().snapshot()->cell_count(), 0u);
}

TEST_F(InAFolder, TheEpochOfAResetThatWasLostIsNotUsedAgain) {
  {
    Kept kept(config_);
    kept.look();
  }
  Kept again(config_, 2000);  // the process before may have begun map 1001, and died before that was saved
  EXPECT_EQ(again.mapping().snapshot()->epoch(), 1000u);
  EXPECT_EQ(again.mapping().reset(kLong), 2001u);
}

TEST_F(InAFolder, AResetIsInTheBackupToo) {
  Kept kept(config_);
  kept.look();
  ASSERT_TRUE(kept.save());
  kept.wait_for_backups(1);
  ASSERT_TRUE(kept.mapping().reset(kLong));
  ASSERT_TRUE(kept.save());
  kept.wait_for_backups(2);
  EXPECT_EQ(MapFile::read(path_.string() + ".backup")->snapshot->cell_count(), 0u);
  EXPECT_EQ(kept.counter("store.backup_failures"), 0);
}

TEST_F(InAFolder, ABackupIsOfOneStateThoughCommitsGoOn) {
  Kept kept(config_);
  for (int looks = 0; looks < 8; ++looks) {
    kept.look();
    ASSERT_TRUE(kept.save());
  }
  kept.wait_for_backups(1);
  const auto backup = MapFile::read(path_.string() + ".backup");
  ASSERT_TRUE(backup) << backup.error().message;
  EXPECT_LE(backup->snapshot->revision(), stored()->revision());
  EXPECT_FALSE(std::filesystem::exists(path_.string() + ".backup.part"));
}

TEST_F(InAFolder, CommitsThatTakeLongerThanTheIntervalAreCountedAndSaid) {
  const CapturedLog log;
  config_.store.interval_s = 1e-6;
  Kept kept(config_);
  kept.look();
  ASSERT_TRUE(kept.save());
  kept.stop();
  EXPECT_GE(kept.counter("store.late_commits"), 1);
  EXPECT_NE(log.text().find("longer than store.interval_s: so much more of the map is lost if the process is killed"),
            std::string::npos)
      << log.text();
}

TEST_F(MapSavers, WhatCannotBeSavedIsSaidAndSavedOnceItCan) {
  const CapturedLog log;
  std::unique_ptr<Kept> kept = std::make_unique<Kept>(config_);  // its folder is not there
  kept->look();
  const auto saved = kept->save();
  ASSERT_FALSE(saved);
  const std::string why = path_.string() + ": the map file cannot be made: unable to open database file";
  EXPECT_EQ(saved.error().message, why);
  EXPECT_EQ(kept->mapping().keeper_problem(), why);
  EXPECT_EQ(kept->counter("store.degraded"), 1);
  EXPECT_GE(kept->counter("store.failures"), 1);
  kept->look();  // mapping goes on
  std::filesystem::create_directories(path_.parent_path());
  ASSERT_TRUE(kept->save());
  EXPECT_EQ(kept->mapping().keeper_problem(), "");
  EXPECT_EQ(kept->counter("store.degraded"), 0);
  EXPECT_TRUE(essence(*stored()) == essence(*kept->mapping().snapshot()));
  kept.reset();
  EXPECT_NE(log.text().find(why + "; mapping goes on, the map is not being kept"), std::string::npos) << log.text();
  EXPECT_NE(log.text().find(path_.string() + ": the map is saved again"), std::string::npos) << log.text();
}

TEST_F(MapSavers, AFileThatCameMeanwhileIsLeftAlone) {
  const CapturedLog log;
  Kept kept(config_);
  folder_.write("there/hall.planemap", "somebody's");
  const auto saved = kept.save();
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().message, path_.string() + ": a file has come that is not this map's; it is left alone");
  kept.stop();
  EXPECT_EQ(read_file(path_), "somebody's");
}

TEST(MappingService, SaysThatNobodyKeepsItsMap) {
  Counters counters;
  MappingService mapping(ServiceConfig{}, 1, counters, {});
  const auto saved = mapping.save(kLong);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().message, "the map has no file: planemapd --map FILE, or store.path, gives it one");
  EXPECT_EQ(mapping.keeper_problem(), "");
}

TEST(Status, SaysWhyTheMapIsNotBeingKept) {
  class Broken final : public MapKeeper {
   public:
    Expected<void> save(std::chrono::steady_clock::duration) override { return fail("the disk is full"); }
    std::string problem() const override { return "the disk is full"; }
  };
  Broken broken;
  RoomService room;
  EXPECT_EQ(room.service().status().degraded, "");
  room.service().mapping().set_keeper(&broken);
  EXPECT_EQ(room.service().status().degraded, "the disk is full");
  room.service().mapping().set_keeper(nullptr);
}

}  // namespace
}  // namespace planemap::service
