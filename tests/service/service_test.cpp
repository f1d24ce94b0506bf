// The whole service on a bus of its own, with real threads, messages and maps.

#include "service.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <planemap/client/lcm_map_client.hpp>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/reply_t.hpp>
#include <planemap_lcm/status_t.hpp>

#include "support/messages.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::planes_t;
using planemap_lcm::reply_t;
using planemap_lcm::request_t;
using planemap_lcm::status_t;

constexpr std::int64_t kSecond = 1000000;

/// A client and a sensor on the service's bus.
class ServiceTest : public testing::Test {
 protected:
  explicit ServiceTest(const ServiceConfig& config = make_config())
      : bus_("memq://"), service_(config, bus_, /*epoch=*/1234) {
    bus_.subscribe("PLANEMAP_STATUS", &ServiceTest::on_status, this);
    bus_.subscribe("PLANEMAP_DELTA", &ServiceTest::on_delta, this);
    bus_.subscribe("PLANEMAP_REPLY.*", &ServiceTest::on_reply, this);
  }
  static ServiceConfig make_config() {
    ServiceConfig config;
    config.publish.status_period_s = 0.05;
    config.publish.delta_period_s = 0.01;
    config.publish.page_bytes = 4096;
    config.queue.scans = 1000;
    return config;
  }

  void send(const std::string& channel, const Bytes& bytes) {
    ASSERT_EQ(bus_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())), 0);
  }
  void send_wall(int i, std::uint16_t depth_mm = 1000, double x_m = 0.0) {
    const std::int64_t utime = 10 * kSecond + i * 33333;
    send("POSE", encoded(pose_message(utime, x_m)));
    send("PLANEMAP_SCAN", encoded(zipped(wall_message(utime, i, depth_mm))));
  }
  /// Handles the bus until the condition holds. @return false after half a minute
  template <class Condition>
  bool handle_until(const Condition& holds) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!holds()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      service_.handle(5);
    }
    return true;
  }
  bool mapped(std::int64_t scans) {
    return handle_until([&] { return service_.counters().at("scans.mapped") >= scans; });
  }
  std::int64_t counter(const std::string& name) const {
    const auto values = service_.counters();
    const auto found = values.find(name);
    return found == values.end() ? 0 : found->second;
  }
  /// Asks and waits for the number of pages that the first one tells.
  std::vector<reply_t> ask(const request_t& request) {
    replies_.clear();
    send("PLANEMAP_REQUEST", encoded(request));
    const bool one_page = request.page >= 0;
    EXPECT_TRUE(handle_until([&] {
      return !replies_.empty() && (one_page || replies_.size() == static_cast<std::size_t>(replies_[0].page_count));
    }));
    return replies_;
  }

  void on_status(const lcm::ReceiveBuffer*, const std::string&, const status_t* status) {
    statuses_.push_back(*status);
  }
  void on_delta(const lcm::ReceiveBuffer*, const std::string&, const planes_t* delta) { deltas_.push_back(*delta); }
  void on_reply(const lcm::ReceiveBuffer*, const std::string&, const reply_t* reply) { replies_.push_back(*reply); }

  lcm::LCM bus_;
  Service service_;
  std::vector<status_t> statuses_;
  std::vector<planes_t> deltas_;
  std::vector<reply_t> replies_;
};

TEST_F(ServiceTest, ScansBecomePlanesInDeltas) {
  for (int i = 0; i < 5; ++i) send_wall(i);
  ASSERT_TRUE(mapped(5));
  const auto revision = static_cast<std::int64_t>(service_.snapshot()->revision());
  ASSERT_TRUE(handle_until([&] { return !deltas_.empty() && deltas_.back().revision == revision; }));
  std::map<std::int64_t, planemap_lcm::plane_t> planes;
  std::int64_t told = 0;
  for (const auto& delta : deltas_) {
    EXPECT_EQ(delta.epoch, 1234);
    EXPECT_EQ(delta.since_revision, told) << "deltas follow each other";
    told = delta.revision;
    for (const auto& plane : delta.planes) planes[plane.id] = plane;
    for (const auto& removed : delta.removed) planes.erase(removed.id);
  }
  ASSERT_EQ(planes.size(), 1u);
  const auto& wall = planes.begin()->second;
  EXPECT_NEAR(wall.normal[2], -1.0, 1e-6);
  EXPECT_NEAR(wall.d, 1.0, 1e-3);
  EXPECT_NEAR(wall.area_m2, 1.07 * 0.8, 0.15);
  EXPECT_EQ(counter("scans.received"), 5);
  EXPECT_EQ(counter("scans.waiting"), 0);
}

TEST_F(ServiceTest, PlanesAreAsUncertainAsThePosesSay) {
  for (int i = 0; i < 5; ++i) {
    const std::int64_t utime = 10 * kSecond + i * 33333;
    send("POSE", encoded(pose_cov_message(utime, 0.0, 0.004, 0.002)));
    send("PLANEMAP_SCAN", encoded(zipped(wall_message(utime, i))));
  }
  ASSERT_TRUE(mapped(5));
  EXPECT_EQ(counter("poses.with_covariance"), 5);
  const auto snapshot = ask(request_message(request_t::OPERATION_SNAPSHOT, 41));
  ASSERT_EQ(snapshot.at(0).n_planes, 1);
  // Five poses that each err on their own by 4 mm towards the wall, which is right before the sensor.
  EXPECT_NEAR(snapshot[0].planes[0].covariance[9], 16e-6 / 5, 0.2e-6);
}

TEST_F(ServiceTest, SnapshotAndCellsArriveWhole) {
  for (int i = 0; i < 3; ++i) send_wall(i);
  ASSERT_TRUE(mapped(3));
  const auto snapshot = ask(request_message(request_t::OPERATION_SNAPSHOT, 41));
  ASSERT_EQ(snapshot.size(), 1u);
  EXPECT_EQ(snapshot[0].request_id, 41);
  EXPECT_EQ(snapshot[0].status, reply_t::STATUS_OK) << snapshot[0].error;
  EXPECT_EQ(snapshot[0].epoch, 1234);
  ASSERT_EQ(snapshot[0].n_planes, 1);
  EXPECT_GT(snapshot[0].planes[0].point_count, 3 * 4800 * 8 / 10);
  EXPECT_LE(snapshot[0].planes[0].point_count, 3 * 4800);
  const auto cells = ask(request_message(request_t::OPERATION_CELLS, 42));
  ASSERT_GT(cells.size(), 1u);
  std::size_t count = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(cells[i].page, static_cast<std::int32_t>(i));
    EXPECT_EQ(cells[i].request_id, 42);
    count += cells[i].cells.size();
  }
  EXPECT_GT(count, 80u);
  auto again = request_message(request_t::OPERATION_CELLS, 43, /*page=*/1);
  again.epoch = cells[1].epoch;
  again.revision = cells[1].revision;
  const auto lost = ask(again);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].request_id, 43);
  EXPECT_EQ(lost[0].page, 1);
  EXPECT_EQ(lost[0].cells.size(), cells[1].cells.size());
}

TEST_F(ServiceTest, CellsComeOfTheRevisionOfThePlanesThoughTheMapGoesOn) {
  send_wall(0);
  ASSERT_TRUE(mapped(1));
  const auto planes = ask(request_message(request_t::OPERATION_SNAPSHOT, 1)).at(0);
  send_wall(1, 1300);
  ASSERT_TRUE(mapped(2));
  ASSERT_GT(static_cast<std::int64_t>(service_.snapshot()->revision()), planes.revision);
  auto request = request_message(request_t::OPERATION_CELLS, 2);
  request.epoch = planes.epoch;
  request.revision = planes.revision;
  std::int64_t cells = 0;
  for (const auto& page : ask(request)) {
    EXPECT_EQ(page.revision, planes.revision);
    for (const auto& cell : page.cells) {
      cells += cell.plane_id == planes.planes.at(0).id ? 1 : 0;
      EXPECT_NEAR(cell.centre_m[2], 1.0, 0.05) << "the wall behind it came later";
    }
  }
  EXPECT_EQ(cells, planes.planes.at(0).cell_count);
}

/// A service whose map begins anew where the pose jumps.
class ResettingService : public ServiceTest {
 protected:
  ResettingService() : ServiceTest(resetting_config()) {}
  static ServiceConfig resetting_config() {
    ServiceConfig config = make_config();
    config.pose.jump = "reset";
    return config;
  }
};

TEST_F(ResettingService, ReadersSeeANewEpochAfterAJump) {
  for (int i = 0; i < 3; ++i) send_wall(i);
  ASSERT_TRUE(mapped(3));
  ASSERT_TRUE(handle_until([&] { return !deltas_.empty() && deltas_.back().n_planes > 0; }));
  for (int i = 3; i < 5; ++i) send_wall(i, 1000, /*x_m=*/30.0);
  ASSERT_TRUE(mapped(5));
  ASSERT_TRUE(handle_until([&] { return deltas_.back().epoch == 1235; }));
  const auto begin = std::find_if(deltas_.begin(), deltas_.end(), [](const auto& d) { return d.epoch == 1235; });
  EXPECT_EQ(begin->since_revision, 0) << "the new map is told from its beginning";
  ASSERT_EQ(begin->n_planes, 1);
  EXPECT_NEAR(begin->planes[0].centroid_m[0], 30.0, 0.05);
  const auto snapshot = ask(request_message(request_t::OPERATION_SNAPSHOT)).at(0);
  EXPECT_EQ(snapshot.epoch, 1235);
  ASSERT_EQ(snapshot.n_planes, 1) << "nothing of the old map";
  EXPECT_NEAR(snapshot.planes[0].centroid_m[0], 30.0, 0.05);
  EXPECT_LE(snapshot.planes[0].point_count, 2 * 4800);
  const auto status = ask(request_message(request_t::OPERATION_STATUS)).at(0).service_status.at(0);
  EXPECT_EQ(status.epoch, 1235);
  EXPECT_EQ(status.plane_count, 1);
  EXPECT_EQ(counter("poses.jumps"), 1);
  EXPECT_EQ(counter("map.resets"), 1);
  EXPECT_EQ(counter("scans.mapped"), 5);
}

TEST_F(ServiceTest, ErrorsAreRepliesToo) {
  auto reply = ask(request_message(77));
  ASSERT_EQ(reply.size(), 1u);
  EXPECT_EQ(reply[0].status, reply_t::STATUS_UNKNOWN_OPERATION);
  EXPECT_FALSE(reply[0].error.empty());
  reply = ask(request_message(request_t::OPERATION_SNAPSHOT, 8, /*page=*/3));
  ASSERT_EQ(reply.size(), 1u);
  EXPECT_EQ(reply[0].status, reply_t::STATUS_GONE);
  auto elsewhere = request_message(request_t::OPERATION_STATUS);
  elsewhere.reply_channel = "PLANEMAP_SCAN";
  send("PLANEMAP_REQUEST", encoded(elsewhere));
  send("PLANEMAP_REQUEST", Bytes{1, 2, 3});
  ASSERT_TRUE(handle_until([&] { return counter("requests.received") == 4; }));
  EXPECT_EQ(counter("requests.rejected.reply_channel"), 1);
  EXPECT_EQ(counter("requests.rejected.unknown_type"), 1);
  EXPECT_EQ(counter("requests.answered_with_error"), 2);
}

