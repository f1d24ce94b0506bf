// The map outlives the process: the daemon ends and begins again, with and without a word, and its disk fails.
#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

namespace fs = std::filesystem;

class MapFiles : public SystemTest {
 protected:
  void start_mapping(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"--map", map_.string(), "--set", "map.gravity=[0, 0, -1]"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_NO_FATAL_FAILURE(start_daemon(arguments));
  }
  void end_mapping(int signal) {
    daemon_->send_signal(signal);
    ASSERT_EQ(daemon_->wait_for(20s), signal == SIGKILL ? 128 + SIGKILL : 0) << daemon_->output();
    stop_daemon();
  }
  std::unique_ptr<Process> kinect(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5", "--quiet", "--lcm-url", kLcmUrl};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start("kinect", arguments);
  }
  /// Maps so many frames more, and waits until the map rests.
  void map_frames(int frames) {
    const auto before = bus_->counter("scans.received");
    const auto bridge = kinect({"--frames", std::to_string(frames), "--rate", "10"});
    ASSERT_EQ(bridge->wait_for(60s), 0) << bridge->output();
    ASSERT_TRUE(bus_->wait_until(
        [&] { return bus_->counter("scans.received") >= before + frames && bus_->counter("scans.waiting") == 0; },
        30s));
  }
  Finished planemap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), program("planemap"));
    return run(arguments);
  }
  /// What "planemap info" says of a map file that is whole.
  nlohmann::json info(const fs::path& path) const {
    const Finished said = planemap({"info", path.string(), "--json"});
    EXPECT_EQ(said.exit_code, 0) << said.err;
    return nlohmann::json::parse(said.out, nullptr, /*allow_exceptions=*/false);
  }
  nlohmann::json exported(const std::string& from) const {
    const fs::path out = scratch_ / "exported.json";
    const Finished said = planemap({"export", from, out.string()});
    EXPECT_EQ(said.exit_code, 0) << said.err;
    return nlohmann::json::parse(read_file(out), nullptr, /*allow_exceptions=*/false);
  }

  /// Planes of a file's and a daemon's export are the same; a client makes unit normals anew, which is a last digit.
  static void expect_same_planes(const nlohmann::json& a, const nlohmann::json& b) {
    EXPECT_EQ(a["epoch"], b["epoch"]);
    EXPECT_EQ(a["revision"], b["revision"]);
    ASSERT_EQ(a["planes"].size(), b["planes"].size());
    ASSERT_GT(a["planes"].size(), 5u);
    for (std::size_t i = 0; i < a["planes"].size(); ++i) {
      const auto& p = a["planes"][i];
      const auto& q = b["planes"][i];
      for (const char* key : {"id", "cellCount", "pointCount", "class", "firstSeenUtime", "lastSeenUtime"}) {
        EXPECT_EQ(p[key], q[key]) << key << " of plane " << p["id"];
      }
      EXPECT_NEAR(p["d"].get<double>(), q["d"].get<double>(), 1e-13);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(p["normal"][k].get<double>(), q["normal"][k].get<double>(), 1e-15);
      }
      for (const std::size_t k : {0, 1, 2, 3, 5, 6, 7, 10, 11, 15}) {
        EXPECT_EQ(p["covariance"][k], q["covariance"][k]) << "plane " << p["id"];
      }
    }
  }

  const fs::path map_ = scratch_ / "flat.planemap";
};

TEST_F(MapFiles, TheDaemonGoesOnWithTheMapOfTheOneBefore) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  ASSERT_NO_FATAL_FAILURE(map_frames(30));
  const auto asked = exported("-");
  ASSERT_GT(asked["planes"].size(), 5u);
  ASSERT_NO_FATAL_FAILURE(end_mapping(SIGINT));
  expect_same_planes(exported(map_.string()), asked);
  const auto closed = info(map_);
  EXPECT_EQ(closed["closed"], true);

  ASSERT_NO_FATAL_FAILURE(start_mapping());
  EXPECT_EQ(exported("-"), asked) << "the same planes in the same epoch";
  EXPECT_NE(daemon_->output().find("flat.planemap: going on with " + std::to_string(asked["planes"].size()) +
                                   " planes, " + closed["cellCount"].dump() + " cells, epoch " + asked["epoch"].dump() +
                                   ", revision " + asked["revision"].dump() + "\n"),
            std::string::npos)
      << daemon_->output();
  ASSERT_NO_FATAL_FAILURE(map_frames(10));
  EXPECT_EQ(bus_->status()->epoch, asked["epoch"].get<std::int64_t>());
  EXPECT_GT(bus_->status()->revision, asked["revision"].get<std::int64_t>());
}

TEST_F(MapFiles, AKilledDaemonsIdsAndRevisionsAreNotUsedAgain) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  ASSERT_NO_FATAL_FAILURE(map_frames(20));
  const Finished saved = planemap({"save"});
  EXPECT_EQ(saved.out, "the map is saved\n") << saved.err;
  const auto asked = exported("-");
  ASSERT_NO_FATAL_FAILURE(end_mapping(SIGKILL));
  const auto left = info(map_);
  EXPECT_EQ(left["closed"], false);
  EXPECT_EQ(left["revision"], asked["revision"]) << "what was saved is there";
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  const auto again = exported("-");
  EXPECT_EQ(again["epoch"], asked["epoch"]);
  EXPECT_EQ(again["planes"], asked["planes"]);
  EXPECT_GT(again["revision"].get<std::int64_t>(), asked["revision"].get<std::int64_t>() + 30000);
  EXPECT_NE(daemon_->output().find("it was not closed in good order, so ids and revisions skip what was reserved"),
            std::string::npos);
}

TEST_F(MapFiles, ASaveIsConsistentWhileScansStream) {
  ASSERT_NO_FATAL_FAILURE(start_mapping({"--set", "store.interval_s=0.1"}));
  const auto bridge = kinect({"--rate", "15", "--loop"});
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") >= 10; }, 30s));
  std::int64_t revision = 0;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(bus_->wait_until([&] { return bus_->status()->revision > revision; }, 30s));
    const fs::path copy = scratch_ / "copy.planemap";
    const Finished saved = planemap({"save", map_.string(), copy.string()});
    ASSERT_EQ(saved.exit_code, 0) << saved.err;
    const auto map = info(copy);
    EXPECT_GE(map["revision"].get<std::int64_t>(), revision);
    revision = map["revision"].get<std::int64_t>();
  }
  EXPECT_EQ(bus_->counter("store.failures"), 0);
}

TEST_F(MapFiles, AResetOutlivesTheProcessThatIsKilledRightAfter) {
  ASSERT_NO_FATAL_FAILURE(start_mapping({"--set", "store.interval_s=60"}));
  ASSERT_NO_FATAL_FAILURE(map_frames(10));
  const auto before = exported("-");
  const auto reset = nlohmann::json::parse(planemap({"reset", "--json"}).out);
  ASSERT_NO_FATAL_FAILURE(end_mapping(SIGKILL));
  const auto left = info(map_);
  EXPECT_EQ(left["epoch"], reset["epoch"]);
  EXPECT_GT(left["epoch"], before["epoch"]);
  EXPECT_EQ(left["cellCount"], 0);
}

TEST_F(MapFiles, ADamagedFileIsSetAsideAndSaidLoudly) {
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  ASSERT_NO_FATAL_FAILURE(map_frames(10));
  ASSERT_NO_FATAL_FAILURE(end_mapping(SIGTERM));
  {
    std::fstream file(map_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(map_) / 2));
    file << std::string(100, 'x');
  }
  ASSERT_NO_FATAL_FAILURE(start_mapping());
  fs::path aside;
  for (const auto& entry : fs::directory_iterator(scratch_)) {
    if (entry.path().filename().string().starts_with("flat.planemap.damaged-")) aside = entry.path();
  }
  ASSERT_FALSE(aside.empty()) << daemon_->output();
  EXPECT_NE(daemon_->output().find("THE MAP FILE IS DAMAGED: " + map_.string()), std::string::npos);
  EXPECT_NE(daemon_->output().find("going on with the backup: "), std::string::npos) << daemon_->output();
  const Finished recovered = planemap({"recover", aside.string(), "-o", (scratch_ / "whole.planemap").string()});
  EXPECT_EQ(recovered.exit_code, 0) << recovered.err;
  EXPECT_GT(info(scratch_ / "whole.planemap")["planeCount"], 3);
}

