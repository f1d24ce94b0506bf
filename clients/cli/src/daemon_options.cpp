#include "daemon_options.hpp"

#include <CLI/CLI.hpp>
#include <planemap/client/lcm_map_client.hpp>

#include "command.hpp"

namespace planemap::cli {

std::chrono::milliseconds DaemonOptions::timeout() const {
  return std::chrono::ceil<std::chrono::milliseconds>(std::chrono::duration<double>(timeout_s));
}

void add_daemon_options(CLI::App& command, DaemonOptions& options) {
  options.lcm_url = client::default_lcm_url();
  command.add_option("-l,--lcm-url", options.lcm_url, "Where the daemon listens; default: LCM_DEFAULT_URL")
      ->type_name("URL")
      ->capture_default_str();
  command.add_option("--timeout", options.timeout_s, "Seconds to wait for an answer")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.01, 3600.0))
      ->capture_default_str();
}

ExitCode complain(const client::Error& error, const DaemonOptions& options) {
  using Kind = client::Error::Kind;
  if (error.kind == Kind::kNoNetwork) return complain(ExitCode::kUnreachable, error.message);
  if (error.kind != Kind::kUnreachable) return complain(ExitCode::kFailed, error.message);
  return complain(ExitCode::kUnreachable,
                  error.message + "; is planemapd running, and listening at " + options.lcm_url + " (--lcm-url)?");
}

}  // namespace planemap::cli
