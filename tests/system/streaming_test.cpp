// Scans streaming over real multicast into the real daemon: recordings through lcm-logplayer, and the simulated Kinect.
#include <algorithm>
#include <csignal>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/status_t.hpp>
#include <set>
#include <string>

#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

constexpr int kKitchenFrames = 300;
constexpr long kRawScanBuffer = 2 << 20;  // what a stream of 614 kB scans needs at the receiver, bytes

class Streaming : public SystemTest {
 protected:
  /// Writes the red kitchen as an LCM log, 15 scans a second as they were recorded.
  std::string kitchen_log() {
    const std::string path = (scratch_ / "kitchen.lcmlog").string();
    const char* encoding = "raw";
    if (greatest_receive_buffer() < kRawScanBuffer) {
      encoding = "zlib";
      std::printf(
          "net.core.rmem_max is %ld: compressed scans instead of 614 kB ones (sysctl -w net.core.rmem_max=%ld)\n",
          greatest_receive_buffer(), kRawScanBuffer);
    }
    const Finished bridge = run({program("planemap-kinect-bridge"), "--dataset", recording("redkitchen"), "--encoding",
                                 encoding, "--log", path, "--quiet"},
                                120s);
    EXPECT_EQ(bridge.exit_code, 0) << bridge.err;
    return path;
  }

  /// Asks for the planes while they grow; each answer must be whole.
  nlohmann::json ask_for_planes() {
    const Finished asked = run({program("planemap"), "snapshot", "--json", "--lcm-url", kLcmUrl});
    EXPECT_EQ(asked.exit_code, 0) << asked.err;
    auto snapshot = nlohmann::json::parse(asked.out, nullptr, /*allow_exceptions=*/false);
    EXPECT_FALSE(snapshot.is_discarded()) << "not JSON: " << asked.out.substr(0, 200);
    EXPECT_TRUE(snapshot.contains("planes"));
    return snapshot;
  }

  void expect_every_scan_mapped(std::int64_t scans) {
    EXPECT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") >= scans; }, 30s));
    EXPECT_EQ(bus_->counter("scans.received"), scans);
    EXPECT_EQ(bus_->counter("scans.mapped"), scans);
    EXPECT_EQ(bus_->counter("scans.waiting"), 0);
    EXPECT_EQ(bus_->counters_beginning("scans.dropped."), 0);
    EXPECT_EQ(bus_->counters_beginning("scans.rejected."), 0);
  }

  /// Drives the simulated Kinect through a whole apartment in few, far apart steps: the slowest scans to map.
  void simulate(int seed, int frames) {
    const auto kinect =
        start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", std::to_string(seed),
                         "--frames", std::to_string(frames), "--rate", "15", "--quiet", "--lcm-url", kLcmUrl});
    ASSERT_EQ(kinect->wait_for(90s), 0) << kinect->output();
    expect_every_scan_mapped(frames);
  }
};

/// What lcm-logger wrote: each event must decode whole.
struct RecordedOutput {
  int deltas = 0;
  int statuses = 0;
  std::set<std::int64_t> plane_ids;
};

template <class Message>
void expect_decodes(const lcm::LogEvent& event, Message& message) {
  EXPECT_EQ(message.decode(event.data, 0, event.datalen), event.datalen);
}

RecordedOutput read_output(const std::string& path) {
  RecordedOutput output;
  lcm::LogFile log(path, "r");
  EXPECT_TRUE(log.good());
  for (const lcm::LogEvent* event = log.readNextEvent(); event != nullptr; event = log.readNextEvent()) {
    if (event->channel == "PLANEMAP_DELTA") {
      planemap_lcm::planes_t delta;
      expect_decodes(*event, delta);
      EXPECT_LE(event->datalen, 60000);
      for (const planemap_lcm::plane_t& plane : delta.planes) output.plane_ids.insert(plane.id);
      ++output.deltas;
    } else if (event->channel == "PLANEMAP_STATUS") {
      planemap_lcm::status_t status;
      expect_decodes(*event, status);
      ++output.statuses;
    }
  }
  return output;
}

