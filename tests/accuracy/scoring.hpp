#pragma once

#include <cstddef>
#include <planemap/snapshot.hpp>
#include <string>
#include <vector>

#include "seen_surfaces.hpp"

namespace planemap::accuracy {

/// How a true surface fared: Hoover et al., An Experimental Comparison of Range Image Segmentation Algorithms, 1996.
enum class Verdict { kCorrect, kOverSegmented, kUnderSegmented, kMissed };

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
};

struct Score {
  std::vector<SurfaceScore> surfaces;
  std::vector<PlaneId> noise;  ///< planes of at least the least area that are on no surface, with too little overlap

  std::size_t count(Verdict verdict) const;
  double seen_m2() const;
  double labelled_m2() const;
};

/// Scores a map against what was seen of the truth.
/// @param overlap      share that makes a surface correct (Hoover's T)
/// @param least_m2     surfaces of which less was seen don't count
Score score(const MapSnapshot& map, const SeenSurfaces& seen, double overlap = 0.8, double least_m2 = 0.25);

}  // namespace planemap::accuracy
