#include "square_cover.hpp"

#include <algorithm>
#include <tuple>

namespace planemap {
namespace {

// Bins of half a square's side: the square of any centre in a bin covers the bin wholly and reaches no further than
// the eight bins around it. So occupied bins are part of the union, and a square whose nine bins are all occupied adds
// nothing to it.
using Bin = std::array<int, 2>;  // row, column: in this order, so that sorted bins of one row are neighbours

/// Bins first..last of a row, all occupied.
struct Run {
  int row;
  int first;
  int last;
};

int floor_div(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

Bin bin_of(const std::array<int, 2>& centre, int half_size) {
  return {floor_div(centre[1], half_size), floor_div(centre[0], half_size)};
}

/// The occupied bins, sorted by row and column.
std::vector<Run> runs_of(std::span<const std::array<int, 2>> centres, int half_size) {
  std::vector<Bin> bins;
  bins.reserve(centres.size());
  for (const auto& centre : centres) bins.push_back(bin_of(centre, half_size));
  std::sort(bins.begin(), bins.end());
  std::vector<Run> runs;
  for (const auto& [row, column] : bins) {
    if (!runs.empty() && runs.back().row == row && column <= runs.back().last + 1) {
      runs.back().last = column;
    } else {
      runs.push_back({row, column, column});
    }
  }
  return runs;
}

bool is_covered(const std::vector<Run>& runs, int row, int first, int last) {
  const auto after =
      std::upper_bound(runs.begin(), runs.end(), std::tuple(row, first),
                       [](const auto& key, const Run& run) { return key < std::tuple(run.row, run.first); });
  if (after == runs.begin()) return false;
  const Run& run = *std::prev(after);
  return run.row == row && run.last >= last;
}

std::vector<RasterRectangle> rectangles_of(const std::vector<Run>& runs, int bin_size) {
  std::vector<RasterRectangle> rectangles;
  rectangles.reserve(runs.size());
  for (const auto& [row, first, last] : runs) {
    rectangles.push_back({first * bin_size, row * bin_size, (last + 1) * bin_size, (row + 1) * bin_size});
  }
  return rectangles;
}

}  // namespace

std::vector<RasterRectangle> occupied_rows(std::span<const std::array<int, 2>> points, int bin_size) {
  return rectangles_of(runs_of(points, bin_size), bin_size);
}

std::vector<RasterRectangle> square_cover(std::span<const std::array<int, 2>> centres, int half_size) {
  const std::vector<Run> runs = runs_of(centres, half_size);
  std::vector<RasterRectangle> rectangles = rectangles_of(runs, half_size);
  for (const auto& centre : centres) {
    const auto [row, column] = bin_of(centre, half_size);
    bool inside = true;
    for (int r = row - 1; inside && r <= row + 1; ++r) inside = is_covered(runs, r, column - 1, column + 1);
    if (inside) continue;
    const auto [u, v] = centre;
    rectangles.push_back({u - half_size, v - half_size, u + half_size, v + half_size});
  }
  return rectangles;
}

}  // namespace planemap
