#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstddef>
#include <planemap/expected.hpp>
#include <span>
#include <string>
#include <string_view>

namespace planemap::service {

// Core's errors begin with the name that an argument has in core; whoever asks knows it by that of the request.

/// Of a batch's point: what is its own is told with its number, what is the request's (count, filter) without.
inline Error of_point(std::size_t number, const Error& error) {
  const bool is_its_own = error.message.rfind("point_m", 0) == 0 || error.message.rfind("covariance_m2", 0) == 0;
  return is_its_own ? Error{fmt::format("points[{}].{}", number, error.message)} : error;
}

/// What a shape's member is called in core, and in a request.
struct RegionName {
  std::string_view core;
  std::string_view request;
};

/// planemap.v1 has a pose's rotation, which is checked when it is read, and position.
inline constexpr RegionName kGrpcRegionNames[] = {{"oriented_box.T_world_box", "oriented_box.pose.position_m"},
                                                  {"frustum.T_world_sensor", "frustum.pose.position_m"}};
/// region_query_t has the same few members for all shapes.
inline constexpr RegionName kLcmRegionNames[] = {{"box.min_m", "box.from_m"},
                                                 {" max_m's ", " to_m's "},
                                                 {"oriented_box.T_world_box", "oriented_box.from_m"},
                                                 {"sphere.centre_m", "sphere.from_m"},
                                                 {"frustum.T_world_sensor", "frustum.from_m"}};

/// An error about a region, by the request's names.
inline Error of_region(Error error, std::span<const RegionName> names) {
  for (const auto& [core, request] : names) {
    const auto at = error.message.find(core);
    if (at != std::string::npos) error.message.replace(at, core.size(), request);
  }
  return error;
}

}  // namespace planemap::service
