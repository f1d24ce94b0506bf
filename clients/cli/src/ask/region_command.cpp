#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <numbers>
#include <vector>

#include "ask/answer_json.hpp"
#include "ask/query_options.hpp"
#include "command.hpp"

namespace planemap::cli {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;

struct RegionCommand {
  QueryOptions query;
  std::vector<double> box, oriented_box, sphere, frustum, cylinder;
  bool polygons = false;
  bool cells = false;
};

client::Pose pose_at_start(const std::vector<double>& numbers) {
  return {vector_at(numbers, 0), {numbers[3], numbers[4], numbers[5], numbers[6]}};
}

client::Region region_of(const RegionCommand& command) {
  if (!command.box.empty()) return client::Box{vector_at(command.box, 0), vector_at(command.box, 3)};
  if (!command.oriented_box.empty()) {
    return client::OrientedBox{pose_at_start(command.oriented_box), vector_at(command.oriented_box, 7)};
  }
  if (!command.sphere.empty()) return client::Sphere{vector_at(command.sphere, 0), command.sphere[3]};
  if (!command.frustum.empty()) {
    const auto& f = command.frustum;
    return client::Frustum{pose_at_start(f), f[7] * kRadians, f[8] * kRadians, f[9], f[10]};
  }
  return client::Cylinder{vector_at(command.cylinder, 0), vector_at(command.cylinder, 3), command.cylinder[6]};
}

constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length, as the service has it

/// What is wrong with the numbers of the shape; empty: nothing.
std::string problem_of(const RegionCommand& command) {
  const auto positive = [](const char* what, double number) {
    return number > 0.0 ? std::string() : fmt::format("{} must be greater than 0, is {:g}", what, number);
  };
  const auto unit = [](const std::vector<double>& numbers) {
    const double length = std::hypot(std::hypot(numbers[3], numbers[4]), std::hypot(numbers[5], numbers[6]));
    if (std::abs(length - 1.0) <= kUnitTolerance) return std::string();
    return fmt::format("QW QX QY QZ must be a unit quaternion, its length is {:g}", length);
  };
  const auto first_of = [](const char* option, std::initializer_list<std::string> problems) {
    for (const std::string& problem : problems) {
      if (!problem.empty()) return fmt::format("{}: {}", option, problem);
    }
    return std::string();
  };
  for (std::size_t axis = 0; axis < 3 && !command.box.empty(); ++axis) {
    if (command.box[axis] < command.box[axis + 3]) continue;
    return fmt::format("--box: the first {} must be less than the second, {:g}; is {:g}", "XYZ"[axis],
                       command.box[axis + 3], command.box[axis]);
  }
  if (!command.oriented_box.empty()) {
    const auto& b = command.oriented_box;
    return first_of("--oriented-box", {unit(b), positive("SX", b[7]), positive("SY", b[8]), positive("SZ", b[9])});
  }
  if (!command.sphere.empty()) return first_of("--sphere", {positive("R", command.sphere[3])});
  if (!command.cylinder.empty()) return first_of("--cylinder", {positive("R", command.cylinder[6])});
  if (command.frustum.empty()) return {};
  const auto& f = command.frustum;
  const auto angle = [](const char* what, double degrees) {
    if (degrees > 0.0 && degrees < 180.0) return std::string();
    return fmt::format("{} must be greater than 0 and less than 180, is {:g}", what, degrees);
  };
  const bool is_ordered = f[9] >= 0.0 && f[9] < f[10];
  return first_of("--frustum",
                  {unit(f), angle("HORIZONTAL", f[7]), angle("VERTICAL", f[8]),
                   is_ordered ? std::string()
                              : fmt::format("NEAR must be at least 0 and less than FAR, {:g}; is {:g}", f[10], f[9])});
}

std::string json_text(const client::RegionAnswer& answer, const RegionCommand& command) {
  Json planes = Json::array();
  for (const client::RegionPlane& plane : answer.planes) {
    Json& json = planes.emplace_back(json_of(plane.plane));
    json["whole"] = plane.whole;
    if (!command.polygons) continue;
    json["areaInside"] = plane.clipped_area_m2;
    json["polygonsInside"] = json_of(plane.clipped, plane.plane);
  }
  Json json = json_of(answer.version);
  json["planes"] = std::move(planes);
  if (command.cells) {
    Json cells = Json::array();
    for (const client::Cell& cell : answer.cells) cells.push_back(json_of(cell));
    json["cells"] = std::move(cells);
  }
  return json.dump() + '\n';
}

std::string table(const client::RegionAnswer& answer, const RegionCommand& command) {
  std::string text = fmt::format("planes: {}\n", answer.planes.size());
  if (command.cells) text += fmt::format("cells: {}\n", answer.cells.size());
  if (answer.planes.empty()) return text;
  text += fmt::format("{:>6}  {:<8}{:>10}{:>12}   {:^24}{:>9}\n", "plane", "class", "area m2",
                      command.polygons ? "inside m2" : "inside", "normal", "d m");
  for (const client::RegionPlane& plane : answer.planes) {
    const std::string inside =
        command.polygons ? fmt::format("{:.3f}", plane.clipped_area_m2) : (plane.whole ? "all" : "part");
    const auto& n = plane.plane.normal;
    text += fmt::format("{:>6}  {:<8}{:>10.3f}{:>12}   {:>8.4f}{:>8.4f}{:>8.4f}{:>9.4f}\n", plane.plane.id,
                        plane.plane.plane_class, plane.plane.area_m2, inside, n[0], n[1], n[2], plane.plane.d);
  }
  return text;
}

ExitCode run(const RegionCommand& command) {
  if (const std::string problem = problem_of(command); !problem.empty()) {
    return complain(ExitCode::kWrongUse, problem);
  }
  const client::RegionQuery query{region_of(command), command.polygons, command.cells, command.query.plane_filter()};
  return ask_and_print(
      command.query,
      [&](client::MapClient& map, std::chrono::milliseconds timeout) { return map.region(query, timeout); },
      [&](const client::RegionAnswer& answer) {
        return command.query.json ? json_text(answer, command) : table(answer, command);
      });
}

}  // namespace

void add_region_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("region", "Ask what is in a part of space");
  const auto options = std::make_shared<RegionCommand>();
  CLI::Option_group* shape = command->add_option_group("Shape", "World frame, metres; one of these");
  add_numbers(*shape, "--box", options->box, 6, "Least and greatest corner; inf and -inf are allowed", "X Y Z X Y Z",
              false);
  add_numbers(*shape, "--oriented-box", options->oriented_box, 10, "Middle, unit quaternion w x y z, edges",
              "X Y Z QW QX QY QZ SX SY SZ", false);
  add_numbers(*shape, "--sphere", options->sphere, 4, "Centre and radius", "X Y Z R", false);
  add_numbers(*shape, "--frustum", options->frustum, 11,
              "Camera (x right, y down, z forward), unit quaternion w x y z, angles in degrees, nearest and farthest",
              "X Y Z QW QX QY QZ HORIZONTAL VERTICAL NEAR FAR", false);
  add_numbers(*shape, "--cylinder", options->cylinder, 7, "Middles of its ends, and radius", "X Y Z X Y Z R", false);
  shape->require_option(1);
  command->add_flag("--polygons", options->polygons, "Also what is inside of each boundary");
  command->add_flag("--cells", options->cells, "Also the dense cells");
  add_query_options(*command, options->query);
  add_filter_options(*command, options->query);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli
