#pragma once

#include <initializer_list>
#include <planemap/fields.hpp>
#include <planemap/simd_target.hpp>
#include <type_traits>

namespace planemap {

/// T is S or const S.
template <class T, class S>
concept MaybeConst = std::is_same_v<std::remove_const_t<T>, S>;

// Each struct lists its settings once, in visit_fields(config, visit): visit(info, value) for numbers, flags and words,
// visit(info, value, choices) for enumerations. Reading, printing and checking a configuration are all made from that
// list.

/// How the method is computed; none of it changes what is computed.
struct CoreConfig {
  SimdTarget simd = SimdTarget::kAuto;
};

template <MaybeConst<CoreConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"simd", "instruction set; the same one gives the same bytes"}, c.simd,
        std::initializer_list<Choice<SimdTarget>>{{"auto", SimdTarget::kAuto},
                                                  {"avx2", SimdTarget::kAvx2},
                                                  {"avx512", SimdTarget::kAvx512},
                                                  {"sse4", SimdTarget::kSse4},
                                                  {"neon", SimdTarget::kNeon},
                                                  {"scalar", SimdTarget::kScalar}});
}

/// Errors and limits of a Kinect-like depth sensor; Khoshelham and Elberink, Sensors 12(2), 2012.
struct SensorConfig {
  double min_range_m = 0.4;
  double max_range_m = 5.0;
  double depth_sigma_per_m = 1.425e-3;
  double baseline_m = 0.075;
  double disparity_step_px = 0.125;
  double lateral_floor_px = 0.5;
  double focal_length_px = 585.0;
};

template <MaybeConst<SensorConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"min_range_m", "nearest depth that is mapped", 0.0, 1000.0}, c.min_range_m);
  visit(FieldInfo{"max_range_m", "farthest depth that is mapped", 0.0, 1000.0}, c.max_range_m);
  visit(FieldInfo{"depth_sigma_per_m", "k in sigma_z = k z^2, the random error of depth z (1/m)", 0.0, 1.0},
        c.depth_sigma_per_m);
  visit(FieldInfo{"baseline_m", "distance between projector and camera, for the quantisation of depth", 1e-3, 10.0},
        c.baseline_m);
  visit(FieldInfo{"disparity_step_px", "step in which the sensor measures disparity; 0: not quantised", 0.0, 10.0},
        c.disparity_step_px);
  visit(FieldInfo{"lateral_floor_px", "least standard error across the ray, pixels", 0.0, 10.0}, c.lateral_floor_px);
  visit(FieldInfo{"focal_length_px", "stands in for the focal length where a scan brings no intrinsics", 1.0, 1e5},
        c.focal_length_px);
}

/// The uncertain grid and the assignment of points to it (paper, section III).
struct GridConfig {
  double cell_size_m = 0.08;
  int density_threshold = 12;
  bool clamp_centres = true;
  bool view_side = true;
  bool second_surfaces = true;
};

template <MaybeConst<GridConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"cell_size_m", "edge of a cell (the paper's xi)", 0.005, 10.0}, c.cell_size_m);
  visit(FieldInfo{"density_threshold", "a cell is dense with more points than this (the paper's tau)", 0.0, 1e9},
        c.density_threshold);
  visit(FieldInfo{"clamp_centres", "for the assignment, keep virtual centres inside their cells"}, c.clamp_centres);
  visit(FieldInfo{"view_side", "cells seen from the other side attract no points"}, c.view_side);
  visit(FieldInfo{"second_surfaces", "a cell that a plane passes through keeps what lies off that plane apart"},
        c.second_surfaces);
}

/// Which evidence a cell's normal is fitted to.
enum class NormalFit {
  kCentres,  ///< total least squares over the virtual centres of the neighbourhood: the paper
  kPooled,   ///< second moments of all points of the neighbourhood, weighted by 1/sigma^2
};

/// Which standard error Definition 3 perturbs a virtual centre by.
enum class CentreError {
  kMean,   ///< of the mean of the cell's points, sqrt(S_s)/n (Eq. 2)
  kPoint,  ///< of one point of the cell, sqrt(S_s/n)
};

/// Uncertain normals of cells (paper, section IV.A).
struct NormalConfig {
  int neighbourhood_depth = 1;
  NormalFit fit = NormalFit::kPooled;
  CentreError centre_error = CentreError::kMean;
  bool view_side = true;
  double max_deviation_deg = 10.0;
  double flatness_sigmas = 2.0;
  double flatness_floor_m = 0.005;
  double refresh_growth = 0.1;
};

template <MaybeConst<NormalConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"neighbourhood_depth", "d of Definition 2: steps from a cell to the cells its normal is fitted to", 1,
                  4},
        c.neighbourhood_depth);
  visit(FieldInfo{"fit", "what a normal is fitted to"}, c.fit,
        std::initializer_list<Choice<NormalFit>>{{"centres", NormalFit::kCentres}, {"pooled", NormalFit::kPooled}});
  visit(FieldInfo{"centre_error", "error that Definition 3 perturbs a centre by"}, c.centre_error,
        std::initializer_list<Choice<CentreError>>{{"mean", CentreError::kMean}, {"point", CentreError::kPoint}});
  visit(FieldInfo{"view_side", "leave out neighbours that were seen from the other side"}, c.view_side);
  visit(FieldInfo{"max_deviation_deg", "cells whose normal deviates by more are left out of planes", 0.0, 90.0},
        c.max_deviation_deg);
  visit(FieldInfo{"flatness_sigmas",
                  "a neighbourhood that scatters about its plane by more sigma has no normal; 0: off", 0.0, 100.0},
        c.flatness_sigmas);
  visit(FieldInfo{"flatness_floor_m", "scatter that is always allowed", 0.0, 1.0}, c.flatness_floor_m);
  visit(FieldInfo{"refresh_growth", "a normal is fitted again when its cell's points grew by this share", 0.0, 10.0},
        c.refresh_growth);
}

/// Local and global planes (paper, section IV.B, and what lifts it).
struct PlaneConfig {
  double normal_angle_deg = 15.0;
  int min_cells = 12;
  double min_width_cells = 0.6;
  double strip_cells = 1.6;
  bool best_seeds_first = true;
  bool pooled_refit = true;
  bool offset_test = true;
  double cell_offset_m = 0.03;
  double plane_offset_m = 0.02;
  bool view_side = true;
  bool adoption = true;
  bool splits = true;
  double crease_angle_deg = 4.5;
  double bridge_gap_m = 1.0;
  double bridge_angle_deg = 1.5;
  double slab_sigmas = 3.0;
  double slab_ratio = 4.0;
  double core_sigmas = 5.0;
  double core_floor_m = 0.002;
  double core_angle_deg = 8.0;
  double offset_floor_m = 5e-5;
};

