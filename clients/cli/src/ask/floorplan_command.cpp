#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "ask/answer_json.hpp"
#include "ask/query_options.hpp"
#include "checked_numbers.hpp"
#include "command.hpp"

namespace planemap::cli {
namespace {

struct FloorplanCommand {
  QueryOptions query;
  client::FloorplanQuery heights;
};

std::string json_text(const client::FloorplanAnswer& plan) {
  Json json = json_of(plan.version);
  json["axisX"] = json_of(plan.axis_x);
  json["axisY"] = json_of(plan.axis_y);
  json["up"] = json_of(plan.up);
  json["floorHeight"] = plan.floor_height_m;
  json["freeArea"] = plan.free_area_m2;
  json["walls"] = json_of(plan.walls);
  json["floor"] = json_of(plan.floor);
  json["freeFloor"] = json_of(plan.free_floor);
  return json.dump() + '\n';
}

double area_of_ring(const client::Ring& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const auto& a = ring[i];
    const auto& b = ring[(i + 1) % ring.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

double area_of(const std::vector<client::Polygon>& polygons) {
  double area = 0.0;
  for (const client::Polygon& polygon : polygons) {
    area += area_of_ring(polygon.outer);
    for (const client::Ring& hole : polygon.holes) area += area_of_ring(hole);  // clockwise: negative
  }
  return area;
}

std::string table(const client::FloorplanAnswer& plan) {
  std::string text =
      fmt::format("floor at {:.3f} m along up\n{:<12}{:>8}{:>12}\n", plan.floor_height_m, "", "pieces", "area m2");
  const auto line = [&](const char* name, const std::vector<client::Polygon>& polygons, double area_m2) {
    text += fmt::format("{:<12}{:>8}{:>12.3f}\n", name, polygons.size(), area_m2);
  };
  line("walls", plan.walls, area_of(plan.walls));
  line("floor", plan.floor, area_of(plan.floor));
  line("free floor", plan.free_floor, plan.free_area_m2);
  return text;
}

ExitCode run(const FloorplanCommand& command) {
  client::FloorplanQuery query = command.heights;
  query.filter = command.query.plane_filter();
  return ask_and_print(
      command.query,
      [&](client::MapClient& map, std::chrono::milliseconds timeout) { return map.floorplan(query, timeout); },
      command.query.json ? json_text : table);
}

}  // namespace

void add_floorplan_command(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("floorplan", "Ask for walls and free floor, seen from above (polygons: --json)");
  const auto options = std::make_shared<FloorplanCommand>();
  const auto add_height = [&](const char* name, double& height_m, const char* help) {
    command->add_option(name, height_m, help)->type_name("M")->check(not_negative_number())->capture_default_str();
  };
  add_height("--cut-low", options->heights.cut_low_m, "Walls are cut from this height above the floor");
  add_height("--cut-high", options->heights.cut_high_m, "to this one");
  add_height("--wall-thickness", options->heights.wall_thickness_m, "Of the matter behind a wall's surface");
  add_height("--clear-low", options->heights.clear_low_m, "Floor is free where nothing is from this height");
  add_height("--clear-high", options->heights.clear_high_m, "to this one");
  add_query_options(*command, options->query);
  add_filter_options(*command, options->query);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli
