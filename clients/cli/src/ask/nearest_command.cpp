#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

#include "ask/answer_json.hpp"
#include "ask/query_options.hpp"
#include "checked_numbers.hpp"
#include "command.hpp"

namespace planemap::cli {
namespace {

struct NearestCommand {
  QueryOptions query;
  std::vector<double> point_m;
  double sigma_m = 0.0;
  std::vector<double> covariance_m2;  ///< 3x3, row-major; empty: none
  std::int32_t count = 5;
  double max_distance_m = 0.0;  ///< 0: no limit
};

std::string json_text(const client::NearestAnswer& answer) {
  Json planes = Json::array();
  for (const client::NearPlane& near : answer.points.front()) {
    planes.push_back({{"id", near.plane_id},
                      {"surfaceDistance", near.surface_distance_m},
                      {"surfacePoint", json_of(near.surface_point_m)},
                      {"signedDistance", near.signed_distance_m},
                      {"sigma", near.sigma_m},
                      {"mahalanobis", json_of_number(near.mahalanobis)},
                      {"foot", json_of(near.foot_m)},
                      {"footInside", near.foot_inside}});
  }
  Json json = json_of(answer.version);
  json["planes"] = std::move(planes);
  return json.dump() + '\n';
}

std::string table(const client::NearestAnswer& answer) {
  if (answer.points.front().empty()) return "no plane is near\n";
  std::string text = fmt::format("{:>6}{:>12}{:>12}{:>10}{:>13}   {:^30}  {}\n", "plane", "surface m", "signed m",
                                 "+- mm", "mahalanobis", "foot m", "foot inside");
  for (const client::NearPlane& near : answer.points.front()) {
    text += fmt::format("{:>6}{:>12.4f}{:>12.4f}{:>10.2f}{:>13.2f}   {:>10.4f}{:>10.4f}{:>10.4f}  {}\n", near.plane_id,
                        near.surface_distance_m, near.signed_distance_m, 1e3 * near.sigma_m, near.mahalanobis,
                        near.foot_m[0], near.foot_m[1], near.foot_m[2], near.foot_inside ? "yes" : "no");
  }
  return text;
}

ExitCode run(const NearestCommand& command) {
  client::QueryPoint point;
  point.point_m = vector_at(command.point_m, 0);
  point.sigma_m = command.sigma_m;
  std::copy(command.covariance_m2.begin(), command.covariance_m2.end(), point.covariance_m2.begin());
  client::NearestOptions options;
  options.count = command.count;
  if (command.max_distance_m > 0.0) options.max_distance_m = command.max_distance_m;
  options.filter = command.query.plane_filter();
  return ask_and_print(
      command.query,
      [&](client::MapClient& map, std::chrono::milliseconds timeout) {
        return map.nearest(std::span(&point, 1), options, timeout);
      },
      command.query.json ? json_text : table);
}

}  // namespace

void add_nearest_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("nearest", "Ask which surfaces are nearest to a point, and how surely");
  const auto options = std::make_shared<NearestCommand>();
  add_numbers(*command, "--point", options->point_m, 3, "The point, world frame, metres", "X Y Z", true);
  command->add_option("--sigma", options->sigma_m, "Standard deviation of the point, metres")
      ->type_name("M")
      ->check(not_negative_number());
  add_numbers(*command, "--covariance", options->covariance_m2, 9,
              "Covariance of the point, row by row, square metres; instead of --sigma", "XX XY XZ YX YY YZ ZX ZY ZZ",
              false);
  command->get_option("--covariance")->excludes("--sigma");
  command->add_option("--count", options->count, "Planes, at most")
      ->type_name("N")
      ->check(whole_number(1, 1000))
      ->capture_default_str();
  command->add_option("--max-distance", options->max_distance_m, "Farther surfaces are left out, metres")
      ->type_name("M")
      ->check(positive_number());
  add_query_options(*command, options->query);
  add_filter_options(*command, options->query);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli
