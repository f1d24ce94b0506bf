#pragma once

#include <cstdint>
#include <optional>
#include <planemap/described_plane.hpp>
#include <vector>

namespace planemap {

/// What became of a plane.
enum class PlaneFate : std::uint8_t {
  kLives,    ///< it is in the map under its own name
  kMerged,   ///< it is part of another plane
  kGone,     ///< it is no more
  kUnknown,  ///< no plane of that name was ever seen in this map, or it went too long ago
};

/// All that is known of a plane that is in the map.
struct PlaneDetails {
  DescribedPlane plane;               ///< its record names the planes that were merged into it
  double normal_deviation_rad = 0.0;  ///< see normal_deviation_rad()
  std::vector<PlaneId> coplanar;      ///< other planes that are coplanar with it, ascending (planemap/coplanar.hpp)
};

struct PlaneLookup {
  PlaneId asked = kNoPlane;
  PlaneFate fate = PlaneFate::kUnknown;
  /// From the plane that was asked for to the one that holds it now, as far as the steps are known: 9, 17 for "9 was
  /// merged into 17". Only the asked one where it lives or has gone; of a merger into a plane that has gone, too.
  std::vector<PlaneId> lineage;
  std::optional<std::uint64_t> removed_revision;  ///< when the asked one was merged or went; empty: not known
  std::optional<PlaneDetails> details;            ///< of the plane that holds it now; empty: gone or unknown
};

}  // namespace planemap