template <MaybeConst<PlaneConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"normal_angle_deg", "normals are similar up to this angle (the paper's phi)", 0.1, 90.0},
        c.normal_angle_deg);
  visit(FieldInfo{"min_cells", "a local plane of fewer cells starts no global one", 1, 1e6}, c.min_cells);
  visit(FieldInfo{"min_width_cells", "a local plane narrower than this many cells starts no global one", 0.0, 1000.0},
        c.min_width_cells);
  visit(FieldInfo{"strip_cells", "one narrower than this has to be flat to what its points' errors allow", 0.0, 1000.0},
        c.strip_cells);
  visit(FieldInfo{"best_seeds_first", "grow local planes from the cells with the surest normals first"},
        c.best_seeds_first);
  visit(FieldInfo{"pooled_refit", "fit planes to the second moments of their cells, not to the mean of their normals"},
        c.pooled_refit);
  visit(FieldInfo{"offset_test", "beside the angle, test the distance between cell and plane, plane and plane"},
        c.offset_test);
  visit(FieldInfo{"cell_offset_m", "a cell within this distance of a plane may join it", 1e-4, 10.0}, c.cell_offset_m);
  visit(FieldInfo{"plane_offset_m", "planes within this distance of each other may merge", 1e-4, 10.0},
        c.plane_offset_m);
  visit(FieldInfo{"view_side", "surfaces seen from opposite sides are never one plane"}, c.view_side);
  visit(FieldInfo{"adoption", "cells without a plane join an adjacent one by their distance to it"}, c.adoption);
  visit(
      FieldInfo{"splits", "flat pieces that make a crease are two planes, and take the cells that are nearer to them"},
      c.splits);
  visit(FieldInfo{"crease_angle_deg", "flat pieces at more than this angle are two planes", 0.0, 90.0},
        c.crease_angle_deg);
  visit(FieldInfo{"bridge_gap_m", "coplanar pieces with a gap up to this are one plane; 0: off", 0.0, 10.0},
        c.bridge_gap_m);
  visit(FieldInfo{"bridge_angle_deg", "pieces across a gap differ by at most this angle", 0.0, 90.0},
        c.bridge_angle_deg);
  visit(
      FieldInfo{"slab_sigmas", "a plane takes cells of a smaller one within this many sigma of it; 0: off", 0.0, 10.0},
      c.slab_sigmas);
  visit(FieldInfo{"slab_ratio", "how many times larger the plane that takes cells has to be", 1.0, 1000.0},
        c.slab_ratio);
  visit(FieldInfo{"core_sigmas", "cells whose points scatter about their plane by more sigma don't shape it; 0: all do",
                  0.0, 100.0},
        c.core_sigmas);
  visit(FieldInfo{"core_floor_m", "scatter that is expected beside the sensor's", 0.0, 1.0}, c.core_floor_m);
  visit(FieldInfo{"core_angle_deg", "cells whose normal turns away by more don't shape their plane either", 0.0, 90.0},
        c.core_angle_deg);
  visit(FieldInfo{"offset_floor_m", "no plane is known better than this", 0.0, 1.0}, c.offset_floor_m);
}

/// How wrong the poses of scans may be: a first-order Gauss-Markov process along and about each axis of the sensor. All
/// 0: poses are exact, as the paper assumes. A scan that brings the covariance of its own pose is taken at its word;
/// how long its error lasts is said here in any case.
struct PoseErrorConfig {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
  double correlation_s = 0.0;

  bool any() const { return sigma_m > 0.0 || sigma_rad > 0.0; }
};

template <MaybeConst<PoseErrorConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"sigma_m", "standard error of a position along each axis, for poses that state none; 0: exact", 0.0,
                  10.0},
        c.sigma_m);
  visit(FieldInfo{"sigma_rad", "standard error of a rotation about each axis, for poses that state none; 0: exact", 0.0,
                  1.0},
        c.sigma_rad);
  visit(FieldInfo{"correlation_s",
                  "time in which errors of poses change, stated ones too; 0: each pose errs on its own", 0.0, 3600.0},
        c.correlation_s);
}

/// How things that have gone leave the map.
struct WearConfig {
  bool enabled = true;
  double after_s = 1.0;
  double clearance_cells = 0.25;
  double sigmas = 3.0;
};

template <MaybeConst<WearConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"enabled", "cells that later scans see through lose their points; off: the map only grows"},
        c.enabled);
  visit(FieldInfo{"after_s", "a cell goes when it was seen through for so long without getting points", 0.01, 60.0},
        c.after_s);
  visit(FieldInfo{"clearance_cells", "what is seen through must be free for so many cells around the cell, too", 0.0,
                  4.0},
        c.clearance_cells);
  visit(FieldInfo{"sigmas", "what is seen behind a cell lies behind it by more sigma of both depths", 0.0, 100.0},
        c.sigmas);
}

/// All of the method. Values have been checked by whoever read them; the mapper asserts no more than their ranges.
struct MapperConfig {
  CoreConfig core;
  SensorConfig sensor;
  GridConfig grid;
  NormalConfig normals;
  PlaneConfig planes;
  PoseErrorConfig pose_error;
  WearConfig wear;
};

enum class Preset {
  kBest,   ///< the default: the paper and what was found to lift it
  kPaper,  ///< the paper's reading, nothing more
};

/// The settings of a preset; see docs/paper.md for each value's reason.
MapperConfig preset(Preset which);

}  // namespace planemap
