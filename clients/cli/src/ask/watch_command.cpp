#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

#include "ask/answer_json.hpp"
#include "ask/query_options.hpp"
#include "checked_numbers.hpp"
#include "command.hpp"

namespace planemap::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kSilentAfter(5000);
constexpr milliseconds kLook(200);  // also how soon a signal is noticed

volatile std::sig_atomic_t g_is_stopped = 0;

struct WatchCommand {
  QueryOptions query;
  double seconds = 0.0;  ///< 0: for ever
  int changes = 0;       ///< 0: any number
};

std::vector<std::int64_t> ids_of(const std::vector<client::RemovedPlane>& removed) {
  std::vector<std::int64_t> ids;
  ids.reserve(removed.size());
  for (const client::RemovedPlane& plane : removed) ids.push_back(plane.id);
  return ids;
}

std::string json_text(const client::MapChange& change, const client::Map& map) {
  Json removed = Json::array();
  for (const client::RemovedPlane& plane : change.removed) {
    removed.push_back({{"id", plane.id}, {"mergedInto", plane.merged_into == 0 ? Json() : Json(plane.merged_into)}});
  }
  const Json json = {
      {"epoch", change.epoch},     {"sinceRevision", change.since_revision}, {"revision", change.revision},
      {"newMap", change.new_map},  {"caughtUp", change.caught_up},           {"added", change.added},
      {"changed", change.changed}, {"removed", std::move(removed)},          {"planes", map.planes.size()}};
  return json.dump() + '\n';
}

std::string plain_text(const client::MapChange& change, const client::Map& map) {
  std::string text = fmt::format("map {}, revision {}: {} planes", change.epoch, change.revision, map.planes.size());
  if (change.new_map) return text + " (from the beginning)\n";
  const auto list = [&](const char* what, const std::vector<std::int64_t>& ids) {
    if (!ids.empty()) text += fmt::format("; {} {}", what, fmt::join(ids, " "));
  };
  list("new", change.added);
  list("changed", change.changed);
  list("gone", ids_of(change.removed));
  for (const client::RemovedPlane& plane : change.removed) {
    if (plane.merged_into != 0) text += fmt::format(" ({} into {})", plane.id, plane.merged_into);
  }
  return text + (change.caught_up ? "; caught up after a loss\n" : "\n");
}

/// @return whether the output can be written
bool tell(const client::MapChange& change, const client::Map& map, bool json) {
  print(json ? json_text(change, map) : plain_text(change, map));
  return std::fflush(stdout) == 0;  // each change at once, also into a pipe; main() says what is wrong with it
}

ExitCode run(const WatchCommand& command) {
  const auto client = connect(command.query.daemon, std::max(command.query.daemon.timeout(), kSilentAfter));
  if (!client) return client.error();
  // A watch would wait for a daemon that is not there.
  if (const auto status = (*client)->status(command.query.daemon.timeout()); !status) {
    return complain(status.error(), command.query.daemon);
  }
  std::signal(SIGINT, [](int) { g_is_stopped = 1; });
  std::signal(SIGTERM, [](int) { g_is_stopped = 1; });
  const auto watch = (*client)->watch();
  const auto begin = Clock::now();
  const auto is_over = [&] {
    const double passed_s = std::chrono::duration<double>(Clock::now() - begin).count();
    return g_is_stopped != 0 || (command.seconds > 0.0 && passed_s >= command.seconds);
  };
  bool is_first = true;
  for (int told = 0; !is_over() && (command.changes == 0 || told < command.changes);) {
    const auto change = watch->next(is_first ? command.query.daemon.timeout() : kLook);
    if (!change && g_is_stopped != 0) break;  // the signal ended the wait
    if (!change) return complain(change.error(), command.query.daemon);
    is_first = false;
    if (change->empty()) continue;
    if (!tell(*change, watch->map(), command.query.json)) break;
    ++told;
  }
  return ExitCode::kDone;
}

}  // namespace

void add_watch_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("watch", "Tell of each change of the map, until it is interrupted");
  const auto options = std::make_shared<WatchCommand>();
  command->add_option("--for", options->seconds, "End after so many seconds")
      ->type_name("SECONDS")
      ->check(positive_number());
  command->add_option("--changes", options->changes, "End after so many changes; the first one is the whole map")
      ->type_name("N")
      ->check(whole_number(1, std::numeric_limits<int>::max()));
  add_query_options(*command, options->query);
  command->get_option("--json")->description("Print a JSON object a line");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli
