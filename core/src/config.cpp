#include "planemap/config.hpp"

namespace planemap {

MapperConfig preset(Preset which) {
  MapperConfig config;
  if (which == Preset::kBest) return config;

  // The paper's reading, nothing more. It names the cell size; tau, phi and d are ours (docs/paper.md).
  config.grid.density_threshold = 30;
  config.grid.clamp_centres = false;
  config.grid.view_side = false;
  config.grid.second_surfaces = false;
  config.normals.fit = NormalFit::kCentres;
  config.normals.view_side = false;
  config.normals.flatness_sigmas = 0.0;
  config.normals.refresh_growth = 0.0;
  config.planes.min_cells = 1;
  config.planes.min_width_cells = 0.0;
  config.planes.strip_cells = 0.0;
  config.planes.best_seeds_first = false;
  config.planes.pooled_refit = false;
  config.planes.offset_test = false;
  config.planes.view_side = false;
  config.planes.adoption = false;
  config.planes.splits = false;
  config.planes.bridge_gap_m = 0.0;
  config.planes.slab_sigmas = 0.0;
  config.planes.core_sigmas = 0.0;
  config.wear.enabled = false;
  return config;
}

}  // namespace planemap
