// Maps rendered apartments and scores the maps against what is known of them.

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apartment_run.hpp"
#include "config/service_config.hpp"

namespace {

using planemap::accuracy::Run;
using planemap::accuracy::RunConfig;
using planemap::accuracy::Summary;
using planemap::accuracy::SurfaceScore;
using planemap::accuracy::Verdict;

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kCorrect:
      return "correct";
    case Verdict::kOverSegmented:
      return "over-segmented";
    case Verdict::kUnderSegmented:
      return "under-segmented";
    case Verdict::kMissed:
      break;
  }
  return "missed";
}

void print_surfaces(const Run& run) {
  for (const SurfaceScore& s : run.score.surfaces) {
    std::printf("    %-28s %6.2f m2 %5.1f %% labelled  plane %4llu  overlap %5.1f %%  purity %5.1f %%  %s",
                s.name.c_str(), s.seen_m2, 100.0 * s.labelled_m2 / s.seen_m2, static_cast<unsigned long long>(s.plane),
                100.0 * s.overlap, 100.0 * s.purity, name_of(s.verdict));
    if (s.verdict == Verdict::kCorrect) {
      std::printf("  %.3f deg  %.2f mm  nees %.2f", s.normal_error_deg, 1e3 * s.offset_error_m, s.nees);
    }
    std::printf("\n");
  }
  for (const planemap::PlaneId id : run.score.noise) {
    std::printf("    on no surface: plane %llu\n", static_cast<unsigned long long>(id));
  }
}

void print_row(const std::string& name, const Summary& s) {
  std::printf(
      "  %-14s %7zu %5zu (%5.1f %%) %5zu %5zu %6zu %5zu  %6.1f %%  %6.3f %6.3f  %6.2f %6.2f  %6.2f %5.1f %5.1f  "
      "%6.1f\n",
      name.c_str(), s.surfaces, s.correct, 100.0 * s.correct_share(), s.over, s.under, s.missed, s.noise,
      100.0 * s.labelled_share, s.normal_mean_deg, s.normal_max_deg, 1e3 * s.offset_mean_m, 1e3 * s.offset_max_m,
      s.nees_median, 100.0 * s.nees_below, 100.0 * s.nees_within, s.ms_per_scan);
}

nlohmann::json to_json(const Summary& s) {
  return {{"surfaces", s.surfaces},
          {"correct", s.correct},
          {"correctShare", s.correct_share()},
          {"overSegmented", s.over},
          {"underSegmented", s.under},
          {"missed", s.missed},
          {"noise", s.noise},
          {"labelledShare", s.labelled_share},
          {"normalErrorDeg", {{"mean", s.normal_mean_deg}, {"max", s.normal_max_deg}}},
          {"offsetErrorM", {{"mean", s.offset_mean_m}, {"max", s.offset_max_m}}},
          {"nees",
           {{"median", s.nees_median},
            {"mean", s.nees_mean},
            {"shareBelow", s.nees_below},
            {"shareWithin", s.nees_within}}},
          {"msPerScan", s.ms_per_scan}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Maps rendered apartments with known planes and scores the maps (Hoover's measure at 80 % overlap).");
  RunConfig config;
  std::vector<std::uint64_t> seeds = {1, 2, 3};
  std::vector<std::string> presets = {"best", "paper"};
  std::vector<std::string> overrides;
  bool json = false;
  bool surfaces = false;
  app.add_option("--seeds", seeds, "apartments, each from its seed")->delimiter(',')->capture_default_str();
  app.add_option("--preset", presets, "best, paper or both")
      ->delimiter(',')
      ->check(CLI::IsMember({"best", "paper"}))
      ->capture_default_str();
  app.add_option("--set", overrides, "any setting, as section.key=value");
  app.add_option("--frames", config.frames, "frames of one tour")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--noise", config.noise_scale, "times the Kinect's own noise")->capture_default_str();
  app.add_option("--pose-noise-m", config.pose_sigma_m, "standard deviation of the poses' position")
      ->capture_default_str();
  app.add_option("--pose-noise-deg", config.pose_sigma_deg, "and of their rotation")->capture_default_str();
  app.add_option("--pose-correlation-s", config.pose_correlation_s, "time constant of the poses' errors; 0: white")
      ->capture_default_str();
  app.add_flag("--surfaces", surfaces, "list every surface");
  app.add_flag("--json", json, "one JSON object instead of tables");
  CLI11_PARSE(app, argc, argv);

  try {
    nlohmann::json all = nlohmann::json::object();
    for (const std::string& preset : presets) {
      const auto settings = planemap::service::load_config({preset, "", overrides});
      if (!settings) {
        std::fprintf(stderr, "planemap-accuracy: %s\n", settings.error().message.c_str());
        return 2;
      }
      config.mapping = settings->mapper;
      if (!json) {
        std::printf("%s\n  %-14s %7s %16s %5s %5s %6s %5s  %8s  %13s  %13s  %18s  %6s\n", preset.c_str(), "scene",
                    "planes", "correct", "over", "under", "missed", "noise", "labelled", "normal deg", "offset mm",
                    "nees <7.8 2-sided", "ms");
      }
      std::vector<Run> runs;
      for (const std::uint64_t seed : seeds) {
        config.seed = seed;
        runs.push_back(planemap::accuracy::run_apartment(config));
        const Summary summary = planemap::accuracy::summarise({&runs.back(), 1});
        all[preset]["scenes"]["apartment-" + std::to_string(seed)] = to_json(summary);
        if (json) continue;
        print_row("apartment " + std::to_string(seed), summary);
        if (surfaces) print_surfaces(runs.back());
        std::fflush(stdout);
      }
      const Summary summary = planemap::accuracy::summarise(runs);
      all[preset]["all"] = to_json(summary);
      if (!json) print_row("all", summary);
    }
    if (json) std::printf("%s\n", all.dump(2).c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "planemap-accuracy: %s\n", error.what());
    return 1;
  }
  return 0;
}
