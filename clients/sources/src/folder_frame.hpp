#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <planemap/scan.hpp>
#include <planemap/sources/depth_png.hpp>
#include <planemap/sources/open_folder.hpp>
#include <string>

namespace planemap::sources {

/// A rigid transform from the 16 numbers of a row-major 4x4 matrix. A rotation that is orthonormal to 1e-3 only (files
/// keep few digits) is replaced by the nearest true one; empty if it is worse, mirrored, or the last row is not 0 0
/// 0 1.
std::optional<Eigen::Isometry3d> parse_rigid_transform(const std::string& text);

/// A depth scan of a decoded image.
DepthScan make_depth_scan(DepthImage image, std::int64_t utime, const CameraParameters& camera, double depth_scale_m);

/// Why the options can't be used; empty if they can.
std::string objection_to(const FolderOptions& options);

}  // namespace planemap::sources
