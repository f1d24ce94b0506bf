#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <numbers>
#include <vector>

#include "ask/answer_json.hpp"
#include "ask/query_options.hpp"
#include "checked_numbers.hpp"
#include "command.hpp"

namespace planemap::cli {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct RayCommand {
  QueryOptions query;
  std::vector<double> from_m;
  std::vector<double> direction;
  double max_range_m = 0.0;  ///< 0: no limit
};

Json json_of_plane_hit(const std::optional<client::PlaneHit>& hit) {
  if (!hit) return {};
  return {{"id", hit->plane_id},
          {"range", hit->range_m},
          {"sigma", hit->sigma_m},
          {"incidence", hit->incidence_rad},
          {"fromBehind", hit->from_behind},
          {"point", json_of(hit->point_m)}};
}

Json json_of_cell_hit(const std::optional<client::CellHit>& hit) {
  if (!hit) return {};
  return {{"cell", json_of(hit->cell)},
          {"entry", hit->entry_m},
          {"range", hit->range_m},
          {"sigma", hit->sigma_m},
          {"incidence", hit->incidence_rad ? Json(*hit->incidence_rad) : Json()}};
}

std::string json_text(const client::CastAnswer& answer) {
  Json json = json_of(answer.version);
  json["plane"] = json_of_plane_hit(answer.rays.front().plane);
  json["cell"] = json_of_cell_hit(answer.rays.front().cell);
  return json.dump() + '\n';
}

std::string plain_text(const client::CastAnswer& answer) {
  std::string text;
  if (const auto& hit = answer.rays.front().plane) {
    text += fmt::format("plane {} at {:.4f} m +- {:.2f} mm, {:.1f} deg from square on{}; point {:.4f} {:.4f} {:.4f}\n",
                        hit->plane_id, hit->range_m, 1e3 * hit->sigma_m, kDegrees * hit->incidence_rad,
                        hit->from_behind ? ", from behind" : "", hit->point_m[0], hit->point_m[1], hit->point_m[2]);
  } else {
    text += "no plane is met\n";
  }
  if (const auto& hit = answer.rays.front().cell) {
    text += fmt::format("cell of {} at {:.4f} m +- {:.2f} mm, entered at {:.4f} m, {} points\n",
                        hit->cell.plane_id == 0 ? "no plane" : fmt::format("plane {}", hit->cell.plane_id),
                        hit->range_m, 1e3 * hit->sigma_m, hit->entry_m, hit->cell.count);
  } else {
    text += "no cell is met\n";
  }
  return text;
}

ExitCode run(const RayCommand& command) {
  if (std::all_of(command.direction.begin(), command.direction.end(), [](double part) { return part == 0.0; })) {
    return complain(ExitCode::kWrongUse, "--direction: must not be zero");
  }
  client::Ray ray;
  ray.origin_m = vector_at(command.from_m, 0);
  ray.direction = vector_at(command.direction, 0);
  if (command.max_range_m > 0.0) ray.max_range_m = command.max_range_m;
  client::CastOptions options;
  options.filter = command.query.plane_filter();
  return ask_and_print(
      command.query,
      [&](client::MapClient& map, std::chrono::milliseconds timeout) {
        return map.cast(std::span(&ray, 1), options, timeout);
      },
      command.query.json ? json_text : plain_text);
}

}  // namespace

void add_ray_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("ray", "Ask what a ray meets first: a plane within its boundary, and a cell");
  const auto options = std::make_shared<RayCommand>();
  add_numbers(*command, "--from", options->from_m, 3, "Where the ray starts, world frame, metres", "X Y Z", true);
  add_numbers(*command, "--direction", options->direction, 3, "Where it goes, of any length but 0", "X Y Z", true);
  command->add_option("--max-range", options->max_range_m, "How far it goes, metres")
      ->type_name("M")
      ->check(positive_number());
  add_query_options(*command, options->query);
  add_filter_options(*command, options->query);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli
