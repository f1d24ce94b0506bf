// Maps rendered scenes and scores the maps against what is known of them.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <planemap/simulation/scenes.hpp>
#include <string>
#include <vector>

#include "config/service_config.hpp"
#include "map_comparison.hpp"
#include "scene_run.hpp"

namespace {

using planemap::accuracy::CellNormals;
using planemap::accuracy::OutlineErrors;
using planemap::accuracy::PlanePair;
using planemap::accuracy::Run;
using planemap::accuracy::RunConfig;
using planemap::accuracy::Summary;
using planemap::accuracy::SurfaceScore;
using planemap::accuracy::Verdict;

void print_surfaces(const Run& run) {
  for (const SurfaceScore& s : run.score.surfaces) {
    std::printf("    %-28s %6.2f m2 %5.1f %% labelled  plane %4llu  overlap %5.1f %%  purity %5.1f %%  %s",
                s.name.c_str(), s.seen_m2, 100.0 * s.labelled_m2 / s.seen_m2, static_cast<unsigned long long>(s.plane),
                100.0 * s.overlap, 100.0 * s.purity, name_of(s.verdict));
    if (s.verdict == Verdict::kCorrect) {
      std::printf("  %.3f deg  %.2f mm  nees %.2f  outline %+.1f %%", s.normal_error_deg, 1e3 * s.offset_error_m,
                  s.nees, 100.0 * s.outline.area_error());
    }
    std::printf("\n");
  }
  for (const planemap::PlaneId id : run.score.noise) {
    std::printf("    on no surface: plane %llu\n", static_cast<unsigned long long>(id));
  }
}

void print_heading(const std::string& preset) {
  std::printf("%s\n  %-20s %7s %17s %5s %5s %6s %5s %6s %9s %14s %14s  %6s %8s %6s %6s  %9s %5s %5s  %6s %6s  %6s\n",
              preset.c_str(), "scene", "planes", "correct", "over", "under", "missed", "noise", "joined", "labelled",
              "normal deg, max", "offset mm, max", "nees", "mean", "<7.81", "95 %", "cells deg", "/dev", "p95", "area",
              "worst", "ms");
}

void print_row(const std::string& name, const Summary& s) {
  std::printf(
      "  %-20s %7zu %7zu (%5.1f %%) %5zu %5zu %6zu %5zu %6zu %7.1f %% %7.3f %7.3f %6.2f %7.2f  %6.2f %8.1f %6.1f %6.1f "
      " "
      "%9.3f %5.2f %5.2f  %+5.1f%% %+5.1f%%  %6.1f\n",
      name.c_str(), s.surfaces, s.correct, 100.0 * s.correct_share(), s.over, s.under, s.missed, s.noise, s.joined,
      100.0 * s.labelled_share, s.normal_mean_deg, s.normal_max_deg, 1e3 * s.offset_mean_m, 1e3 * s.offset_max_m,
      s.nees_median, s.nees_mean, 100.0 * s.nees_below, 100.0 * s.nees_within, s.inside_cells.mean_deg,
      s.inside_cells.ratio_median, s.inside_cells.ratio_p95, 100.0 * s.outlines.area_mean,
      100.0 * s.outlines.area_worst, s.ms_per_scan);
}

nlohmann::json to_json(const CellNormals& c) {
  return {{"cells", c.cells},
          {"errorMeanDeg", c.mean_deg},
          {"ratio", {{"median", c.ratio_median}, {"p90", c.ratio_p90}, {"p95", c.ratio_p95}, {"p99", c.ratio_p99}}},
          {"shareWithin1", c.within_1},
          {"shareWithin3", c.within_3}};
}

nlohmann::json to_json(const OutlineErrors& o) {
  return {{"planes", o.planes},
          {"areaError", {{"mean", o.area_mean}, {"worst", o.area_worst}, {"shareWithin5Percent", o.area_within}}},
          {"borderWorstP95M", o.border_p95_m},
          {"overreachM", {{"p99", o.overreach_p99_m}, {"max", o.overreach_max_m}}},
          {"shortfallM", {{"p99", o.shortfall_p99_m}, {"max", o.shortfall_max_m}}}};
}

nlohmann::json to_json(const Summary& s) {
  return {{"surfaces", s.surfaces},
          {"correct", s.correct},
          {"correctShare", s.correct_share()},
          {"overSegmented", s.over},
          {"underSegmented", s.under},
          {"missed", s.missed},
          {"noise", s.noise},
          {"joined", s.joined},
          {"storedCells", s.stored_cells},
          {"wornCells", s.worn_cells},
          {"labelledShare", s.labelled_share},
          {"normalErrorDeg", {{"mean", s.normal_mean_deg}, {"max", s.normal_max_deg}}},
          {"offsetErrorM", {{"mean", s.offset_mean_m}, {"max", s.offset_max_m}}},
          {"nees",
           {{"median", s.nees_median},
            {"mean", s.nees_mean},
            {"shareBelow", s.nees_below},
            {"shareWithin", s.nees_within}}},
          {"cellNormals", {{"inside", to_json(s.inside_cells)}, {"all", to_json(s.cells)}}},
          {"wideOutlines", to_json(s.outlines)},
          {"msPerScan", s.ms_per_scan}};
}

/// The scenes that are meant: names, "special" for all special rooms, "all" for every scene. Throws
/// CLI::ValidationError.
std::vector<std::string> scenes_of(const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  for (const std::string& want : wanted) {
    bool found = false;
    for (const auto& scene : planemap::simulation::scenes_with_an_end()) {
      const bool special = scene.name != "apartment";
      if (want != scene.name && want != "all" && !(want == "special" && special)) continue;
      names.emplace_back(scene.name);
      found = true;
    }
    if (!found) throw CLI::ValidationError("--scenes", "no scene '" + want + "'");
  }
  return names;
}

std::string scenes_help() {
  std::string text = "all, special (all but the apartment), or any of";
  for (const auto& scene : planemap::simulation::scenes_with_an_end()) text += " " + std::string(scene.name);
  return text;
}

struct Options {
  RunConfig run;
  std::vector<std::string> scenes = {"apartment"};
  std::vector<std::uint64_t> seeds = {1, 2, 3};
  std::vector<std::string> presets = {"best", "paper"};
  std::vector<std::string> overrides;
  std::optional<std::uint64_t> shuffle;
  bool json = false;
  bool surfaces = false;
};

void add_options(CLI::App& app, Options& options) {
  RunConfig& run = options.run;
  app.add_option("--scenes", options.scenes, scenes_help())->delimiter(',')->capture_default_str();
  app.add_option("--seeds", options.seeds, "of each scene")->delimiter(',')->capture_default_str();
  app.add_option("--preset", options.presets, "best, paper or both")
      ->delimiter(',')
      ->check(CLI::IsMember({"best", "paper"}))
      ->capture_default_str();
  app.add_option("--set", options.overrides, "any setting, as section.key=value");
  app.add_option("--frames", run.frames, "frames of one tour (default: 300 of the apartment, a special room's own)")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--until", run.until, "score the map after so many frames of the tour (default: after all)")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--noise", run.noise_scale, "times the Kinect's own noise")->capture_default_str();
  app.add_option("--pose-noise-m", run.pose_sigma_m, "standard deviation of the poses' position")
      ->capture_default_str();
  app.add_option("--pose-noise-deg", run.pose_sigma_deg, "and of their rotation")->capture_default_str();
  app.add_option("--pose-correlation-s", run.pose_correlation_s, "time constant of the poses' errors; 0: white")
      ->capture_default_str();
  app.add_option("--scale-covariance", run.scoring.covariance_scale,
                 "multiply the planes' covariances before they are scored: shows that wrong ones fail")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
  app.add_option("--shuffle", options.shuffle,
                 "compare the map with that of the same frames in a random order with this seed, wear off");
  app.add_flag("--surfaces", options.surfaces, "list every surface");
  app.add_flag("--json", options.json, "one JSON object instead of tables");
}

