#pragma once

#include <planemap/described_plane.hpp>

#include "plane_blocks.hpp"

namespace planemap {

/// describe_planes() that looks only at blocks with cells of planes whose outlines it makes.
/// @param where  of the snapshot's blocks
std::vector<DescribedPlane> describe_planes(const MapSnapshot& snapshot, const std::optional<Eigen::Vector3d>& gravity,
                                            std::span<const DescribedPlane> previous, const PlaneBlocks& where);

}  // namespace planemap
