#include "summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace planemap::accuracy {

namespace {

double mean(const std::vector<double>& values) {
  return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

/// Share of sorted values in [low, high).
double share_within(const std::vector<double>& sorted, double low, double high) {
  if (sorted.empty()) return 0.0;
  const auto begin = std::lower_bound(sorted.begin(), sorted.end(), low);
  const auto end = std::lower_bound(sorted.begin(), sorted.end(), high);
  return static_cast<double>(end - begin) / static_cast<double>(sorted.size());
}

CellNormals summarise_cells(std::span<const Run> runs, bool inside_only) {
  CellNormals result;
  std::vector<double> ratios;
  for (const Run& run : runs) {
    for (const CellNormalError& cell : run.score.cell_normals) {
      if (inside_only && !cell.inside) continue;
      result.mean_deg += cell.error_rad * 180.0 / std::numbers::pi;
      ratios.push_back(cell.error_rad / cell.deviation_rad);
    }
  }
  result.cells = ratios.size();
  if (ratios.empty()) return result;
  result.mean_deg /= static_cast<double>(ratios.size());
  std::sort(ratios.begin(), ratios.end());
  result.ratio_median = quantile(ratios, 0.5);
  result.ratio_p90 = quantile(ratios, 0.9);
  result.ratio_p95 = quantile(ratios, 0.95);
  result.ratio_p99 = quantile(ratios, 0.99);
  result.within_1 = share_within(ratios, 0.0, 1.0);
  result.within_3 = share_within(ratios, 0.0, 3.0);
  return result;
}

void summarise_errors(std::span<const Run> runs, Summary& s) {
  std::vector<double> normals_deg;
  std::vector<double> offsets_m;
  std::vector<double> nees;
  for (const Run& run : runs) {
    for (const SurfaceScore& surface : run.score.surfaces) {
      if (surface.verdict != Verdict::kCorrect) continue;
      normals_deg.push_back(surface.normal_error_deg);
      offsets_m.push_back(surface.offset_error_m);
      nees.push_back(surface.nees);
    }
  }
  if (nees.empty()) return;
  s.normal_mean_deg = mean(normals_deg);
  s.normal_max_deg = *std::max_element(normals_deg.begin(), normals_deg.end());
  s.offset_mean_m = mean(offsets_m);
  s.offset_max_m = *std::max_element(offsets_m.begin(), offsets_m.end());
  std::sort(nees.begin(), nees.end());
  s.nees_median = quantile(nees, 0.5);
  s.nees_mean = mean(nees);
  s.nees_below = share_within(nees, 0.0, 7.81);
  s.nees_within = share_within(nees, 0.216, 9.35);
}

OutlineErrors summarise_outlines(std::span<const Run> runs) {
  OutlineErrors result;
  std::vector<double> overreach_m;
  std::vector<double> shortfall_m;
  for (const Run& run : runs) {
    for (const SurfaceScore& surface : run.score.surfaces) {
      const OutlineScore& outline = surface.outline;
      if (surface.verdict != Verdict::kCorrect || outline.seen_width_m < OutlineErrors::kWide_m) continue;
      ++result.planes;
      const double error = outline.area_error();
      result.area_mean += error;
      result.area_within += std::abs(error) <= 0.05 ? 1.0 : 0.0;
      if (std::abs(error) > std::abs(result.area_worst)) result.area_worst = error;
      std::vector<double> border_m = outline.border_m;
      std::sort(border_m.begin(), border_m.end());
      result.border_p95_m = std::max(result.border_p95_m, quantile(border_m, 0.95));
      overreach_m.insert(overreach_m.end(), outline.overreach_m.begin(), outline.overreach_m.end());
      shortfall_m.insert(shortfall_m.end(), outline.shortfall_m.begin(), outline.shortfall_m.end());
    }
  }
  if (result.planes == 0) return result;
  result.area_mean /= static_cast<double>(result.planes);
  result.area_within /= static_cast<double>(result.planes);
  std::sort(overreach_m.begin(), overreach_m.end());
  std::sort(shortfall_m.begin(), shortfall_m.end());
  result.overreach_p99_m = quantile(overreach_m, 0.99);
  result.overreach_max_m = quantile(overreach_m, 1.0);
  result.shortfall_p99_m = quantile(shortfall_m, 0.99);
  result.shortfall_max_m = quantile(shortfall_m, 1.0);
  return result;
}

}  // namespace

Summary summarise(std::span<const Run> runs) {
  Summary s;
  double seen_m2 = 0.0;
  double labelled_m2 = 0.0;
  for (const Run& run : runs) {
    s.surfaces += run.score.surfaces.size();
    s.correct += run.score.count(Verdict::kCorrect);
    s.over += run.score.count(Verdict::kOverSegmented);
    s.under += run.score.count(Verdict::kUnderSegmented);
    s.missed += run.score.count(Verdict::kMissed);
    s.noise += run.score.noise.size();
    s.joined += run.score.joined;
    s.stored_cells += run.stored_cells;
    s.worn_cells += run.worn_cells;
    seen_m2 += run.score.seen_m2();
    labelled_m2 += run.score.labelled_m2();
    s.ms_per_scan += run.ms_per_scan / static_cast<double>(runs.size());
  }
  s.labelled_share = seen_m2 > 0.0 ? labelled_m2 / seen_m2 : 0.0;
  summarise_errors(runs, s);
  s.cells = summarise_cells(runs, /*inside_only=*/false);
  s.outlines = summarise_outlines(runs);
  s.inside_cells = summarise_cells(runs, /*inside_only=*/true);
  return s;
}

}  // namespace planemap::accuracy