/// Maps and scores every scene with each of its seeds, by one preset.
nlohmann::json run_all(Options& options, const std::string& preset) {
  nlohmann::json result = nlohmann::json::object();
  if (!options.json) print_heading(preset);
  std::vector<Run> runs;
  for (const std::string& scene : options.scenes) {
    for (const std::uint64_t seed : options.seeds) {
      options.run.scene = scene;
      options.run.seed = seed;
      runs.push_back(planemap::accuracy::run_scene(options.run));
      const Summary summary = planemap::accuracy::summarise({&runs.back(), 1});
      result["scenes"][scene + "-" + std::to_string(seed)] = to_json(summary);
      if (options.json) continue;
      print_row(scene + " " + std::to_string(seed), summary);
      if (options.surfaces) print_surfaces(runs.back());
      std::fflush(stdout);
    }
  }
  const Summary summary = planemap::accuracy::summarise(runs);
  result["all"] = to_json(summary);
  if (!options.json) print_row("all", summary);
  return result;
}

/// Planes of at least a quarter of a square metre in cells.
constexpr std::size_t kComparedCells = 40;

nlohmann::json compare_one_way(const planemap::MapSnapshot& map, const planemap::MapSnapshot& other,
                               const planemap::accuracy::SeenSurfaces& seen, const char* name, bool json) {
  const std::vector<PlanePair> pairs = planemap::accuracy::pair_planes(map, other, seen, kComparedCells);
  nlohmann::json different = nlohmann::json::array();
  for (const PlanePair& p : pairs) {
    if (planemap::accuracy::SamePlaneBounds().hold(p)) continue;
    different.push_back({{"plane", p.plane},
                         {"cells", p.cells},
                         {"widthM", p.width_m},
                         {"partner", p.partner},
                         {"overlap", p.shared_surface},
                         {"sharedCells", p.shared_cell_share()},
                         {"angleDeg", p.angle_deg},
                         {"offsetM", p.offset_m}});
    if (json) continue;
    std::printf(
        "    plane %4llu, %5zu cells, %.2f m wide: plane %4llu, overlap %5.1f %% (cells %5.1f %%), %.3f deg, "
        "%.2f mm\n",
        static_cast<unsigned long long>(p.plane), p.cells, p.width_m, static_cast<unsigned long long>(p.partner),
        100.0 * p.shared_surface, 100.0 * p.shared_cell_share(), p.angle_deg, 1e3 * p.offset_m);
  }
  if (!json) std::printf("  %s: %zu of %zu planes are the same\n", name, pairs.size() - different.size(), pairs.size());
  return {{"planes", pairs.size()}, {"different", different}};
}

/// Maps every scene with each of its seeds twice, in order and shuffled, and compares the planes.
nlohmann::json compare_orders(Options& options) {
  nlohmann::json result = nlohmann::json::object();
  options.run.mapping.wear.enabled = false;
  for (const std::string& scene : options.scenes) {
    for (const std::uint64_t seed : options.seeds) {
      options.run.scene = scene;
      options.run.seed = seed;
      const planemap::accuracy::RecordedScene recorded = planemap::accuracy::record_scene(options.run);
      const auto in_order = planemap::accuracy::map_frames(recorded, options.run.mapping);
      const auto shuffled = planemap::accuracy::map_frames(recorded, options.run.mapping, options.shuffle);
      const std::string name = scene + "-" + std::to_string(seed);
      if (!options.json) std::printf("%s\n", name.c_str());
      result[name]["inOrder"] =
          compare_one_way(*in_order, *shuffled, recorded.seen, "in order, beside shuffled", options.json);
      result[name]["shuffled"] =
          compare_one_way(*shuffled, *in_order, recorded.seen, "shuffled, beside in order", options.json);
      std::fflush(stdout);
    }
  }
  return result;
}

int run(Options& options) {
  nlohmann::json all = nlohmann::json::object();
  for (const std::string& preset : options.presets) {
    const auto settings = planemap::service::load_config({preset, "", options.overrides});
    if (!settings) {
      std::fprintf(stderr, "planemap-accuracy: %s\n", settings.error().message.c_str());
      return 2;
    }
    options.run.mapping = settings->mapper;
    all[preset] = options.shuffle ? compare_orders(options) : run_all(options, preset);
  }
  if (options.json) std::printf("%s\n", all.dump(2).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Maps rendered scenes with known planes and scores the maps (Hoover's measure at 80 % overlap).");
  Options options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
    options.scenes = scenes_of(options.scenes);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "planemap-accuracy: %s\n", error.what());
    return 1;
  }
}
