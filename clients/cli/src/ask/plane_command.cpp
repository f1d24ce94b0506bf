#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <numbers>

#include "ask/answer_json.hpp"
#include "ask/query_options.hpp"
#include "checked_numbers.hpp"
#include "command.hpp"

namespace planemap::cli {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct PlaneCommand {
  QueryOptions query;
  std::int64_t id = 0;
};

const char* name_of_fate(client::PlaneFate fate) {
  switch (fate) {
    case client::PlaneFate::kLives:
      return "lives";
    case client::PlaneFate::kMerged:
      return "merged";
    case client::PlaneFate::kGone:
      return "gone";
    case client::PlaneFate::kUnknown:
      break;
  }
  return "unknown";
}

std::string json_text(const client::PlaneAnswer& answer) {
  Json json = json_of(answer.version);
  json["asked"] = answer.asked;
  json["fate"] = name_of_fate(answer.fate);
  json["lineage"] = answer.lineage;
  json["removedRevision"] = answer.removed_revision ? Json(*answer.removed_revision) : Json();
  if (answer.plane) {
    Json plane = json_of(*answer.plane);
    plane["normalDeviation"] = answer.normal_deviation_rad;
    plane["coplanar"] = answer.coplanar;
    plane["merged"] = answer.merged;
    json["plane"] = std::move(plane);
  } else {
    json["plane"] = nullptr;
  }
  return json.dump() + '\n';
}

std::string fate_line(const client::PlaneAnswer& answer) {
  const std::string when =
      answer.removed_revision ? fmt::format(" at revision {}", *answer.removed_revision) : std::string();
  switch (answer.fate) {
    case client::PlaneFate::kMerged:
      return fmt::format("plane {} was merged into {}{} ({})\n", answer.asked, answer.lineage.back(), when,
                         fmt::join(answer.lineage, " -> "));
    case client::PlaneFate::kGone:
      return fmt::format("plane {} is no more{}\n", answer.asked, when);
    case client::PlaneFate::kUnknown:
      return fmt::format("plane {} was never in this map, or went too long ago\n", answer.asked);
    case client::PlaneFate::kLives:
      break;
  }
  return {};
}

std::string ids_text(const std::vector<std::int64_t>& ids) {
  return ids.empty() ? "-" : fmt::format("{}", fmt::join(ids, " "));
}

std::string plain_text(const client::PlaneAnswer& answer) {
  std::string text = fate_line(answer);
  if (!answer.plane) return text;
  const client::Plane& plane = *answer.plane;
  text += fmt::format("plane {}, {}\n", plane.id, plane.plane_class);
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<10}{}\n", name, value);
  };
  line("normal", fmt::format("{:.6f} {:.6f} {:.6f} +- {:.3f} deg", plane.normal[0], plane.normal[1], plane.normal[2],
                             kDegrees * answer.normal_deviation_rad));
  line("d", fmt::format("{:.6f} m", plane.d));
  line("centroid",
       fmt::format("{:.4f} {:.4f} {:.4f} m", plane.centroid_m[0], plane.centroid_m[1], plane.centroid_m[2]));
  line("area", fmt::format("{:.3f} m2 in {} pieces", plane.area_m2, plane.polygons.size()));
  line("cells", fmt::format("{} of {} points, quality {:.2f}", plane.cell_count, plane.point_count, plane.quality));
  line("seen", fmt::format("{} to {} (microseconds)", plane.first_seen_utime, plane.last_seen_utime));
  line("changed", fmt::format("at revision {} of {}", plane.revision, answer.version.revision));
  line("coplanar", ids_text(answer.coplanar));
  line("merged", ids_text(answer.merged));
  return text;
}

/// In words one that is not known is an error alone; in JSON it is an answer, too.
std::string text_of(const client::PlaneAnswer& answer, bool json) {
  if (json) return json_text(answer);
  return answer.fate == client::PlaneFate::kUnknown ? std::string() : plain_text(answer);
}

ExitCode run(const PlaneCommand& command) {
  std::string unknown;
  const ExitCode code = ask_and_print(
      command.query,
      [&](client::MapClient& map, std::chrono::milliseconds timeout) { return map.plane(command.id, timeout); },
      [&](const client::PlaneAnswer& answer) {
        if (answer.fate == client::PlaneFate::kUnknown) unknown = fate_line(answer);
        return text_of(answer, command.query.json);
      });
  if (unknown.empty()) return code;
  unknown.pop_back();  // the line's end
  return complain(ExitCode::kFailed, unknown);
}

}  // namespace

void add_plane_command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("plane", "Ask for everything about a plane, and what became of it");
  const auto options = std::make_shared<PlaneCommand>();
  command->add_option("ID", options->id, "Id of the plane, also of one that was merged into another")
      ->required()
      ->check(whole_number(1));
  add_query_options(*command, options->query);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace planemap::cli