TEST_F(ServiceTest, StatusSaysWhyNothingIsMappedAndThenHowItGoes) {
  ASSERT_TRUE(handle_until([&] { return !statuses_.empty(); }));
  EXPECT_EQ(statuses_[0].idle_reason, "no scan on PLANEMAP_SCAN yet");
  EXPECT_EQ(statuses_[0].epoch, 1234);
  send("PLANEMAP_SCAN", encoded(wall_message(kSecond, 0)));
  ASSERT_TRUE(handle_until([&] { return statuses_.back().idle_reason == "no pose on POSE yet"; }));
  for (int i = 0; i < 3; ++i) send_wall(i + 1);
  ASSERT_TRUE(mapped(3));
  const auto seen = statuses_.size();
  ASSERT_TRUE(handle_until([&] { return statuses_.size() > seen + 1; }));
  const status_t& status = statuses_.back();
  EXPECT_EQ(status.idle_reason, "");
  EXPECT_EQ(status.plane_count, 1);
  EXPECT_GT(status.cell_count, 80);
  EXPECT_GT(status.scan_ms_p50, 0.0);
  EXPECT_EQ(status.last_scan_utime, 10 * kSecond + 3 * 33333);
  std::map<std::string, std::int64_t> counters;
  for (const auto& entry : status.counters) counters[entry.name] = entry.value;
  EXPECT_EQ(counters.at("scans.mapped"), 3);
  EXPECT_EQ(counters.at("scans.received"), 4);
  EXPECT_EQ(counters.count("lcm.kernel_drops"), 1u);
  EXPECT_EQ(ask(request_message(request_t::OPERATION_STATUS)).at(0).n_status, 1);
}

TEST_F(ServiceTest, HostileMessagesOnEveryChannelLeaveItRunning) {
  const std::vector<Bytes> hostile = {{},
                                      {0},
                                      Bytes(100000, 0xff),
                                      encoded(request_message(1)),
                                      encoded(pose_message(-1)),
                                      encoded(wall_message(-1, 0)),
                                      encoded(planes_t{})};
  for (const char* channel : {"PLANEMAP_SCAN", "POSE", "PLANEMAP_REQUEST"}) {
    for (const auto& bytes : hostile) send(channel, bytes);
    for (const auto& good :
         {encoded(wall_message(kSecond, 1)), encoded(pose_message(kSecond)), encoded(request_message(1))}) {
      const Bytes half(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2));
      send(channel, half);
    }
  }
  for (int i = 0; i < 2; ++i) send_wall(i);
  ASSERT_TRUE(mapped(2));
  EXPECT_EQ(counter("scans.received"), 12);
  EXPECT_EQ(counter("scans.rejected.unknown_type") + counter("scans.rejected.truncated") +
                counter("scans.rejected.size") + counter("scans.rejected.time") +
                counter("scans.rejected.wrong_channel"),
            10);
  EXPECT_EQ(counter("scans.dropped.no_pose"), 0);
}

TEST_F(ServiceTest, StopsWithScansInTheQueue) {
  for (int i = 0; i < 20; ++i) send_wall(i);
  ASSERT_TRUE(mapped(1));
  service_.stop();
  EXPECT_EQ(counter("scans.received"),
            counter("scans.mapped") + counter("scans.waiting") + counter("scans.dropped.shutdown"));
}

TEST_F(ServiceTest, TheClientsWholeMapIsOfOneRevisionWhileMappingGoesOn) {
  // The bus is handled by whoever waits: the client hands the service its messages, too.
  client::LcmMapClient client(std::shared_ptr<lcm::LCM>(&bus_, [](lcm::LCM*) {}));
  std::int64_t revision = 0;
  for (int i = 0; i < 10; ++i) {
    send_wall(i, static_cast<std::uint16_t>(800 + 100 * i));  // on its way to the mapper while the client asks
    const auto map = client.whole_map(std::chrono::seconds(30));
    ASSERT_TRUE(map) << map.error().message;
    std::map<std::int64_t, std::int64_t> cells;
    for (const auto& cell : map->cells) ++cells[cell.plane_id];
    for (const auto& plane : map->planes) EXPECT_EQ(cells[plane.id], plane.cell_count) << "plane " << plane.id;
    EXPECT_GE(map->revision, revision);
    revision = map->revision;
  }
  EXPECT_GT(revision, 0);
}

TEST(Service, RefusesABusThatLetsItHearNothing) {
  lcm::LCM bus("nosuchprovider://");
  EXPECT_THROW(Service(ServiceConfig{}, bus, 1), std::runtime_error);
}

TEST(OpenBus, SaysHowToMendABusThatCannotBeOpened) {
  const auto bus = open_bus("nosuchprovider://");
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().message, "the LCM bus nosuchprovider:// cannot be opened");
  EXPECT_TRUE(open_bus("memq://"));
}

}  // namespace
}  // namespace planemap::service
