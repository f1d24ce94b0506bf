// planemap-paper: the paper's own experiments, by one command.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <memory>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/sources/open_folder.hpp>
#include <set>
#include <stdexcept>
#include <support/program.hpp>

#include "figures/figures.hpp"
#include "real/scene_run.hpp"

namespace planemap::experiments {

namespace {

constexpr std::size_t kApartmentFrames = 300;
// What RANSAC gets of the accumulated cloud: one mean point a cube. An apartment has five times the surface of a
// kitchen.
constexpr double kKitchenLeafM = 0.05;
constexpr double kApartmentLeafM = 0.10;

struct Arguments {
  std::string dataset;
  std::uint64_t seed = 1;
  std::filesystem::path out = "docs/experiments";
  std::vector<std::string> only;
  bool json = false;
};

struct SyntheticFigure {
  const char* name;
  const char* title;
  FigureResult (*draw)(const std::filesystem::path&);
};
constexpr SyntheticFigure kSyntheticFigures[] = {
    {"fig1", "Fig. 1, mapping a point to the grid", draw_fig1},
    {"fig2", "Fig. 2, uncertain normals", draw_fig2},
    {"fig4", "Fig. 4, the table", draw_fig4},
    {"fig5", "Fig. 5, distance of points to centres", draw_fig5},
    {"normals", "Deviation of the normals (V.A)", draw_normals},
};

struct SceneFigure {
  const char* name;
  const char* title;
  FigureResult (*draw)(const std::filesystem::path&, const SceneRun&);
};
constexpr SceneFigure kSceneFigures[] = {
    {"fig6", "Fig. 6, time of each step", draw_fig6},
    {"fig7", "Fig. 7, time and planes over time", draw_fig7},
    {"fig8", "Fig. 8, uncertainty of normals", draw_fig8},
    {"fig9", "Fig. 9, planes beside RANSAC's", draw_fig9},
    {"fig10", "Fig. 10, the map", draw_fig10},
};

void define_options(CLI::App& app, Arguments& arguments) {
  std::set<std::string> names;
  for (const SyntheticFigure& figure : kSyntheticFigures) names.insert(figure.name);
  for (const SceneFigure& figure : kSceneFigures) names.insert(figure.name);
  app.add_option("--dataset", arguments.dataset,
                 "the red kitchen (7-Scenes or TUM RGB-D folder); without: apartment only")
      ->type_name("DIR");
  app.add_option("--seed", arguments.seed, "of the simulated apartment")->capture_default_str();
  app.add_option("--out", arguments.out, "folder for the SVGs; made where it is missing")
      ->type_name("FOLDER")
      ->capture_default_str();
  app.add_option("--only", arguments.only, "these figures")
      ->delimiter(',')
      ->check(CLI::IsMember(names))
      ->type_name("FIGURE");
  app.add_flag("--json", arguments.json, "one object instead of text");
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong use.");
}

/// A line on stderr that is written over again and again; nothing where that is no terminal.
class Progress {
 public:
  void show(const std::string& what) {
    if (!on_terminal_) return;
    fmt::print(stderr, "\r\033[K{}", what);
    std::fflush(stderr);
  }
  ~Progress() { show(""); }

 private:
  bool on_terminal_ = ::isatty(STDERR_FILENO) == 1;
};

/// Tells each figure as it is done.
class Report {
 public:
  explicit Report(bool json) : json_(json) {}

  void add(const std::string& name, const std::string& scene, const std::string& title, const FigureResult& result) {
    nlohmann::ordered_json& place = scene.empty() ? all_[name] : all_[name][scene];
    place = result.numbers;
    for (const auto& file : result.files) place["files"].push_back(file.string());
    if (json_) return;
    fmt::print("{}{}\n", title, scene.empty() ? "" : ", " + scene);
    for (const std::string& line : result.lines) fmt::print("  {}\n", line);
    for (const auto& file : result.files) fmt::print("  -> {}\n", file.string());
    std::fflush(stdout);
  }
  void finish() const {
    if (json_) fmt::print("{}\n", all_.dump(2));
  }

 private:
  bool json_;
  nlohmann::ordered_json all_;
};

bool wanted(const Arguments& arguments, const std::string& figure) {
  return arguments.only.empty() ||
         std::find(arguments.only.begin(), arguments.only.end(), figure) != arguments.only.end();
}

SceneRun map_source(const std::string& name, const std::string& title, double leaf_m, sources::FrameSource& source,
                    Progress& progress) {
  return map_scene(name, title, source, leaf_m, [&](std::size_t frames) {
    progress.show(
        fmt::format("{}: {} of {} frames mapped by both presets", title, frames, source.size().value_or(frames)));
  });
}

/// The scenes one by one, so that only one of them is in memory.
std::vector<std::function<SceneRun(Progress&)>> scenes(const Arguments& arguments) {
  std::vector<std::function<SceneRun(Progress&)>> all;
  if (!arguments.dataset.empty()) {
    all.push_back([&](Progress& progress) {
      auto source = sources::open_folder(arguments.dataset);
      if (!source) throw std::runtime_error(source.error().message);
      return map_source("kitchen", "red kitchen", kKitchenLeafM, **source, progress);
    });
  }
  all.push_back([&](Progress& progress) {
    simulation::SimulationConfig scene;
    scene.seed = arguments.seed;
    scene.frames = kApartmentFrames;
    simulation::SimulatedSource source(scene);
    SceneRun run = map_source("apartment", "simulated apartment", kApartmentLeafM, source, progress);
    for (const simulation::Surface& surface : source.truth()) run.truth.push_back(surface.plane);
    return run;
  });
  return all;
}

void draw_all(const Arguments& arguments) {
  std::filesystem::create_directories(arguments.out);
  Progress progress;
  Report report(arguments.json);
  for (const SyntheticFigure& figure : kSyntheticFigures) {
    if (!wanted(arguments, figure.name)) continue;
    progress.show(figure.title);
    const FigureResult result = figure.draw(arguments.out);
    progress.show("");
    report.add(figure.name, "", figure.title, result);
  }
  const bool any_scene = std::any_of(std::begin(kSceneFigures), std::end(kSceneFigures),
                                     [&](const SceneFigure& figure) { return wanted(arguments, figure.name); });
  for (const auto& scene : any_scene ? scenes(arguments) : std::vector<std::function<SceneRun(Progress&)>>{}) {
    const SceneRun run = scene(progress);
    for (const SceneFigure& figure : kSceneFigures) {
      if (!wanted(arguments, figure.name)) continue;
      progress.show(fmt::format("{}: {}", run.title, figure.title));
      const FigureResult result = figure.draw(arguments.out, run);
      progress.show("");
      report.add(figure.name, run.name, figure.title, result);
    }
  }
  report.finish();
}

}  // namespace

}  // namespace planemap::experiments

int main(int argc, char** argv) {
  using namespace planemap::experiments;
  CLI::App app("planemap-paper: the experiments of the paper, figures as SVG, numbers beside the paper's",
               "planemap-paper");
  Arguments arguments;
  define_options(app, arguments);
  return planemap::run_program(app, argc, argv, [&] { draw_all(arguments); });
}
