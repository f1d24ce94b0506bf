#include "soak/soak_run.hpp"

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <planemap/client/grpc_connection.hpp>
#include <sstream>
#include <stdexcept>

#include "harness/bus.hpp"
#include "harness/network.hpp"
#include "soak/visitors.hpp"
#include "support/http_client.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::system_test {

namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using Clock = std::chrono::steady_clock;

constexpr std::uint16_t kHttpPort = 7671;
constexpr auto kSamplePeriod = 500ms;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string program(const char* name) {
  return std::string(PLANEMAP_BIN_DIR "/") + name;
}

std::vector<std::string> daemon_command(const SoakConfig& config, const TemporaryFolder& scratch) {
  std::vector<std::string> command = {program("planemapd"),
                                      "--config",
                                      PLANEMAP_PROJECT_DIR "/deploy/planemapd.yaml",
                                      "--lcm-url",
                                      kLcmUrl,
                                      "--map",
                                      (scratch / "soak.planemap").string(),
                                      "--set",
                                      "map.gravity=[0, 0, -1]"};
  for (const std::string& setting : config.settings) command.insert(command.end(), {"--set", setting});
  return command;
}

std::vector<std::string> kinect_command(const SoakConfig& config) {
  // Compressed: the receive buffers that a kernel gives by default hold no burst of raw scans.
  return {program("planemap-kinect-bridge"),
          "--simulate",
          "apartment",
          "--seed",
          std::to_string(config.seed),
          "--frames",
          std::to_string(config.tour_scans),
          "--rate",
          std::to_string(config.rate_hz),
          "--encoding",
          "zlib",
          "--loop",
          "--quiet",
          "--json",
          "--lcm-url",
          kLcmUrl};
}

/// A metric without labels. Throws std::runtime_error where the daemon does not tell it.
double metric(const std::string& page, const std::string& name) {
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(name + " ")) return std::stod(line.substr(name.size() + 1));
  }
  throw std::runtime_error("/metrics has no " + name);
}

SoakSample look_at(double at_s) {
  const HttpReply reply = http_get(kHttpPort, "/metrics");
  if (reply.status != 200) throw std::runtime_error("/metrics: status " + std::to_string(reply.status));
  return {at_s, metric(reply.body, "process_resident_memory_bytes"), metric(reply.body, "planemap_heap_used_bytes"),
          static_cast<std::int64_t>(metric(reply.body, "planemap_map_cells")),
          static_cast<std::int64_t>(metric(reply.body, "planemap_scan_seconds_count"))};
}

void fail_if_ended(Process& process, const char* name) {
  if (!process.running()) throw std::runtime_error(std::string(name) + " ended; it said:\n" + process.output());
}

/// Ends the Kinect. @return how many scans it sent
std::int64_t end_kinect(Process& kinect) {
  kinect.send_signal(SIGINT);
  if (!kinect.wait_for(20s)) throw std::runtime_error("the Kinect bridge does not end");
  const auto summary = nlohmann::json::parse(kinect.output(), nullptr, /*allow_exceptions=*/false);
  if (!summary.is_object()) throw std::runtime_error("the Kinect bridge said:\n" + kinect.output());
  return summary.at("frames").get<std::int64_t>();
}

}  // namespace

SoakResult run_soak(const SoakConfig& config, const std::function<void(const SoakSample&)>& progress) {
  const TemporaryFolder scratch;
  Bus bus;
  Process daemon(daemon_command(config, scratch), scratch / "planemapd.log");
  bus.wait_until([&] { return bus.status().has_value() || !daemon.running(); }, 20s);
  fail_if_ended(daemon, "planemapd");
  Process kinect(kinect_command(config), scratch / "kinect.log");
  const auto scans_come = [&] { return bus.counter("scans.mapped") > 0 || !kinect.running() || !daemon.running(); };
  if (!bus.wait_until(scans_come, 60s)) throw std::runtime_error("no scan is mapped: " + bus.describe());

  SoakResult result;
  {
    const Visitors visitors(kLcmUrl, client::kDefaultServer, kHttpPort, config.seed);
    const auto begin = Clock::now();
    for (double at_s = 0.0; at_s < 60.0 * config.minutes; at_s = seconds_since(begin)) {
      fail_if_ended(daemon, "planemapd");
      fail_if_ended(kinect, "the Kinect bridge");
      result.samples.push_back(look_at(at_s));
      progress(result.samples.back());
      bus.listen_for(kSamplePeriod);
    }
    result.visits = visitors.visits();
    result.complaints = visitors.complaints();
  }
  result.sent = end_kinect(kinect);
  // The last scans are still under way; what was lost does not come.
  bus.wait_until([&] { return bus.counter("scans.received") >= result.sent && bus.counter("scans.waiting") == 0; },
                 10s);
  fail_if_ended(daemon, "planemapd");
  for (const auto& counter : bus.status()->counters) result.counters[counter.name] = counter.value;
  daemon.send_signal(SIGTERM);
  result.daemon_exit_code = daemon.wait_for(20s).value_or(-1);
  return result;
}

}  // namespace planemap::system_test
