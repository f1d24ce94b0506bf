// planemap-scale: what a scan costs as the map grows, in a building without end.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <support/program.hpp>

#include "common/machine.hpp"
#include "scale/scale_report.hpp"
#include "scale/scale_run.hpp"

namespace planemap::benchmark {

namespace {

struct Arguments {
  ScaleConfig scale;
  SimdTarget simd = SimdTarget::kAuto;
  std::string svg;
  bool json = false;
};

void define_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--scans", arguments.scale.scans, "to map; 20,000 are some 10,700 square metres of floor")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  app.add_option("--window", arguments.scale.window,
                 "scans that a row of the table is about, at least 101 to be compared with a small map")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  app.add_option("--minutes", arguments.scale.minutes, "end with the window in which they have passed")
      ->check(CLI::Range(0.001, 1e9));
  app.add_option("--shrink", arguments.scale.shrink, "how many times smaller than 640x480 the images are")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  app.add_option("--seed", arguments.scale.seed, "of the building")->capture_default_str();
  app.add_option("--time-lapse", arguments.scale.time_lapse, "how many times faster than a robot the camera goes")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--simd", arguments.simd, "instruction set")
      ->transform(CLI::CheckedTransformer(std::map<std::string, SimdTarget>{{"auto", SimdTarget::kAuto},
                                                                            {"avx2", SimdTarget::kAvx2},
                                                                            {"avx512", SimdTarget::kAvx512},
                                                                            {"sse4", SimdTarget::kSse4},
                                                                            {"neon", SimdTarget::kNeon},
                                                                            {"scalar", SimdTarget::kScalar}}));
  app.add_option("--svg", arguments.svg, "draw it into this file")->type_name("FILE");
  app.add_flag("--json", arguments.json, "one object instead of the table");
  app.footer(
      "own: the mapper's thread's own time. / twin: the ratio of that to a map of some 100 square metres that takes "
      "the\n"
      "same scans in turn. RSS: less what the process took before the first scan.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong use.");
}

void measure(Arguments& arguments) {
  arguments.scale.mapper = preset(Preset::kBest);
  arguments.scale.mapper.core.simd = arguments.simd;
  if (!is_supported(arguments.simd))
    throw std::runtime_error("--simd: this machine does not have that instruction set");
  if (!arguments.json) {
    std::printf("%s\n\n%s", text_of(this_machine()).c_str(), scale_table_head().c_str());
  }
  const auto windows = run_scale(arguments.scale, [&](const ScaleWindow& window) {
    if (arguments.json) return;
    std::printf("%s", scale_table_row(window).c_str());
    std::fflush(stdout);
  });
  const ScaleRatio ratio = scale_ratio(windows);
  if (arguments.json) {
    std::printf("%s\n", scale_json(windows).c_str());
  } else {
    std::printf("\ntime of a scan at %.0f m2 / at 100 m2: %.3f\n", ratio.area_m2, ratio.ratio);
  }
  if (!arguments.svg.empty()) draw_scale(windows, arguments.svg);
}

}  // namespace

}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  using namespace planemap::benchmark;
  CLI::App app("planemap-scale: what a scan costs as the map grows", "planemap-scale");
  Arguments arguments;
  define_options(app, arguments);
  return planemap::run_program(app, argc, argv, [&] { measure(arguments); });
}
