#include "daemon_options.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <planemap/client/grpc_map_client.hpp>
#include <planemap/client/lcm_map_client.hpp>
#include <sstream>
#include <utility>

#include "command.hpp"

namespace planemap::cli {
namespace {

using Kind = client::Error::Kind;

CLI::Option* add_file(CLI::App& command, const char* name, std::string& file, const char* help) {
  return command.add_option(name, file, help)->type_name("FILE")->group("The daemon");
}

/// The text of a file that an option names; of none where it names none.
OrExit<std::string> text_of(const char* option, const std::string& name) {
  if (name.empty()) return std::string();
  std::ifstream file(name, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (file && text) return text.str();
  return tl::make_unexpected(
      complain(ExitCode::kWrongUse, std::string(option) + ": " + name + ": cannot be read: " + std::strerror(errno)));
}

OrExit<std::string> token_of(const std::string& name) {
  auto text = text_of("--token-file", name);
  if (!text || name.empty()) return text;
  std::istringstream words(*text);
  std::string token;
  std::string more;
  if (words >> token && !(words >> more)) return token;
  return tl::make_unexpected(
      complain(ExitCode::kWrongUse, "--token-file: " + name + ": must hold one token and nothing else"));
}

ExitCode complain_of(const client::Error& error, const std::string& hint) {
  switch (error.kind) {
    case Kind::kNoNetwork:
      return complain(ExitCode::kUnreachable, error.message);
    case Kind::kUnreachable:
      return complain(ExitCode::kUnreachable, error.message + hint);
    case Kind::kDenied:
      return complain(ExitCode::kFailed, error.message + " (--token-file)");
    default:
      return complain(ExitCode::kFailed, error.message);
  }
}

}  // namespace

std::chrono::milliseconds ServerOptions::timeout() const {
  return std::chrono::ceil<std::chrono::milliseconds>(std::chrono::duration<double>(timeout_s));
}

void add_server_options(CLI::App& command, ServerOptions& options) {
  const std::string group = "The daemon";
  command
      .add_option("-s,--server", options.server, "Where it listens for gRPC (grpc.listen); the port may be left out")
      ->type_name("HOST:PORT")
      ->capture_default_str()
      ->group(group);
  command.add_flag("--tls", options.tls, "Over TLS, by the authorities that this system trusts")->group(group);
  add_file(command, "--ca-file", options.ca_file,
           "Over TLS: PEM of the authority that signed the server's certificate");
  auto* certificate =
      add_file(command, "--certificate-file", options.certificate_file, "PEM: shown to a server that asks for one");
  auto* key = add_file(command, "--key-file", options.key_file, "PEM: the private key of that certificate");
  certificate->needs(key);
  key->needs(certificate);
  command.add_option("--server-name", options.server_name, "Name in the server's certificate, if it is not HOST")
      ->type_name("NAME")
      ->group(group);
  add_file(command, "--token-file", options.token_file, "Holds the token that the server asks for");
  command.add_option("--timeout", options.timeout_s, "Seconds to wait for an answer")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.01, 3600.0))
      ->capture_default_str()
      ->group(group);
}

void add_daemon_options(CLI::App& command, DaemonOptions& options) {
  add_server_options(command, options);
  auto* lcm_url = command.add_option("-l,--lcm-url", options.lcm_url, "Over LCM instead; 'default': LCM_DEFAULT_URL")
                      ->type_name("URL")
                      ->group("The daemon");
  for (const char* name :
       {"--server", "--tls", "--ca-file", "--certificate-file", "--key-file", "--server-name", "--token-file"}) {
    lcm_url->excludes(command.get_option(name));
  }
}

OrExit<client::GrpcConnection> connect_to_server(const ServerOptions& options, std::chrono::milliseconds silent_after) {
  client::GrpcClientOptions grpc;
  grpc.tls = options.tls;
  grpc.server_name = options.server_name;
  grpc.silent_after = silent_after;
  const std::pair<OrExit<std::string>, std::string*> texts[] = {
      {text_of("--ca-file", options.ca_file), &grpc.ca},
      {text_of("--certificate-file", options.certificate_file), &grpc.client_certificate},
      {text_of("--key-file", options.key_file), &grpc.client_key},
      {token_of(options.token_file), &grpc.token}};
  for (const auto& [text, place] : texts) {
    if (!text) return tl::make_unexpected(text.error());
    *place = *text;
  }
  auto connection = client::GrpcConnection::open(options.server, grpc);
  if (!connection) return tl::make_unexpected(complain(ExitCode::kWrongUse, connection.error().message));
  return *connection;
}

OrExit<std::unique_ptr<client::MapClient>> connect(const DaemonOptions& options,
                                                   std::chrono::milliseconds silent_after) {
  if (options.lcm_url.empty()) {
    const auto connection = connect_to_server(options, silent_after);
    if (!connection) return tl::make_unexpected(connection.error());
    return std::make_unique<client::GrpcMapClient>(*connection);
  }
  client::LcmClientOptions lcm;
  lcm.silent_after = silent_after;
  const std::string url = options.lcm_url == "default" ? client::default_lcm_url() : options.lcm_url;
  auto client = client::LcmMapClient::connect(url, lcm);
  if (!client) return tl::make_unexpected(complain(client.error(), options));
  return std::move(*client);
}

ExitCode complain(const client::Error& error, const ServerOptions& /*options*/) {
  return complain_of(error, "; is planemapd running, with grpc.listen there (--server)?");
}

ExitCode complain(const client::Error& error, const DaemonOptions& options) {
  return complain_of(error, options.lcm_url.empty()
                                ? "; is planemapd running, with grpc.listen there (--server)? --lcm-url asks over LCM"
                                : "; is planemapd running, and listening at " + options.lcm_url + " (--lcm-url)?");
}

}  // namespace planemap::cli