TEST_F(Streaming, RedKitchenAtItsOwnSpeedOnOneCoreLosesNothing) {
  if (recording("redkitchen").empty()) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set";
  const std::string log = kitchen_log();
  // All the buffer that the kernel gives: a virtual machine may stand still for longer than three scans.
  const std::string buffer =
      "lcm.recv_buf_bytes=" + std::to_string(std::max(greatest_receive_buffer(), kRawScanBuffer));
  ASSERT_NO_FATAL_FAILURE(start_daemon({"--set", buffer}, {"taskset", "--cpu-list", "0"}));
  const std::string recorded = (scratch_ / "output.lcmlog").string();
  const auto logger = start(
      "lcm-logger", {"lcm-logger", "--quiet", "--channel", "PLANEMAP_(DELTA|STATUS)", "--lcm-url", kLcmUrl, recorded});
  const auto player = start("lcm-logplayer", {"lcm-logplayer", "--lcm-url", kLcmUrl, log});

  int answers_while_streaming = 0;
  ASSERT_TRUE(bus_->wait_until([&] { return bus_->counter("scans.mapped") > 0; }, 20s)) << player->output();
  while (player->running()) {
    ask_for_planes();
    if (player->running()) ++answers_while_streaming;
    bus_->listen_for(500ms);
  }
  EXPECT_GE(answers_while_streaming, 10);
  EXPECT_EQ(player->wait_for(1s), 0) << player->output();
  expect_every_scan_mapped(kKitchenFrames);

  std::size_t snapshot_bytes = 0;
  const auto count_bytes = [](const lcm::ReceiveBuffer* page, const std::string& /*channel*/, std::size_t* sum) {
    *sum += page->data_size;
  };
  auto* replies = bus_->lcm().subscribeFunction<std::size_t*>("PLANEMAP_REPLY.*", count_bytes, &snapshot_bytes);
  const nlohmann::json snapshot = ask_for_planes();
  bus_->listen_for(500ms);
  bus_->lcm().unsubscribe(replies);
  EXPECT_GT(snapshot_bytes, 10'000u);
  EXPECT_LE(snapshot_bytes, 60'000u) << "docs/lcm.md";
  const auto large = std::count_if(snapshot.at("planes").begin(), snapshot.at("planes").end(),
                                   [](const auto& plane) { return plane.at("cellCount").template get<int>() >= 40; });
  EXPECT_GE(large, 20);

  logger->send_signal(SIGINT);
  ASSERT_TRUE(logger->wait_for(10s));
  const RecordedOutput output = read_output(recorded);
  EXPECT_GT(output.deltas, 20);
  EXPECT_GT(output.statuses, 20);
  for (const auto& plane : snapshot.at("planes")) {
    EXPECT_TRUE(output.plane_ids.contains(plane.at("id").get<std::int64_t>()))
        << "no delta told of plane " << plane.at("id");
  }
}

TEST_F(Streaming, SimulatedApartmentGivesPlanes) {
  ASSERT_NO_FATAL_FAILURE(start_daemon({"--set", "map.gravity=[0, 0, -1]"}));
  ASSERT_NO_FATAL_FAILURE(simulate(/*seed=*/3, /*frames=*/90));
  const nlohmann::json snapshot = ask_for_planes();
  std::set<std::string> classes;
  for (const auto& plane : snapshot.at("planes")) classes.insert(plane.at("class").get<std::string>());
  EXPECT_GE(snapshot.at("planes").size(), 8u);
  EXPECT_TRUE(classes.contains("floor")) << snapshot.dump().substr(0, 500);
  EXPECT_TRUE(classes.contains("wall"));
  const Finished status = run({program("planemap"), "status", "--lcm-url", kLcmUrl});
  EXPECT_EQ(status.exit_code, 0) << status.err;
}

TEST_F(Streaming, ExportsOfTheRunningDaemonAreWhole) {
  ASSERT_NO_FATAL_FAILURE(start_daemon({"--set", "map.gravity=[0, 0, -1]"}));
  ASSERT_NO_FATAL_FAILURE(simulate(/*seed=*/4, /*frames=*/60));
  std::vector<std::string> command = {program("planemap"), "export", "-"};
  for (const char* name : {"floor.svg", "cells.ply", "cells.csv", "planes.json"})
    command.push_back((scratch_ / name).string());
  command.insert(command.end(), {"--lcm-url", kLcmUrl});
  const Finished exported = run(command);
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const nlohmann::json planes = nlohmann::json::parse(read_file(scratch_ / "planes.json"));
  EXPECT_EQ(planes.at("planes").size(), static_cast<std::size_t>(bus_->status()->plane_count));
  EXPECT_TRUE(read_file(scratch_ / "cells.ply").starts_with("ply\n"));
  EXPECT_TRUE(
      read_file(scratch_ / "cells.csv").starts_with("x,y,z,plane_id,count,nx,ny,nz,normal_deviation_deg,sx,sy,sz\n"));
  const Finished well_formed = run({"xmllint", "--noout", (scratch_ / "floor.svg").string()});
  EXPECT_EQ(well_formed.exit_code, 0) << well_formed.err;
}

TEST_F(Streaming, RealLogOfPosesIsHeardAndMapsNothing) {
  const std::string log = recording("lcm/poses-only-bot_core.lcmlog");
  if (log.empty()) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set";
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const auto player = start("lcm-logplayer", {"lcm-logplayer", "--speed", "10", "--lcm-url", kLcmUrl, log});
  ASSERT_EQ(player->wait_for(120s), 0) << player->output();
  EXPECT_TRUE(bus_->wait_until([&] { return bus_->counter("poses.received") >= 557; }, 10s));
  EXPECT_EQ(bus_->counter("poses.received"), 557);
  EXPECT_EQ(bus_->counters_beginning("poses.rejected."), 0);
  EXPECT_EQ(bus_->counter("scans.received"), 0);
  EXPECT_TRUE(bus_->wait_until([&] { return !bus_->status()->idle_reason.empty(); }, 10s));
}

TEST_F(Streaming, RealLogOfForeignTypesIsRejectedMessageByMessage) {
  const std::string log = recording("lcm/botlab-foreign-channels.lcmlog");
  if (log.empty()) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set";
  // Its laser scans and poses are of types that mean nothing to us, on the channels that we are told to take.
  ASSERT_NO_FATAL_FAILURE(
      start_daemon({"--set", "inputs.0.channel=RPLIDAR_LASER", "--set", "inputs.0.pose_channel=SLAM_POSE"}));
  const auto player = start("lcm-logplayer", {"lcm-logplayer", "--speed", "20", "--lcm-url", kLcmUrl, log});
  ASSERT_EQ(player->wait_for(120s), 0) << player->output();
  constexpr int kLaserScans = 459;
  constexpr int kPoses = 457;
  EXPECT_TRUE(bus_->wait_until(
      [&] {
        return bus_->counters_beginning("scans.rejected.") >= kLaserScans &&
               bus_->counters_beginning("poses.rejected.") >= kPoses;
      },
      10s));
  EXPECT_EQ(bus_->counter("scans.received"), kLaserScans);
  EXPECT_EQ(bus_->counters_beginning("scans.rejected."), kLaserScans);
  EXPECT_EQ(bus_->counters_beginning("poses.rejected."), kPoses);
  EXPECT_EQ(bus_->status()->plane_count, 0);
  EXPECT_TRUE(bus_->wait_until([&] { return !bus_->status()->idle_reason.empty(); }, 10s));
}

}  // namespace
}  // namespace planemap::system_test
