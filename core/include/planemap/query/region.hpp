#pragma once

#include <Eigen/Geometry>
#include <planemap/described_plane.hpp>
#include <planemap/query/plane_filter.hpp>
#include <planemap/snapshot.hpp>
#include <variant>
#include <vector>

namespace planemap {

/// Along the world's axes. A side may be infinite: -infinity as least, infinity as greatest coordinate.
struct BoxRegion {
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();  ///< world frame, each less than that of max_m
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
};

struct OrientedBoxRegion {
  Eigen::Isometry3d T_world_box = Eigen::Isometry3d::Identity();  ///< origin in the middle, axes along the edges
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();               ///< edges, each > 0
};

struct SphereRegion {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< world frame
  double radius_m = 0.0;                               ///< > 0
};

/// What a camera sees between two depths.
struct FrustumRegion {
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();  ///< x right, y down, z forward
  double horizontal_rad = 0.0;                                       ///< angle between left and right, in (0, pi)
  double vertical_rad = 0.0;                                         ///< angle between top and bottom, in (0, pi)
  double near_m = 0.0;                                               ///< depth along z, >= 0
  double far_m = 0.0;                                                ///< > near_m
};

struct CylinderRegion {
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero();  ///< middle of one end, world frame
  Eigen::Vector3d to_m = Eigen::Vector3d::Zero();    ///< of the other
  double radius_m = 0.0;                             ///< > 0
};

using Region = std::variant<BoxRegion, OrientedBoxRegion, SphereRegion, FrustumRegion, CylinderRegion>;

struct RegionQuery {
  Region region;
  bool polygons = false;  ///< clip the planes' surfaces
  bool cells = false;     ///< name the dense cells
  PlaneFilter filter;
};

/// A plane of whose surface something is in the region.
struct RegionPlane {
  DescribedPlane plane;
  bool whole = false;  ///< all of its surface is
  /// On demand: what is in the region, in the basis of the plane's outline, largest first. Of spheres and cylinders the
  /// circle is a polygon of 64 corners and equal area. Empty where they only touch.
  std::vector<Polygon> polygons;
  double area_m2 = 0.0;  ///< of these polygons; 0 where they were not asked for
};

struct RegionContents {
  std::vector<RegionPlane> planes;  ///< by id
  std::vector<CellView> cells;      ///< whose virtual centres are in the region; the order depends on the map alone
};

}  // namespace planemap
