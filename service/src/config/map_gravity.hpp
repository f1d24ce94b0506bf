#pragma once

#include <Eigen/Core>
#include <optional>

#include "config/service_config.hpp"

namespace planemap::service {

/// Down in the world frame; empty: not known. @pre the configuration was checked
inline std::optional<Eigen::Vector3d> gravity_of(const MapConfig& config) {
  if (config.gravity.size() != 3) return std::nullopt;
  return Eigen::Vector3d(config.gravity[0], config.gravity[1], config.gravity[2]);
}

}  // namespace planemap::service
