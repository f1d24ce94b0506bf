#pragma once

#include <cstddef>
#include <cstdint>
#include <planemap/config.hpp>
#include <span>

#include "scoring.hpp"

namespace planemap::accuracy {

/// One rendered apartment to be mapped.
struct RunConfig {
  std::uint64_t seed = 1;
  std::size_t frames = 300;
  MapperConfig mapping = preset(Preset::kBest);
  double noise_scale = 1.0;
  double pose_sigma_m = 0.0;
  double pose_sigma_deg = 0.0;
  double pose_correlation_s = 0.0;
};

struct Run {
  Score score;
  double ms_per_scan = 0.0;  ///< mean, milliseconds
};

/// Renders the apartment, maps it and scores the map.
Run run_apartment(const RunConfig& config);

/// What several runs come to.
struct Summary {
  std::size_t surfaces = 0;
  std::size_t correct = 0;
  std::size_t over = 0;
  std::size_t under = 0;
  std::size_t missed = 0;
  std::size_t noise = 0;
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
  double ms_per_scan = 0.0;

  double correct_share() const {
    return surfaces > 0 ? static_cast<double>(correct) / static_cast<double>(surfaces) : 0.0;
  }
};

Summary summarise(std::span<const Run> runs);

}  // namespace planemap::accuracy
