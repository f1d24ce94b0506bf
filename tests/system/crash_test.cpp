// planemapd ends at any moment, without a word or with SIGTERM, while it maps and saves: what it told is not taken
// back.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <planemap_lcm/planes_t.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "harness/network.hpp"
#include "harness/system_test.hpp"
#include "store/map_file.hpp"

namespace planemap::system_test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kInterval = 200ms;
/// A commit takes time, too, and so does a delta's way here; the machine may be busy.
constexpr auto kSlack = 600ms;
constexpr auto kLongestLife = 2500ms;

int kills() {
  const char* wish = std::getenv("PLANEMAP_KILLS");
  return wish == nullptr ? 40 : std::atoi(wish);
}

/// How long the thread of a process that waited most for a core, while it could have run, has waited since its start.
/// Without that, what a busy machine does to the saver would be taken for the saver's doing.
std::chrono::milliseconds waited_for_a_core(pid_t process) {
  std::int64_t most_ns = 0;
  std::error_code none;
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", none)) {
    std::int64_t ran_ns = 0;
    std::int64_t waited_ns = 0;
    if (std::ifstream(task.path() / "schedstat") >> ran_ns >> waited_ns) most_ns = std::max(most_ns, waited_ns);
  }
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::nanoseconds(most_ns));
}

/// What was told of the map over LCM, by all lives of the daemon.
class Witness {
 public:
  explicit Witness(lcm::LCM& lcm) { lcm.subscribe("PLANEMAP_DELTA", &Witness::on_delta, this)->setQueueCapacity(0); }

  /// @param was_killed  the life before; else this one begins with what that one told last
  void begin_life(bool was_killed) {
    least_ = newest_ > 0 && was_killed ? newest_ + 1 : newest_;
    heard_.clear();
  }
  /// Whether anything was told before a time, in this life.
  bool heard_before(Clock::time_point time) const { return !heard_.empty() && heard_.front().first < time; }
  /// How long before a time the first of those revisions was told that are newer than one; 0: none is.
  std::chrono::milliseconds age_of_oldest_after(std::int64_t revision, Clock::time_point time) const {
    for (const auto& [at, told] : heard_) {
      if (told > revision) return std::max(0ms, std::chrono::duration_cast<std::chrono::milliseconds>(time - at));
    }
    return 0ms;
  }
  std::int64_t newest() const { return newest_; }
  const std::set<std::int64_t>& epochs() const { return epochs_; }
  /// When the plane of an id was first seen; the id was told before.
  const std::map<std::int64_t, std::int64_t>& first_seen() const { return first_seen_; }
  const std::vector<std::string>& wrongs() const { return wrongs_; }

 private:
  void on_delta(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                const planemap_lcm::planes_t* delta) {
    epochs_.insert(delta->epoch);
    if (delta->revision < least_) {
      wrongs_.push_back("revision " + std::to_string(delta->revision) +
                        " was told by a life before; the least of this one is " + std::to_string(least_));
    }
    newest_ = std::max(newest_, delta->revision);
    heard_.emplace_back(Clock::now(), delta->revision);
    for (const auto& plane : delta->planes) {
      const auto [known, is_new] = first_seen_.emplace(plane.id, plane.first_seen_utime);
      if (!is_new && known->second != plane.first_seen_utime) {
        wrongs_.push_back("id " + std::to_string(plane.id) + " has become another plane's");
      }
    }
  }

  std::int64_t newest_ = 0;
  std::int64_t least_ = 0;  ///< revision that this life may tell
  std::set<std::int64_t> epochs_;
  std::vector<std::pair<Clock::time_point, std::int64_t>> heard_;
  std::map<std::int64_t, std::int64_t> first_seen_;
  std::vector<std::string> wrongs_;
};

