#pragma once

#include <chrono>
#include <memory>
#include <planemap/client/grpc_connection.hpp>
#include <planemap/client/map_client.hpp>
#include <string>
#include <tl/expected.hpp>

#include "exit_code.hpp"

namespace CLI {
class App;
}

namespace planemap::cli {

/// How a daemon is reached over gRPC.
struct ServerOptions {
  std::string server = client::kDefaultServer;
  bool tls = false;
  std::string ca_file;
  std::string certificate_file;
  std::string key_file;
  std::string server_name;
  std::string token_file;
  double timeout_s = 5.0;  ///< for one answer

  std::chrono::milliseconds timeout() const;
};

/// How a daemon is reached, whichever way.
struct DaemonOptions : ServerOptions {
  std::string lcm_url;  ///< not empty: over LCM
};

/// Adds -s/--server and what belongs to it, and --timeout.
void add_server_options(CLI::App& command, ServerOptions& options);
/// Adds -l/--lcm-url, too.
void add_daemon_options(CLI::App& command, DaemonOptions& options);

/// A value; or the code to end with, after it was said what is wrong.
template <class T>
using OrExit = tl::expected<T, ExitCode>;

/// Over gRPC, or over LCM where its URL was given.
/// @param silent_after  how long a watch bears to hear nothing
OrExit<std::unique_ptr<client::MapClient>> connect(
    const DaemonOptions& options, std::chrono::milliseconds silent_after = std::chrono::milliseconds(5000));
OrExit<client::GrpcConnection> connect_to_server(
    const ServerOptions& options, std::chrono::milliseconds silent_after = std::chrono::milliseconds(5000));

/// Says what went wrong, and returns the exit code for it.
ExitCode complain(const client::Error& error, const DaemonOptions& options);
ExitCode complain(const client::Error& error, const ServerOptions& options);

}  // namespace planemap::cli
