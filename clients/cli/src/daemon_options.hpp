#pragma once

#include <chrono>
#include <string>

#include "exit_code.hpp"

namespace CLI {
class App;
}
namespace planemap::client {
struct Error;
}

namespace planemap::cli {

/// How a daemon is reached.
struct DaemonOptions {
  std::string lcm_url;     ///< empty: LCM_DEFAULT_URL, else LCM's own default
  double timeout_s = 5.0;  ///< for one answer

  std::chrono::milliseconds timeout() const;
};

/// Adds -l/--lcm-url and --timeout.
void add_daemon_options(CLI::App& command, DaemonOptions& options);

/// Says what went wrong, and returns the exit code for it.
ExitCode complain(const client::Error& error, const DaemonOptions& options);

}  // namespace planemap::cli