class Crashes : public SystemTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(SystemTest::SetUp());
    if (IsSkipped()) return;
    witness_ = std::make_unique<Witness>(bus_->lcm());
    kinect_ = start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5", "--rate",
                               "10", "--loop", "--quiet", "--lcm-url", kLcmUrl});
  }
  void TearDown() override {
    kinect_.reset();
    SystemTest::TearDown();
  }
  void begin_life(bool was_killed) {
    witness_->begin_life(was_killed);
    daemon_ =
        std::make_unique<Process>(std::vector<std::string>{program("planemapd"), "--lcm-url", kLcmUrl, "--map",
                                                           map_.string(), "--set", "store.interval_s=0.2", "--set",
                                                           "publish.delta_period_s=0.02", "--set", "grpc.listen="},
                                  scratch_ / "planemapd.log");
  }
  /// The daemon has lived for a random time; a part of it was its start.
  void let_live() { bus_->listen_for(std::chrono::milliseconds(random_() % kLongestLife.count())); }
  /// Hears what was sent before the daemon ended.
  void hear_the_rest() { bus_->listen_for(50ms); }

  /// The file, which must be whole; its ids are those that were told.
  std::optional<service::StoredMap> whole_map() {
    auto map = service::MapFile::read(map_);
    if (!map) {
      ADD_FAILURE() << map.error().message << "\n" << daemon_->output();
      return std::nullopt;
    }
    std::int64_t highest = 0;
    if (!witness_->first_seen().empty()) highest = witness_->first_seen().rbegin()->first;
    EXPECT_GT(map->continued().state.next_plane_id, static_cast<PlaneId>(highest));
    EXPECT_GT(map->continued().revision + (map->closed ? 1 : 0), static_cast<std::uint64_t>(witness_->newest()));
    for (const auto& plane : map->snapshot->planes()) {
      const auto told = witness_->first_seen().find(static_cast<std::int64_t>(plane->id));
      if (told != witness_->first_seen().end()) {
        EXPECT_EQ(plane->first_seen_utime, told->second) << plane->id;
      }
    }
    return std::move(*map);
  }
  void expect_one_epoch_and_no_wrongs() const {
    EXPECT_LE(witness_->epochs().size(), 1u);
    for (const std::string& wrong : witness_->wrongs()) ADD_FAILURE() << wrong;
  }

  const std::filesystem::path map_ = scratch_ / "flat.planemap";
  std::unique_ptr<Witness> witness_;
  std::unique_ptr<Process> kinect_;
  std::mt19937 random_{17};
};

TEST_F(Crashes, WhatWasToldAnIntervalAgoOutlivesAKill) {
  std::set<std::uint64_t> epochs;
  int told_long_ago = 0;
  int lost_to_the_machine = 0;
  double slowest_s = 0.0;
  auto oldest_lost = 0ms;
  std::size_t cells = 0;
  for (int life = 0; life < kills() && !HasFailure(); ++life) {
    ASSERT_NO_FATAL_FAILURE(begin_life(/*was_killed=*/true));
    let_live();
    const auto waited = waited_for_a_core(daemon_->pid());
    daemon_->send_signal(SIGKILL);
    const auto killed = Clock::now();
    ASSERT_EQ(daemon_->wait_for(10s), 128 + SIGKILL) << daemon_->output();
    hear_the_rest();
    if (!std::filesystem::exists(map_)) continue;  // it had not come so far
    const auto before = Clock::now();
    const auto map = whole_map();
    ASSERT_TRUE(map) << "life " << life;
    slowest_s = std::max(slowest_s, std::chrono::duration<double>(Clock::now() - before).count());
    cells = map->snapshot->cell_count();
    epochs.insert(map->snapshot->epoch());
    if (witness_->heard_before(killed - kInterval - kSlack)) ++told_long_ago;
    const auto lost = witness_->age_of_oldest_after(static_cast<std::int64_t>(map->snapshot->revision()), killed);
    oldest_lost = std::max(oldest_lost, lost);
    EXPECT_LT(lost, kInterval + kSlack + waited)
        << "life " << life << ", a thread of which waited " << waited.count() << " ms for a core\n"
        << daemon_->output();
    if (lost >= kInterval + kSlack) ++lost_to_the_machine;
  }
  EXPECT_EQ(epochs.size(), 1u);
  EXPECT_GE(told_long_ago, kills() / 5) << "most lives were too short to show anything";
  expect_one_epoch_and_no_wrongs();
  std::printf(
      "%d kills, %d of lives that had told something an interval ago; the oldest that was lost was told %lld ms before "
      "the kill (%d times beyond the interval, by a machine that was too busy to run the daemon); %zu planes told; %zu "
      "cells open in %.3f s\n",
      kills(), told_long_ago, static_cast<long long>(oldest_lost.count()), lost_to_the_machine,
      witness_->first_seen().size(), cells, slowest_s);
}

TEST_F(Crashes, SigtermInTheMiddleOfASaveLosesNothing) {
  int told = 0;
  for (int life = 0; life < 10 && !HasFailure(); ++life) {
    ASSERT_NO_FATAL_FAILURE(begin_life(/*was_killed=*/false));
    bus_->wait_until([&] { return witness_->heard_before(Clock::now()); }, 20s);
    let_live();
    daemon_->send_signal(SIGTERM);
    ASSERT_EQ(daemon_->wait_for(10s), 0) << daemon_->output();
    hear_the_rest();
    const auto map = whole_map();
    ASSERT_TRUE(map);
    EXPECT_TRUE(map->closed);
    EXPECT_FALSE(std::filesystem::exists(map_.string() + "-wal"));
    EXPECT_GE(static_cast<std::int64_t>(map->snapshot->revision()), witness_->newest()) << "life " << life;
    told += witness_->heard_before(Clock::now()) ? 1 : 0;
  }
  EXPECT_GE(told, 8);
  expect_one_epoch_and_no_wrongs();
}

}  // namespace
}  // namespace planemap::system_test
