#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <planemap/client/map_types.hpp>
#include <string>
#include <variant>
#include <vector>

/// Questions to a map and their answers, in plain types of the standard library. Metres, radians, square metres; world
/// frame; utimes in microseconds; standard deviations of one sigma. What the answers mean: docs/queries.md.
namespace planemap::client {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Which planes an answer may name; as it is made, every one. A cell goes with its plane; one of no plane passes only
/// where nothing is asked of planes.
struct PlaneFilter {
  std::vector<std::string> classes;  ///< any of these (floor, ceiling, wall, table, slope, other); none given: any
  double min_area_m2 = 0.0;
  double max_normal_deviation_rad = kNoLimit;  ///< > 0; standard deviation of the normal where it is known worst
  std::int64_t seen_since_utime = 0;           ///< last seen then or later; 0: whenever
  std::int64_t epoch = 0;                      ///< of the map that is meant, else the question fails; 0: whichever
};

/// Of which map an answer is.
struct MapVersion {
  std::int64_t epoch = 0;
  std::int64_t revision = 0;
};

// ---- nearest

struct QueryPoint {
  Vector3 point_m{};
  double sigma_m = 0.0;                   ///< standard deviation along all axes, beside the covariance
  std::array<double, 9> covariance_m2{};  ///< 3x3, symmetric, row-major
};

struct NearestOptions {
  std::int32_t count = 1;            ///< planes for each point, at most
  double max_distance_m = kNoLimit;  ///< to the surface, > 0
  PlaneFilter filter;
};

struct NearPlane {
  std::int64_t plane_id = 0;
  double surface_distance_m = 0.0;  ///< to the nearest point within the boundary
  Vector3 surface_point_m{};
  double signed_distance_m = 0.0;  ///< to the endless plane; > 0 on the side from which it was seen
  double sigma_m = 0.0;            ///< of the signed distance
  double mahalanobis = 0.0;
  Vector3 foot_m{};          ///< projection on the endless plane
  bool foot_inside = false;  ///< whether that is within the boundary
};

struct NearestAnswer {
  MapVersion version;
  std::vector<std::vector<NearPlane>> points;  ///< for each point in the order asked, its planes, nearest first
};

// ---- cast

struct Ray {
  Vector3 origin_m{};
  Vector3 direction{};  ///< of any length but 0
  double max_range_m = kNoLimit;
};

struct CastOptions {
  bool planes = true;
  bool cells = true;
  PlaneFilter filter;
};

struct PlaneHit {
  std::int64_t plane_id = 0;
  double range_m = 0.0;
  double sigma_m = 0.0;        ///< of the range
  double incidence_rad = 0.0;  ///< 0 square on, pi/2 edge-on
  bool from_behind = false;
  Vector3 point_m{};
};

struct CellHit {
  Cell cell;
  double entry_m = 0.0;  ///< range at which the ray enters the cell's cube
  double range_m = 0.0;  ///< at which it passes nearest to the cell's centre
  double sigma_m = 0.0;  ///< of that range
  std::optional<double> incidence_rad;
};

struct RayHits {
  std::optional<PlaneHit> plane;
  std::optional<CellHit> cell;
};

struct CastAnswer {
  MapVersion version;
  std::vector<RayHits> rays;  ///< in the order asked
};

// ---- region

/// Where a shape is: its origin, and how its axes lie in the world.
struct Pose {
  Vector3 position_m{};
  std::array<double, 4> rotation_wxyz = {1.0, 0.0, 0.0, 0.0};
};

struct Box {
  Vector3 min_m{};  ///< sides may be infinite
  Vector3 max_m{};
};
struct OrientedBox {
  Pose pose;  ///< origin in the middle
  Vector3 size_m{};
};
struct Sphere {
  Vector3 centre_m{};
  double radius_m = 0.0;
};
struct Frustum {
  Pose pose;  ///< x right, y down, z forward
  double horizontal_rad = 0.0;
  double vertical_rad = 0.0;
  double near_m = 0.0;
  double far_m = 0.0;
};
struct Cylinder {
  Vector3 from_m{};
  Vector3 to_m{};
  double radius_m = 0.0;
};
using Region = std::variant<Box, OrientedBox, Sphere, Frustum, Cylinder>;

struct RegionQuery {
  Region region;
  bool polygons = false;
  bool cells = false;
  PlaneFilter filter;
};

struct RegionPlane {
  Plane plane;
  bool whole = false;            ///< all of its surface is in the region
  std::vector<Polygon> clipped;  ///< what is in the region, in the plane's basis; on demand
  double clipped_area_m2 = 0.0;
};

struct RegionAnswer {
  MapVersion version;
  std::vector<RegionPlane> planes;  ///< by id
  std::vector<Cell> cells;
};

// ---- plane

enum class PlaneFate : std::uint8_t { kUnknown, kLives, kMerged, kGone };

struct PlaneAnswer {
  MapVersion version;
  std::int64_t asked = 0;
  PlaneFate fate = PlaneFate::kUnknown;
  std::vector<std::int64_t> lineage;             ///< 9, 17: "9 was merged into 17"
  std::optional<std::int64_t> removed_revision;  ///< when the asked one was merged or went; empty: lives, or not known
  std::optional<Plane> plane;                    ///< that holds it now; what follows is of this one
  double normal_deviation_rad = 0.0;
  std::vector<std::int64_t> coplanar;
  std::vector<std::int64_t> merged;  ///< planes that were merged into it
};

// ---- floorplan

/// Heights above the floor.
struct FloorplanQuery {
  double cut_low_m = 0.9;
  double cut_high_m = 1.5;
  double wall_thickness_m = 0.1;
  double clear_low_m = 0.1;
  double clear_high_m = 1.8;
  PlaneFilter filter;
};

/// Polygons along the plan's axes: x = p . axis_x, y = p . axis_y.
struct FloorplanAnswer {
  MapVersion version;
  Vector3 axis_x{};
  Vector3 axis_y{};
  Vector3 up{};
  double floor_height_m = 0.0;
  std::vector<Polygon> walls;
  std::vector<Polygon> floor;
  std::vector<Polygon> free_floor;
  double free_area_m2 = 0.0;
};

}  // namespace planemap::client
