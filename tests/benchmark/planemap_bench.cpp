// planemap-bench: planemap beside its peers, frame by frame in one run, on one thread.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <support/program.hpp>

#include "bench_frames.hpp"
#include "bench_plot.hpp"
#include "bench_report.hpp"
#include "common/machine.hpp"
#include "contestant.hpp"
#include "frame_source.hpp"

namespace planemap::benchmark {

namespace {

struct Arguments {
  FrameOptions from;
  std::size_t frames = 300;
  SimdTarget simd = SimdTarget::kAuto;
  bool alone = false;
  bool json = false;
  std::string svg;
};

void define_options(CLI::App& app, Arguments& arguments) {
  define_frame_options(app, arguments.from);
  app.add_option("--frames", arguments.frames, "how many, at most")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--simd", arguments.simd, "planemap's instruction set")
      ->transform(CLI::CheckedTransformer(std::map<std::string, SimdTarget>{{"auto", SimdTarget::kAuto},
                                                                            {"avx2", SimdTarget::kAvx2},
                                                                            {"avx512", SimdTarget::kAvx512},
                                                                            {"sse4", SimdTarget::kSse4},
                                                                            {"neon", SimdTarget::kNeon},
                                                                            {"scalar", SimdTarget::kScalar}}));
  app.add_flag("--alone", arguments.alone, "planemap and the reference loop only");
  app.add_option("--svg", arguments.svg, "draw it into this file")->type_name("FILE");
  app.add_flag("--json", arguments.json, "one object instead of the table");
  app.footer(
      "Each frame goes through all programs before the next one does, so that a slow moment of the machine hits them "
      "alike:\n"
      "compare ratios, not milliseconds. Exit codes: 0 done, 1 failed, 2 wrong use.");
}

std::vector<std::unique_ptr<Contestant>> contestants(const MapperConfig& config, bool alone) {
  std::vector<std::unique_ptr<Contestant>> all;
  all.push_back(make_planemap("planemap", config));
  all.push_back(make_reference(config.sensor, config.grid.cell_size_m));
  if (alone) return all;
  all.push_back(make_planemap("planemapTwoThreads", config, 2));
  for (const auto& [name, target] :
       {std::pair("planemapSse4", SimdTarget::kSse4), std::pair("planemapScalar", SimdTarget::kScalar)}) {
    MapperConfig other = config;
    other.core.simd = target;
    if (is_supported(target) && target != config.core.simd) all.push_back(make_planemap(name, other));
  }
  all.push_back(make_pcl_voxel_grid(config.grid.cell_size_m));
  all.push_back(make_pcl_approximate_voxel_grid(config.grid.cell_size_m));
  all.push_back(make_pcl_organized_multi_plane(config.sensor));
  all.push_back(make_octomap_endpoints(config.grid.cell_size_m));
  return all;
}

void measure(const Arguments& arguments) {
  MapperConfig config = preset(Preset::kBest);
  config.core.simd = arguments.simd;
  if (!is_supported(arguments.simd))
    throw std::runtime_error("--simd: this machine does not have that instruction set");
  const auto source = open_frames(arguments.from, arguments.frames);
  const std::vector<BenchFrame> frames = read_frames(*source, arguments.frames, config.sensor);
  if (frames.empty()) throw std::runtime_error("there is no frame to measure with");
  BenchReport report;
  const auto all = contestants(config, arguments.alone);
  std::size_t points = 0;
  for (const BenchFrame& frame : frames) {
    points += frame.xyz_world_m.size() / 3;
    for (const auto& contestant : all) report.add(contestant->take(frame));
  }
  points /= frames.size();
  if (!arguments.svg.empty()) {
    const std::string what = arguments.from.dataset.empty()
                                 ? "a rendered apartment"
                                 : std::filesystem::path(arguments.from.dataset).filename().string();
    draw_bench(report,
               std::to_string(frames.size()) + " frames of " + what +
                   "; planemap's bars: assign, normals, local and global planes, wear, snapshot",
               arguments.svg);
  }
  if (arguments.json) {
    std::printf("%s\n", report.json(frames.size(), points).c_str());
    return;
  }
  const Versions versions = library_versions();
  std::printf("%s\nplanemap %s, PCL %s, OctoMap %s\n%zu frames of %zu points\n\n%s\n%s",
              text_of(this_machine()).c_str(), versions.planemap.c_str(), versions.pcl.c_str(),
              versions.octomap.c_str(), frames.size(), points, report.table().c_str(), report.bounds_table().c_str());
}

}  // namespace

}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  using namespace planemap::benchmark;
  CLI::App app("planemap-bench: the time that planemap takes for a scan, by stage, beside its peers", "planemap-bench");
  Arguments arguments;
  define_options(app, arguments);
  return planemap::run_program(app, argc, argv, [&] { measure(arguments); });
}
