// The client library where datagrams are lost, come twice or out of order, and the daemon is started anew.
#include <csignal>
#include <map>
#include <planemap/client/lcm_map_client.hpp>
#include <random>

#include "harness/network.hpp"
#include "harness/relay.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

constexpr int kFrames = 40;

class LossyNetwork : public SystemTest {
 protected:
  void TearDown() override {
    if (!IsSkipped()) lose_datagrams(0);
    SystemTest::TearDown();
  }

  /// A daemon with small pages, so that answers have many, and short waits.
  void start_lossy_daemon() { start_daemon({"--set", "publish.page_bytes=4096", "--set", "map.gravity=[0, 0, -1]"}); }
  std::unique_ptr<Process> start_kinect(int frames) const {
    return start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5", "--frames",
                            std::to_string(frames), "--rate", "10", "--quiet", "--lcm-url", kLcmUrl});
  }
  /// The map of a few scans, at rest.
  void build_map() {
    const auto kinect = start_kinect(kFrames);
    // On a busy machine the daemon may let some go: what counts is a map that rests.
    ASSERT_EQ(kinect->wait_for(60s), 0) << kinect->output();
    ASSERT_TRUE(bus_->wait_until(
        [&] { return bus_->counter("scans.received") >= kFrames && bus_->counter("scans.waiting") == 0; }, 30s));
    ASSERT_GT(bus_->counter("scans.mapped"), kFrames / 4);
  }
  static std::unique_ptr<client::MapClient> connect(const char* url) {
    client::LcmClientOptions options;
    options.ask_again_after = 200ms;
    options.lost_page_after = 30ms;
    options.lost_delta_after = 500ms;
    auto client = client::LcmMapClient::connect(url, options);
    if (!client) throw std::runtime_error(client.error().message);
    return std::move(*client);
  }

  static std::vector<client::QueryPoint> many_points() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
    std::vector<client::QueryPoint> points(1500);
    for (auto& point : points) point.point_m = {coordinate(random), coordinate(random), coordinate(random)};
    return points;
  }
  static std::vector<client::Ray> many_rays() {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
    std::vector<client::Ray> rays(1500);
    for (auto& ray : rays) ray = {{0, 0, 1}, {coordinate(random), coordinate(random), coordinate(random)}};
    return rays;
  }

  /// What every question is answered with, in numbers that depend on each part of each answer.
  static std::map<std::string, double> ask_everything(client::MapClient& client) {
    std::map<std::string, double> sums;
    const auto map = client.whole_map(30s);
    if (!map) throw std::runtime_error(map.error().message);
    for (const auto& plane : map->planes) {
      sums["planes"] += 1;
      sums["area"] += plane.area_m2;
      for (const auto& polygon : plane.polygons) sums["vertices"] += static_cast<double>(polygon.outer.size());
    }
    for (const auto& cell : map->cells) sums["points"] += static_cast<double>(cell.count);
    const auto near = client.nearest(many_points(), {}, 30s);
    if (!near) throw std::runtime_error(near.error().message);
    for (const auto& planes : near->points) sums["distances"] += planes.at(0).surface_distance_m;
    const auto hits = client.cast(many_rays(), {}, 30s);
    if (!hits) throw std::runtime_error(hits.error().message);
    for (const auto& ray : hits->rays) {
      if (ray.plane) sums["ranges"] += ray.plane->range_m;
      if (ray.cell) sums["entries"] += ray.cell->entry_m;
    }
    const double far_m = std::numeric_limits<double>::infinity();
    const auto region = client.region(
        {client::Box{{-far_m, -far_m, -far_m}, {far_m, far_m, far_m}}, /*polygons=*/true, /*cells=*/true, {}}, 30s);
    if (!region) throw std::runtime_error(region.error().message);
    for (const auto& plane : region->planes) sums["clipped"] += plane.clipped_area_m2;
    sums["cells"] = static_cast<double>(region->cells.size());
    const auto plane = client.plane(map->planes.front().id, 30s);
    if (!plane) throw std::runtime_error(plane.error().message);
    sums["deviation"] = plane->normal_deviation_rad;
    const auto plan = client.floorplan({}, 30s);
    if (!plan) throw std::runtime_error(plan.error().message);
    sums["free"] = plan->free_area_m2;
    return sums;
  }

  /// Follows the map until it is that of the newest status, and no one maps any more.
  void follow(client::MapWatch& watch, Process& kinect) {
    const auto end = std::chrono::steady_clock::now() + 90s;
    bool is_done = false;
    std::int64_t ended_utime = 0;  // when the bridge was seen to have ended
    while (!is_done) {
      ASSERT_LT(std::chrono::steady_clock::now(), end)
          << "the mirror of epoch " << watch.map().epoch << " revision " << watch.map().revision
          << " does not catch up; the bridge " << (kinect.running() ? "is still playing" : "has ended");
      const auto change = watch.next(200ms);
      ASSERT_TRUE(change) << change.error().message;
      EXPECT_EQ(change->revision, watch.map().revision);
      bus_->listen_for(1ms);
      if (ended_utime == 0 && !kinect.running()) {
        ended_utime =
            std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
                .count();
      }
      // A status may be lost, too: one from before the last scans says nothing.
      const bool at_rest = ended_utime != 0 && bus_->status() && bus_->status()->utime > ended_utime + 500'000;
      is_done = at_rest && bus_->counter("scans.waiting") == 0 && bus_->status()->epoch == watch.map().epoch &&
                bus_->status()->revision == watch.map().revision && change->empty();
    }
  }
  static void expect_same_planes(const client::Map& mirror, const client::Map& map) {
    EXPECT_EQ(mirror.epoch, map.epoch);
    ASSERT_EQ(mirror.planes.size(), map.planes.size());
    for (std::size_t i = 0; i < map.planes.size(); ++i) {
      EXPECT_EQ(mirror.planes[i].id, map.planes[i].id);
      EXPECT_EQ(mirror.planes[i].revision, map.planes[i].revision);
      EXPECT_EQ(mirror.planes[i].d, map.planes[i].d);
      EXPECT_EQ(mirror.planes[i].area_m2, map.planes[i].area_m2);
      EXPECT_EQ(mirror.planes[i].plane_class, map.planes[i].plane_class);
      EXPECT_EQ(mirror.planes[i].point_count, map.planes[i].point_count);
    }
  }
};

TEST_F(LossyNetwork, EveryAnswerIsWholeThoughDatagramsAreLost) {
  ASSERT_NO_FATAL_FAILURE(start_lossy_daemon());
  ASSERT_NO_FATAL_FAILURE(build_map());
  const auto client = connect(kLcmUrl);
  const auto whole = ask_everything(*client);
  ASSERT_GT(whole.at("planes"), 5);
  ASSERT_GT(whole.at("ranges"), 100.0);
  for (const int percent : {5, 20}) {
    lose_datagrams(percent);
    for (int round = 0; round < 3; ++round) EXPECT_EQ(ask_everything(*client), whole) << percent << " % lost";
    lose_datagrams(0);
  }
}

TEST_F(LossyNetwork, EveryAnswerIsWholeThoughDatagramsComeTwiceAndOutOfOrder) {
  ASSERT_NO_FATAL_FAILURE(start_lossy_daemon());
  ASSERT_NO_FATAL_FAILURE(build_map());
  const auto whole = ask_everything(*connect(kLcmUrl));
  const Relay relay({/*twice=*/0.2, /*late=*/0.3});
  const auto client = connect(kFarLcmUrl);
  for (int round = 0; round < 3; ++round) EXPECT_EQ(ask_everything(*client), whole);
  EXPECT_GT(relay.doubled(), 10);
  EXPECT_GT(relay.delayed(), 10);
}

TEST_F(LossyNetwork, AWatchEndsAsTheMapThoughItJoinsLateAndNewsAreLost) {
  for (const int percent : {5, 20}) {
    ASSERT_NO_FATAL_FAILURE(start_lossy_daemon());
    const auto kinect = start_kinect(kFrames);
    ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") >= 10; }, 30s)) << kinect->output();
    lose_datagrams(percent);
    const auto client = connect(kLcmUrl);
    const auto watch = client->watch();
    const auto first = watch->next(20s);
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_TRUE(first->new_map);
    ASSERT_NO_FATAL_FAILURE(follow(*watch, *kinect));
    lose_datagrams(0);
    const auto map = client->snapshot(10s);
    ASSERT_TRUE(map) << map.error().message;
    ASSERT_GT(map->planes.size(), 5u);
    expect_same_planes(watch->map(), *map);
    stop_daemon();
  }
}

TEST_F(LossyNetwork, AWatchEndsAsTheMapThoughNewsComeTwiceAndOutOfOrder) {
  ASSERT_NO_FATAL_FAILURE(start_lossy_daemon());
  const Relay relay({/*twice=*/0.2, /*late=*/0.3});
  const auto client = connect(kFarLcmUrl);
  const auto watch = client->watch();
  ASSERT_TRUE(watch->next(10s));  // from the beginning on
  const auto kinect = start_kinect(kFrames);
  ASSERT_NO_FATAL_FAILURE(follow(*watch, *kinect));
  const auto map = connect(kLcmUrl)->snapshot(10s);
  ASSERT_TRUE(map) << map.error().message;
  expect_same_planes(watch->map(), *map);
  EXPECT_GT(relay.doubled(), 10);
  EXPECT_GT(relay.delayed(), 10);
}

TEST_F(LossyNetwork, AWatchGoesOnWithTheMapOfADaemonThatWasStartedAnew) {
  ASSERT_NO_FATAL_FAILURE(start_lossy_daemon());
  ASSERT_NO_FATAL_FAILURE(build_map());
  const auto client = connect(kLcmUrl);
  const auto watch = client->watch();
  auto change = watch->next(10s);
  ASSERT_TRUE(change) << change.error().message;
  const std::int64_t first_epoch = watch->map().epoch;
  ASSERT_GT(watch->map().planes.size(), 5u);
  stop_daemon();
  ASSERT_NO_FATAL_FAILURE(start_lossy_daemon());
  do {
    change = watch->next(10s);
    ASSERT_TRUE(change) << change.error().message;
  } while (change->epoch == first_epoch);
  EXPECT_TRUE(change->new_map);
  EXPECT_GT(change->epoch, first_epoch);
  EXPECT_TRUE(watch->map().planes.empty()) << "nothing of the old map";
  const auto kinect = start_kinect(20);
  ASSERT_NO_FATAL_FAILURE(follow(*watch, *kinect));
  const auto map = client->snapshot(10s);
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_FALSE(map->planes.empty());
  expect_same_planes(watch->map(), *map);
}

TEST_F(LossyNetwork, AWatchSaysWhenTheDaemonIsNotThere) {
  client::LcmClientOptions options;
  options.silent_after = 300ms;
  const auto client = client::LcmMapClient::connect(kLcmUrl, options);
  ASSERT_TRUE(client);
  const auto watch = (*client)->watch();
  auto change = watch->next(200ms);
  ASSERT_FALSE(change);
  EXPECT_EQ(change.error().kind, client::Error::Kind::kUnreachable);
  EXPECT_EQ(change.error().message, "no planemap service answered on PLANEMAP_REQUEST within 0.2 s");
  ASSERT_NO_FATAL_FAILURE(start_lossy_daemon());
  ASSERT_TRUE(watch->next(10s));
  stop_daemon();
  do change = watch->next(1s);
  while (change);
  EXPECT_EQ(change.error().kind, client::Error::Kind::kUnreachable);
  EXPECT_EQ(change.error().message, "nothing was heard of a planemap service on PLANEMAP_STATUS for 0.3 s");
}

}  // namespace
}  // namespace planemap::system_test
