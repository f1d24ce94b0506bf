#pragma once

#include <cstddef>
#include <cstdint>
#include <drake/lcmt_point_cloud.hpp>
#include <planemap/described_plane.hpp>
#include <span>
#include <string>

namespace planemap::service {

/// Distance of neighbouring points in a cloud of planes, where there is room for as many; metres.
constexpr double kCloudSpacingM = 0.05;

/// Planes as the points of a square grid on each, inside its boundary, in a colour by its id. Fields x, y, z and rgb as
/// Drake's viewers want them: float32 metres in the world frame, then the bytes red, green, blue and 0.
/// @param max_points  the grid is made coarser until there are no more
drake::lcmt_point_cloud to_point_cloud(std::span<const DescribedPlane> planes, std::int64_t utime,
                                       const std::string& frame, std::size_t max_points);

}  // namespace planemap::service
