#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "command.hpp"
#include "daemon_options.hpp"
#include "export/status_json.hpp"

namespace planemap::cli {
namespace {

struct StatusOptions {
  DaemonOptions daemon;
  bool json = false;
};

std::int64_t sum_of(const client::Status& status, const std::string& prefix) {
  std::int64_t sum = 0;
  for (const auto& counter : status.counters) sum += counter.first.rfind(prefix, 0) == 0 ? counter.second : 0;
  return sum;
}

std::string plain_text(const client::Status& status) {
  std::string text = fmt::format("planemapd {}, map {}, revision {}\n", status.version, status.epoch, status.revision);
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<10}{}\n", name, value);
  };
  line("planes", fmt::to_string(status.plane_count));
  line("cells", fmt::format("{} in {} blocks", status.cell_count, status.block_count));
  line("mapping", fmt::format("{:.1f} scans/s, {:.1f} ms a scan (median), {:.1f} ms at most", status.scan_rate_hz,
                              status.scan_ms_p50, status.scan_ms_max));
  if (!status.idle_reason.empty()) line("idle", status.idle_reason);
  if (!status.degraded.empty()) line("degraded", status.degraded);
  line("scans",
       fmt::format("{} received = {} mapped + {} dropped + {} rejected + {} waiting", sum_of(status, "scans.received"),
                   sum_of(status, "scans.mapped"), sum_of(status, "scans.dropped."), sum_of(status, "scans.rejected."),
                   sum_of(status, "scans.waiting")));
  std::size_t width = 0;
  for (const auto& counter : status.counters) width = std::max(width, counter.first.size());
  if (!status.counters.empty()) text += "  counters\n";
  for (const auto& counter : status.counters) {
    text += fmt::format("    {:<{}}  {:>12}\n", counter.first, width, counter.second);
  }
  return text;
}

ExitCode run(const StatusOptions& options) {
  const auto client = connect(options.daemon);
  if (!client) return client.error();
  const auto status = (*client)->status(options.daemon.timeout());
  if (!status) return complain(status.error(), options.daemon);
  std::fputs((options.json ? status_json(*status) + '\n' : plain_text(*status)).c_str(), stdout);
  return ExitCode::kDone;
}

}  // namespace

void add_status_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("status", "Ask the daemon how it is: map, rates, counters, why it is idle");
  const auto options = std::make_shared<StatusOptions>();
  add_daemon_options(*command, options->daemon);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli
