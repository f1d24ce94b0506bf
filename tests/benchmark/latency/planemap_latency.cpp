// planemap-latency: from a scan and its pose on the bus to the delta on the bus, through the real daemon.
#include <sched.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <harness/network.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <support/program.hpp>

#include "common/machine.hpp"
#include "frame_source.hpp"
#include "latency/latency_report.hpp"
#include "latency/latency_run.hpp"

namespace planemap::benchmark {

namespace {

struct Arguments {
  LatencyConfig latency;
  FrameOptions from;
  std::size_t frames = 300;
  double seconds = 30.0;
  std::string planemapd = PLANEMAP_BIN_DIR "/planemapd";
  bool json = false;
};

void define_options(CLI::App& app, Arguments& arguments) {
  define_frame_options(app, arguments.from);
  app.add_option("--frames", arguments.frames, "how many, at most; they go forth and back")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "how long scans are sent")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.add_option("--rate", arguments.latency.rate_hz, "scans a second")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--pose-rate", arguments.latency.pose_rate_hz, "poses a second")
      ->check(CLI::Range(1.0, 10000.0))
      ->capture_default_str();
  app.add_flag("--zlib", arguments.latency.compressed, "compressed scans instead of raw ones");
  app.add_option("--set", arguments.latency.settings, "a further setting of the daemon")->type_name("KEY=VALUE");
  app.add_option("--planemapd", arguments.planemapd, "the daemon's program")->type_name("FILE")->capture_default_str();
  app.add_flag("--json", arguments.json, "one object instead of the table");
  app.footer(
      "The daemon has one core for itself, sender and listener have the others; all in a network namespace of their "
      "own.\nTimes are the kernel's, of the last datagram of each message. A scan is in the first delta whose utime "
      "is not before\nits own. Exit codes: 0 done, whether or not the bounds are held; 1 failed, 2 wrong use.");
}

/// Leaves one core to the daemon and keeps to the others, where there are any.
/// @return the daemon's
int share_cores() {
  cpu_set_t all;
  CPU_ZERO(&all);
  if (sched_getaffinity(0, sizeof(all), &all) != 0) throw std::runtime_error("this process's cores are not known");
  int core = 0;
  while (CPU_ISSET(core, &all) == 0) ++core;
  if (CPU_COUNT(&all) == 1) {
    std::fprintf(stderr, "planemap-latency: there is but one core; the daemon shares it with sender and listener\n");
    return core;
  }
  CPU_CLR(core, &all);
  if (sched_setaffinity(0, sizeof(all), &all) != 0) throw std::runtime_error("cannot keep to a part of the cores");
  return core;
}

void measure(Arguments& arguments) {
  // Before the first thread, and the first child: both hold for what is started from here on.
  const std::string problem = system_test::enter_own_network();
  if (!problem.empty()) throw std::runtime_error(problem);
  system_test::add_multicast_route();
  const auto frames = read_frames(*open_frames(arguments.from, std::nullopt), arguments.frames);
  arguments.latency.url = system_test::kLcmUrl;
  arguments.latency.scans =
      static_cast<std::size_t>(std::max(1.0, std::round(arguments.seconds * arguments.latency.rate_hz)));
  arguments.latency.daemon = {"taskset", "--cpu-list", std::to_string(share_cores()), arguments.planemapd};
  const LatencyResult result = run_latency(arguments.latency, frames);
  if (result.scans.empty()) throw std::runtime_error("no delta was heard for any scan");
  if (arguments.json) {
    std::printf("%s\n", latency_json(arguments.latency, result).c_str());
  } else {
    std::printf("%s\n%s", text_of(this_machine()).c_str(), latency_table(arguments.latency, result).c_str());
  }
}

}  // namespace

}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  using namespace planemap::benchmark;
  CLI::App app("planemap-latency: from a scan and its pose on the bus to the delta on the bus", "planemap-latency");
  Arguments arguments;
  define_options(app, arguments);
  return planemap::run_program(app, argc, argv, [&] { measure(arguments); });
}
