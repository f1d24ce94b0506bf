#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <planemap/client/grpc_map_admin.hpp>
#include <string>
#include <utility>

#include "command.hpp"
#include "daemon_options.hpp"

namespace planemap::cli {
namespace {

using client::GrpcMapAdmin;

struct AdminOptions {
  ServerOptions server;
  bool json = false;
  std::string map;   ///< of save: file to copy; empty: the daemon is asked
  std::string copy;  ///< of save
};

/// What was done, for people and for programs.
struct Done {
  std::string text;
  nlohmann::ordered_json json;
};

using Do = std::function<client::Expected<Done>(GrpcMapAdmin& admin, GrpcMapAdmin::Timeout timeout)>;

client::Expected<Done> pause(GrpcMapAdmin& admin, GrpcMapAdmin::Timeout timeout) {
  return admin.pause(timeout).map([] {
    return Done{"paused: scans are dropped; the map stays and can be asked", {{"paused", true}}};
  });
}

client::Expected<Done> resume(GrpcMapAdmin& admin, GrpcMapAdmin::Timeout timeout) {
  return admin.resume(timeout).map([] { return Done{"scans are mapped", {{"paused", false}}}; });
}

client::Expected<Done> reset(GrpcMapAdmin& admin, GrpcMapAdmin::Timeout timeout) {
  return admin.reset(timeout).map([](std::int64_t epoch) {
    return Done{"a new, empty map has begun, epoch " + std::to_string(epoch), {{"epoch", epoch}}};
  });
}

client::Expected<Done> save(GrpcMapAdmin& admin, GrpcMapAdmin::Timeout timeout) {
  return admin.save(timeout).map([] { return Done{"the map is saved", {{"saved", true}}}; });
}

ExitCode run(const AdminOptions& options, const Do& action) {
  if (!options.map.empty()) return copy_map_file(options.map, options.copy);
  const auto connection = connect_to_server(options.server);
  if (!connection) return connection.error();
  GrpcMapAdmin admin(*connection);
  const auto done = action(admin, options.server.timeout());
  if (!done) return complain(done.error(), options.server);
  std::printf("%s\n", options.json ? done->json.dump().c_str() : done->text.c_str());
  return ExitCode::kDone;
}

CLI::App* add(CLI::App& app, Action& action, const char* name, const char* help, Do command_action,
              const std::shared_ptr<AdminOptions>& options = std::make_shared<AdminOptions>()) {
  CLI::App* command = app.add_subcommand(name, help);
  command->add_flag("--json", options->json, "Print one JSON object");
  add_server_options(*command, options->server);
  command->callback([options, &action, does = std::move(command_action)] {
    action = [options, does] { return run(*options, does); };
  });
  return command;
}

}  // namespace

void add_admin_commands(CLI::App& app, Action& action) {
  add(app, action, "pause", "Let the daemon drop scans until 'resume'; the map stays and can be asked", pause);
  add(app, action, "resume", "Let the daemon map scans again", resume);
  add(app, action, "reset", "Let the daemon forget its map and begin a new one", reset);
  const auto options = std::make_shared<AdminOptions>();
  CLI::App* command =
      add(app, action, "save", "Let the daemon commit its map to its file, or copy a map file", save, options);
  CLI::Option* map = command->add_option(
      "MAP", options->map, "Copy this file consistently, also while planemapd writes it; none: ask the daemon");
  CLI::Option* copy = command->add_option("OUT", options->copy, "The copy; written over");
  map->check(CLI::ExistingFile)->needs(copy);
  copy->needs(map);
}

}  // namespace planemap::cli
