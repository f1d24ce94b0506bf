#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "figures/figures.hpp"
#include "plot/chart.hpp"
#include "plot/svg_page.hpp"

namespace planemap::experiments {

using namespace plot;

namespace {

constexpr auto kStageWords = std::to_array<const char*>(
    {"points to cells (Eq. 7)", "normals", "local planes", "global planes", "wear", "snapshot"});
static_assert(kStageWords.size() == kStageCount);

struct TimeSummary {
  double mean_ms = 0.0;
  double least_ms = 0.0;
  double greatest_ms = 0.0;
  double high_ms = 0.0;  ///< 99 % of the scans took less
  std::array<double, kStageCount> share = {};
};

TimeSummary summary_of(const std::vector<ScanRecord>& scans) {
  TimeSummary summary;
  std::vector<double> total_ms;
  for (const ScanRecord& scan : scans) {
    total_ms.push_back(scan.total_ms());
    summary.mean_ms += scan.total_ms() / static_cast<double>(scans.size());
    for (std::size_t i = 0; i < kStageCount; ++i) summary.share[i] += scan.stage_ms[i];
  }
  for (double& share : summary.share) share /= summary.mean_ms * static_cast<double>(scans.size());
  std::sort(total_ms.begin(), total_ms.end());
  summary.least_ms = total_ms.front();
  summary.greatest_ms = total_ms.back();
  summary.high_ms = total_ms[static_cast<std::size_t>(0.99 * static_cast<double>(total_ms.size() - 1))];
  return summary;
}

/// The times of the steps, one on top of the other.
void draw_steps(SvgPage& page, const Box& box, const PresetRun& run, double greatest_ms) {
  Chart chart(page, box, fmt::format("preset {}", run.name), {"time of the recording, s", 0.0, run.scans.back().time_s},
              axis_from_zero("ms per scan", greatest_ms));
  std::vector<Datum> below;
  for (const ScanRecord& scan : run.scans) below.emplace_back(scan.time_s, 0.0);
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    std::vector<Datum> above = below;
    // What is beyond the chart is a slow moment of the machine.
    for (std::size_t i = 0; i < above.size(); ++i) {
      above[i].y() = std::min(above[i].y() + run.scans[i].stage_ms[stage], axis_from_zero("", greatest_ms).to);
    }
    chart.band(below, above, fmt::format("f{} solid", stage));
    below = std::move(above);
  }
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    chart.legend(fmt::format("f{} solid", stage), kStageWords[stage], true);
  }
}

std::vector<Datum> series(const PresetRun& run, double (*value)(const ScanRecord&)) {
  std::vector<Datum> data;
  for (const ScanRecord& scan : run.scans) data.emplace_back(scan.time_s, value(scan));
  return data;
}

double greatest(const std::vector<Datum>& data) {
  double y = 0.0;
  for (const Datum& datum : data) y = std::max(y, datum.y());
  return y;
}

}  // namespace

FigureResult draw_fig6(const std::filesystem::path& folder, const SceneRun& scene) {
  SvgPage page(960.0, 420.0, "Fig. 6: time of each step, " + scene.title,
               "Both presets took each scan in turn, on one thread; a busy machine makes peaks, so compare shares.");
  FigureResult result;
  double x = 84.0;
  for (const PresetRun& run : scene.presets) {
    const TimeSummary summary = summary_of(run.scans);
    draw_steps(page, {x, 100.0, 376.0, 260.0}, run, 1.6 * summary.high_ms);
    x += 480.0;
    std::string line = fmt::format("{:5}: {:5.1f} ms a scan;", run.name, summary.mean_ms);
    nlohmann::ordered_json shares;
    for (std::size_t i = 0; i < kStageCount; ++i) {
      line += fmt::format(" {} {:.0f} %{}", name_of(static_cast<Stage>(i)), 100.0 * summary.share[i],
                          i + 1 < kStageCount ? "," : "");
      shares[name_of(static_cast<Stage>(i))] = summary.share[i];
    }
    result.lines.push_back(line);
    result.numbers[run.name] = {{"meanMs", summary.mean_ms}, {"shares", shares}};
  }
  result.numbers["paper"] = {{"longestStep", "assign"}};
  result.lines.push_back("the paper: assigning the points takes most of the time");
  result.files.push_back(folder / ("fig6-" + scene.name + ".svg"));
  page.save(result.files.back());
  return result;
}

FigureResult draw_fig7(const std::filesystem::path& folder, const SceneRun& scene) {
  const auto ms = [](const ScanRecord& scan) { return scan.total_ms(); };
  const auto planes = [](const ScanRecord& scan) { return static_cast<double>(scan.large_planes); };
  SvgPage page(960.0, 420.0, "Fig. 7: time per scan and number of planes, " + scene.title,
               fmt::format("Planes of at least {} cells. A busy machine makes peaks.", ScanRecord::kLargeCells));
  const double end_s = scene.best().scans.back().time_s;
  const TimeSummary slow = summary_of(scene.paper().scans);
  const Axis ms_axis = axis_from_zero("ms", 1.4 * slow.high_ms);
  Chart times(page, {84.0, 100.0, 376.0, 260.0}, "(a) time per scan", {"time of the recording, s", 0.0, end_s},
              ms_axis);
  const double most = std::max(greatest(series(scene.best(), planes)), greatest(series(scene.paper(), planes)));
  Chart counts(page, {564.0, 100.0, 376.0, 260.0}, "(b) planes in the map", {"time of the recording, s", 0.0, end_s},
               axis_from_zero("planes", 1.25 * most));
  FigureResult result;
  for (const auto& [run, index] : {std::pair(&scene.paper(), 1), std::pair(&scene.best(), 0)}) {
    std::vector<Datum> data = series(*run, ms);
    for (Datum& datum : data) datum.y() = std::min(datum.y(), ms_axis.to);
    times.line(data, fmt::format("s{}", index));
    counts.line(series(*run, planes), fmt::format("s{} wide", index));
    times.legend(fmt::format("f{} solid", index), "preset " + run->name, true);
    counts.legend(fmt::format("f{} solid", index), "preset " + run->name);
    const TimeSummary summary = summary_of(run->scans);
    double points = 0.0;
    for (const ScanRecord& scan : run->scans)
      points += static_cast<double>(scan.points) / static_cast<double>(run->scans.size());
    result.lines.push_back(fmt::format(
        "{:5}: {:.1f} ms a scan ({:.1f} to {:.1f}) of {:.0f} points; {} planes in the end, {} of at least {} cells",
        run->name, summary.mean_ms, summary.least_ms, summary.greatest_ms, points, run->scans.back().planes,
        run->scans.back().large_planes, ScanRecord::kLargeCells));
    result.numbers[run->name] = {
        {"meanMs", summary.mean_ms},          {"minMs", summary.least_ms},
        {"maxMs", summary.greatest_ms},       {"pointsPerScan", points},
        {"planes", run->scans.back().planes}, {"planesOfAtLeast12Cells", run->scans.back().large_planes}};
  }
  result.numbers["paper's"] = {{"meanMs", 330.0}, {"minMs", 70.0}, {"maxMs", 720.0}, {"pointsPerScan", 300000}};
  result.lines.push_back("the paper, on its machine: 330 ms a scan (70 to 720) of 300000 points");
  result.files.push_back(folder / ("fig7-" + scene.name + ".svg"));
  page.save(result.files.back());
  return result;
}

}  // namespace planemap::experiments
