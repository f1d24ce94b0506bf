#pragma once

#include <cstddef>
#include <span>

#include "scoring.hpp"

namespace planemap::accuracy {

struct Run {
  Score score;
  double ms_per_scan = 0.0;  ///< mean, milliseconds
  std::size_t stored_cells = 0;
  std::size_t worn_cells = 0;  ///< taken away, though nothing moves
};

/// Errors of the normals of cells, and how they compare with what the cells say: ratio = error / stated deviation.
struct CellNormals {
  std::size_t cells = 0;
  double mean_deg = 0.0;  ///< of the errors
  double ratio_median = 0.0;
  double ratio_p90 = 0.0;
  double ratio_p95 = 0.0;
  double ratio_p99 = 0.0;
  double within_1 = 0.0;  ///< share of cells whose error is at most the stated deviation
  double within_3 = 0.0;  ///< at most three times
};

/// Outlines of the planes of correct surfaces of which a piece at least that wide was seen.
struct OutlineErrors {
  static constexpr double kWide_m = 1.5;

  std::size_t planes = 0;
  double area_within = 0.0;  ///< share of them whose area is right within 5 %
  double area_mean = 0.0;    ///< mean of the areas' errors, as a share: positive where they are too large
  double area_worst = 0.0;   ///< the error that is farthest from 0
  double border_p95_m =
      0.0;  ///< 95 % of each plane's border are nearer to the border of what was seen: the worst plane
  double overreach_p99_m = 0.0;  ///< of all their squares together
  double overreach_max_m = 0.0;
  double shortfall_p99_m = 0.0;
  double shortfall_max_m = 0.0;
};

/// What several runs come to.
struct Summary {
  std::size_t surfaces = 0;
  std::size_t correct = 0;
  std::size_t over = 0;
  std::size_t under = 0;
  std::size_t missed = 0;
  std::size_t noise = 0;
  std::size_t joined = 0;  ///< surfaces that count as part of another
  std::size_t stored_cells = 0;
  std::size_t worn_cells = 0;
  double labelled_share = 0.0;
  double normal_mean_deg = 0.0;
  double normal_max_deg = 0.0;
  double offset_mean_m = 0.0;
  double offset_max_m = 0.0;
  // NEES of the correct ones, 3 degrees of freedom: right are a median of 2.4, a mean of 3, and 95 % of each share.
  double nees_median = 0.0;
  double nees_mean = 0.0;
  double nees_below = 0.0;   ///< share below 7.81
  double nees_within = 0.0;  ///< share within [0.216, 9.35], the two-sided bounds
  CellNormals cells;         ///< of all cells of the planes of correct surfaces
  CellNormals inside_cells;  ///< of those that have nothing but their surface about them
  OutlineErrors outlines;
  double ms_per_scan = 0.0;

  double correct_share() const {
    return surfaces > 0 ? static_cast<double>(correct) / static_cast<double>(surfaces) : 0.0;
  }
};

Summary summarise(std::span<const Run> runs);

/// What the NEES of planes must come to where poses wander and the mapper is told how. Right would be a median of 2.37
/// and 95 % within the two-sided bounds; but all planes of one recording share its poses' errors, so a few recordings
/// are a small sample, and planes beside edges have errors of their own.
struct NeesBounds {
  double least_median = 1.0;
  double most_median = 5.0;
  double least_within = 0.85;

  bool hold(const Summary& summary) const {
    return summary.nees_median >= least_median && summary.nees_median <= most_median &&
           summary.nees_within >= least_within;
  }
};

}  // namespace planemap::accuracy