/// With the map on a small file system of the test's own.
class MapFilesOnASmallDisk : public MapFiles {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(MapFiles::SetUp());
    if (IsSkipped()) return;
    fs::create_directory(disk_);
    if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        mount("none", disk_.c_str(), "tmpfs", 0, "size=16m") != 0) {
      GTEST_SKIP() << "no file system of our own: " << std::strerror(errno);
    }
    is_mounted_ = true;
  }
  void TearDown() override {
    MapFiles::TearDown();
    if (is_mounted_) umount2(disk_.c_str(), MNT_DETACH);
  }
  void start_mapping_on_disk() {
    ASSERT_NO_FATAL_FAILURE(
        start_daemon({"--map", (disk_ / "flat.planemap").string(), "--set", "store.interval_s=0.2"}));
  }
  void fill() const {
    std::ofstream ballast(disk_ / "ballast", std::ios::binary);
    const std::string block(4096, 'x');
    while (ballast.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
    }
  }
  /// The file has the daemon's newest map once it is asked to save.
  void expect_saved() {
    ASSERT_TRUE(bus_->wait_until([&] { return bus_->status()->degraded.empty(); }, 20s)) << bus_->status()->degraded;
    EXPECT_EQ(bus_->counter("store.degraded"), 0);
    EXPECT_NE(daemon_->output().find("flat.planemap: the map is saved again"), std::string::npos);
    // The map rests once five statuses in a row tell of no more scans.
    std::int64_t utime = 0;
    std::int64_t received = -1;
    int quiet = 0;
    ASSERT_TRUE(bus_->wait_until(
        [&] {
          if (bus_->status()->utime == utime) return false;
          utime = bus_->status()->utime;
          const bool rests = bus_->counter("scans.received") == received && bus_->counter("scans.waiting") == 0;
          received = bus_->counter("scans.received");
          quiet = rests ? quiet + 1 : 0;
          return quiet >= 5;
        },
        30s));
    EXPECT_EQ(planemap({"save"}).out, "the map is saved\n");
    expect_same_planes(exported((disk_ / "flat.planemap").string()), exported("-"));
  }
  /// Mapping goes on, and all that ask are told that the map is not kept, and why.
  void expect_degraded(const std::string& why) {
    const auto mapped = bus_->counter("scans.mapped");
    ASSERT_TRUE(bus_->wait_until([&] { return !bus_->status()->degraded.empty(); }, 30s)) << daemon_->output();
    EXPECT_NE(bus_->status()->degraded.find(why), std::string::npos) << bus_->status()->degraded;
    EXPECT_EQ(bus_->counter("store.degraded"), 1);
    EXPECT_TRUE(bus_->wait_until([&] { return bus_->counter("store.failures") > 0; }, 10s));
    ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") > mapped + 10; }, 30s))
        << "mapping stopped";
    const Finished status = planemap({"status"});
    EXPECT_NE(status.out.find("  degraded  "), std::string::npos) << status.out;
    EXPECT_NE(status.out.find(why), std::string::npos) << status.out;
    const Finished saved = planemap({"save"});
    EXPECT_EQ(saved.exit_code, 1);
    EXPECT_NE(saved.err.find(why), std::string::npos) << saved.err;
    EXPECT_NE(daemon_->output().find("; mapping goes on, the map is not being kept"), std::string::npos);
  }

  const fs::path disk_ = scratch_ / "disk";
  bool is_mounted_ = false;
};

TEST_F(MapFilesOnASmallDisk, FullAndThenNotAnyMore) {
  ASSERT_NO_FATAL_FAILURE(start_mapping_on_disk());
  const auto bridge = kinect({"--rate", "10", "--loop"});
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("store.commits") >= 2; }, 30s));
  fill();
  ASSERT_NO_FATAL_FAILURE(expect_degraded("the map cannot be saved: database or disk is full"));
  const Finished info = planemap({"info", (disk_ / "flat.planemap").string()});
  EXPECT_EQ(info.exit_code, 0) << "what was committed before is whole: " << info.err;
  fs::remove(disk_ / "ballast");
  bridge->send_signal(SIGINT);
  ASSERT_TRUE(bridge->wait_for(10s));
  ASSERT_NO_FATAL_FAILURE(expect_saved());
}

TEST_F(MapFilesOnASmallDisk, ReadOnlyFromTheStartAndThenNotAnyMore) {
  ASSERT_EQ(mount("none", disk_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr), 0) << std::strerror(errno);
  ASSERT_NO_FATAL_FAILURE(start_mapping_on_disk());
  const auto bridge = kinect({"--rate", "10", "--loop"});
  ASSERT_NO_FATAL_FAILURE(expect_degraded("flat.planemap: the map file cannot be made: Read-only file system"));
  ASSERT_EQ(mount("none", disk_.c_str(), "tmpfs", MS_REMOUNT, nullptr), 0) << std::strerror(errno);
  bridge->send_signal(SIGINT);
  ASSERT_TRUE(bridge->wait_for(10s));
  ASSERT_NO_FATAL_FAILURE(expect_saved());
}

}  // namespace
}  // namespace planemap::system_test
