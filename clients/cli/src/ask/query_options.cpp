#include "ask/query_options.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>

#include "checked_numbers.hpp"

namespace planemap::cli {

client::PlaneFilter QueryOptions::plane_filter() const {
  client::PlaneFilter result = filter;
  if (max_normal_deviation_deg > 0.0) {
    result.max_normal_deviation_rad = max_normal_deviation_deg * std::numbers::pi / 180.0;
  }
  return result;
}

void add_query_options(CLI::App& command, QueryOptions& options) {
  add_daemon_options(command, options.daemon);
  command.add_flag("--json", options.json, "Print one JSON object");
}

void add_filter_options(CLI::App& command, QueryOptions& options) {
  const std::string group = "Only planes that";
  command.add_option("--class", options.filter.classes, "are of one of these classes; may be given more than once")
      ->type_name("CLASS")
      ->check(CLI::IsMember({"floor", "ceiling", "wall", "table", "slope", "other"}))
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->group(group);
  command.add_option("--min-area", options.filter.min_area_m2, "have at least this area, square metres")
      ->type_name("M2")
      ->check(not_negative_number())
      ->group(group);
  command
      .add_option("--max-normal-deviation", options.max_normal_deviation_deg,
                  "have a normal that is known to this standard deviation or better, degrees")
      ->type_name("DEG")
      ->check(positive_number())
      ->group(group);
  command.add_option("--seen-since", options.filter.seen_since_utime, "were last seen then or later, microseconds")
      ->type_name("UTIME")
      ->check(whole_number(std::numeric_limits<std::int64_t>::min()))
      ->group(group);
  command.add_option("--epoch", options.filter.epoch, "are of this life of the map: of another one there is no answer")
      ->type_name("EPOCH")
      ->check(whole_number(1))
      ->group(group);
}

void add_numbers(CLI::App& command, const std::string& name, std::vector<double>& numbers, int count,
                 const std::string& help, const std::string& type, bool required) {
  command.add_option(name, numbers, help)
      ->type_name(type)
      ->type_size(count)
      ->expected(1)
      ->required(required)
      ->check(coordinate(/*finite=*/name != "--box"));
}

client::Vector3 vector_at(const std::vector<double>& numbers, std::size_t at) {
  return {numbers.at(at), numbers.at(at + 1), numbers.at(at + 2)};
}

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
}

}  // namespace planemap::cli
