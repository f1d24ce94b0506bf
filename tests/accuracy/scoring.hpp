#pragma once

#include <cstddef>
#include <planemap/snapshot.hpp>
#include <string>
#include <vector>

#include "outline_scoring.hpp"
#include "seen_surfaces.hpp"

namespace planemap::accuracy {

/// How a true surface fared: Hoover et al., An Experimental Comparison of Range Image Segmentation Algorithms, 1996.
enum class Verdict { kCorrect, kOverSegmented, kUnderSegmented, kMissed };

const char* name_of(Verdict verdict);

/// One true surface of which enough was seen.
struct SurfaceScore {
  std::string name;
  double seen_m2 = 0.0;
  double labelled_m2 = 0.0;  ///< of the seen part, in any plane
  Verdict verdict = Verdict::kMissed;
  PlaneId plane = kNoPlane;  ///< that overlaps it most
  double overlap = 0.0;      ///< share of the seen part in that plane
  double purity = 0.0;       ///< share of that plane on this surface
  // Of correct ones:
  double normal_error_deg = 0.0;
  double offset_error_m = 0.0;  ///< at the plane's centroid
  double nees = 0.0;            ///< normalised squared error of (n, d), 3 degrees of freedom
  OutlineScore outline;
};

/// The normal of a dense cell in the plane of a correct surface.
struct CellNormalError {
  double error_rad = 0.0;      ///< angle to the surface's normal
  double deviation_rad = 0.0;  ///< what the cell states
  bool inside = false;         ///< all of the surface within the cell's neighbourhood was seen: no edge is near
};

struct Score {
  std::vector<SurfaceScore> surfaces;
  std::size_t joined = 0;  ///< surfaces of which enough was seen that count as part of another: no map can tell them
  std::vector<PlaneId> noise;  ///< planes of at least the least area that are on no surface, with too little overlap
  std::vector<CellNormalError> cell_normals;

  std::size_t count(Verdict verdict) const;
  double seen_m2() const;
  double labelled_m2() const;
};

struct ScoreOptions {
  double overlap = 0.8;           ///< share that makes a surface correct (Hoover's T)
  double least_m2 = 0.25;         ///< surfaces of which less was seen don't count
  double covariance_scale = 1.0;  ///< times the planes' covariances: wrong ones must show in the NEES
};

/// Scores a map against what was seen of the truth. Facets of curved surfaces are not to be found; but a plane on them
/// is no noise if it lies there as a facet does: at least the overlap of it within kFacetOffset_m of the curved
/// surface.
Score score(const MapSnapshot& map, const SeenSurfaces& seen, const ScoreOptions& options = {});

/// The plane of each of seen.patches(), as the score tells it; kNoPlane: none is there.
std::vector<PlaneId> planes_of_patches(const MapSnapshot& map, const SeenSurfaces& seen);

/// A Kinect's standard error at 2.6 m: a strip that departs from the curved surface by less is flat to it.
constexpr double kFacetOffset_m = 0.01;

}  // namespace planemap::accuracy
