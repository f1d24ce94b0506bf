#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstddef>
#include <planemap/expected.hpp>
#include <string>
#include <string_view>

namespace planemap::service {

// Core's errors begin with the name that an argument has in core; whoever asks knows it by that of the request.

/// Of a batch's point: what is its own is told with its number, what is the request's (count, filter) without.
inline Error of_point(std::size_t number, const Error& error) {
  const bool is_its_own = error.message.rfind("point_m", 0) == 0 || error.message.rfind("covariance_m2", 0) == 0;
  return is_its_own ? Error{fmt::format("points[{}].{}", number, error.message)} : error;
}

/// Of a region: what core has as a pose was sent as rotation, which is checked when it is read, and position.
/// @param position  name of the position's field, below the shape's
inline Error of_region(const Error& error, std::string_view position) {
  for (const std::string_view pose : {"oriented_box.T_world_box", "frustum.T_world_sensor"}) {
    if (error.message.rfind(pose, 0) != 0) continue;
    const std::string_view shape = pose.substr(0, pose.find('.'));
    return Error{fmt::format("{}.{}{}", shape, position, std::string_view(error.message).substr(pose.size()))};
  }
  return error;
}

}  // namespace planemap::service
