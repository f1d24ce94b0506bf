#pragma once

#include <Eigen/Geometry>
#include <planemap/expected.hpp>
#include <string>

namespace planemap::sources {

/// A rigid transform that a person names: seven numbers x,y,z,qx,qy,qz,qw (metres; unit quaternion, to 1e-3) or the
/// sixteen of a row-major 4x4 matrix, separated by commas or blanks; anything else is the name of a file that holds one
/// or the other. The error says what is wrong, and of which file.
Expected<Eigen::Isometry3d> read_transform(const std::string& numbers_or_file);

}  // namespace planemap::sources
