// planemap-soak: the daemon for minutes or hours, with clients that come and go; does its memory stay what it is?
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <support/program.hpp>

#include "harness/network.hpp"
#include "soak/soak_report.hpp"
#include "soak/soak_run.hpp"

namespace planemap::system_test {

namespace {

struct Arguments {
  SoakConfig soak;
  std::optional<double> warm_up_minutes;
  SoakSlack slack;
  bool json = false;
};

void define_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--minutes", arguments.soak.minutes, "how long")->check(CLI::Range(0.1, 1e5))->capture_default_str();
  app.add_option("--warm-up", arguments.warm_up_minutes, "minutes that don't count (default: a third)")
      ->check(CLI::Range(0.0, 1e5));
  app.add_option("--rate", arguments.soak.rate_hz, "scans a second")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--seed", arguments.soak.seed, "of the apartment, and of what clients do")->capture_default_str();
  app.add_option("--memory-slack", arguments.slack.memory_mb,
                 "MB that memory may grow by besides: what goes up and down in minutes")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  app.add_option("--lost-share", arguments.slack.lost_share,
                 "of the scans that may be lost where the machine stands still")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--set", arguments.soak.settings, "a further setting of the daemon")->type_name("KEY=VALUE");
  app.add_flag("--json", arguments.json, "one object instead of the table, with all readings");
  app.footer(
      "planemapd with a map file, the simulated Kinect and the clients are in a network namespace of their own.\n"
      "Exit codes: 0 all bounds are held, 1 one is missed or something failed, 2 wrong use.");
}

/// Says how it is going, once a minute; where somebody looks each time.
void tell(const SoakSample& sample) {
  const bool is_watched = isatty(STDERR_FILENO) == 1;
  static double next_s = 0.0;
  if (!is_watched && sample.at_s < next_s) return;
  next_s = sample.at_s + 60.0;
  std::fprintf(stderr, "%s%6.1f min  %7.1f MB, of these held %7.1f MB, %lld cells, %lld scans%s",
               is_watched ? "\r" : "", sample.at_s / 60.0, 1e-6 * sample.resident_b, 1e-6 * sample.heap_b,
               static_cast<long long>(sample.cells), static_cast<long long>(sample.scans), is_watched ? "" : "\n");
}

void soak(Arguments& arguments) {
  SoakConfig& config = arguments.soak;
  config.warm_up_minutes = arguments.warm_up_minutes.value_or(config.minutes / 3.0);
  if (config.warm_up_minutes >= config.minutes) throw std::invalid_argument("--warm-up must be less than --minutes");
  const std::string problem = enter_own_network();
  if (!problem.empty()) throw std::runtime_error(problem);
  add_multicast_route();
  const SoakResult result = run_soak(config, tell);
  if (isatty(STDERR_FILENO) == 1) std::fputc('\n', stderr);
  std::printf("%s\n", (arguments.json ? soak_json(config, result, arguments.slack)
                                      : soak_table(config, result, arguments.slack))
                          .c_str());
  std::fflush(stdout);
  const auto bounds = soak_bounds(config, result, arguments.slack);
  if (!std::all_of(bounds.begin(), bounds.end(), [](const SoakBound& bound) { return bound.held(); })) {
    throw std::runtime_error("a bound was missed");
  }
}

}  // namespace

}  // namespace planemap::system_test

int main(int argc, char** argv) {
  using namespace planemap::system_test;
  CLI::App app("planemap-soak: the daemon for long, with clients that come and go", "planemap-soak");
  Arguments arguments;
  define_options(app, arguments);
  return planemap::run_program(app, argc, argv, [&] { soak(arguments); });
}
