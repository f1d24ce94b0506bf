#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <planemap/plane.hpp>
#include <vector>

namespace planemap {

/// Which planes an answer may name. As it is made, it lets every plane pass. A cell of a plane goes with its plane; a
/// cell of no plane passes as long as nothing is asked of planes.
struct PlaneFilter {
  std::vector<PlaneClass> classes;                                            ///< any of these; none given: any class
  double min_area_m2 = 0.0;                                                   ///< of the outline
  double max_normal_deviation_rad = std::numeric_limits<double>::infinity();  ///< see normal_deviation_rad()
  std::int64_t seen_since_utime = std::numeric_limits<std::int64_t>::min();   ///< microseconds; last seen then or later
  /// The life of the map that is meant. Where the map is of another one the query fails: its ids mean other planes.
  std::optional<std::uint64_t> epoch;
};

/// What passes a filter.
struct FilterMatch {
  std::vector<PlaneId> planes;  ///< ascending
  bool other_cells = false;     ///< cells of no plane do, too: nothing is asked of planes
};

/// Standard deviation of a plane's normal in the direction in which it is known worst, radians: the root of the
/// greatest eigenvalue of the covariance of (nx, ny, nz).
double normal_deviation_rad(const PlaneRecord& record);

}  // namespace planemap
