#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <planemap/described_plane.hpp>
#include <planemap/expected.hpp>
#include <planemap/query/plane_filter.hpp>
#include <planemap/snapshot.hpp>
#include <string>

namespace planemap {

/// A number as messages show it.
std::string text_of(double number);

// Each returns what is wrong with an argument, or nothing. `name` says which argument, as its sender calls it.

std::optional<Error> check_coordinates(const std::string& name, const Eigen::Vector3d& p_m);
/// Finite and greater than 0, within kMaxQueryCoordinateM.
std::optional<Error> check_length(const std::string& name, double length_m);
/// A rotation and a translation to within kMaxQueryCoordinateM.
std::optional<Error> check_pose(const std::string& name, const Eigen::Isometry3d& T);
/// Finite, symmetric, positive semi-definite.
std::optional<Error> check_covariance(const std::string& name, const Eigen::Matrix3d& covariance);
/// Limits that are numbers, and the epoch of the map.
std::optional<Error> check_filter(const PlaneFilter& filter, const MapSnapshot& snapshot);

inline tl::unexpected<Error> failure(std::optional<Error>& error) {
  return tl::make_unexpected(std::move(*error));
}

}  // namespace planemap
