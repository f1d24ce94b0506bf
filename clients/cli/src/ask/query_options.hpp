#pragma once

#include <array>
#include <functional>
#include <planemap/client/map_client.hpp>
#include <planemap/client/query_types.hpp>
#include <string>
#include <vector>

#include "daemon_options.hpp"
#include "exit_code.hpp"

namespace CLI {
class App;
}

namespace planemap::cli {

/// What all questions to the daemon have in common.
struct QueryOptions {
  DaemonOptions daemon;
  client::PlaneFilter filter;
  double max_normal_deviation_deg = 0.0;  ///< 0: no limit
  bool json = false;

  client::PlaneFilter plane_filter() const;
};

/// Adds --json and those of the daemon.
void add_query_options(CLI::App& command, QueryOptions& options);
/// Adds --class, --min-area, --max-normal-deviation, --seen-since and --epoch.
void add_filter_options(CLI::App& command, QueryOptions& options);
/// An option of so many numbers, finite ones but for --box, in which negative ones need no ado.
void add_numbers(CLI::App& command, const std::string& name, std::vector<double>& numbers, int count,
                 const std::string& help, const std::string& type, bool required);

client::Vector3 vector_at(const std::vector<double>& numbers, std::size_t at);

/// To stdout; main() sees whether it could be written.
void print(const std::string& text);

/// Connects, asks, and prints what `text_of` makes of the answer; or says what went wrong.
template <class Ask, class TextOf>
ExitCode ask_and_print(const QueryOptions& options, const Ask& ask, const TextOf& text_of) {
  const auto client = connect(options.daemon);
  if (!client) return client.error();
  const auto answer = ask(**client, options.daemon.timeout());
  if (!answer) return complain(answer.error(), options.daemon);
  print(text_of(*answer));
  return ExitCode::kDone;
}

}  // namespace planemap::cli
