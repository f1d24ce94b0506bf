#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <planemap/query/snapshot_queries.hpp>
#include <random>
#include <vector>

#include "plane_records.hpp"

namespace planemap::testing {

/// Made-up planes and cells, of which nothing is known to be in order.
struct RandomMap {
  std::shared_ptr<const MapSnapshot> snapshot;
  std::vector<DescribedPlane> planes;

  SnapshotQueries queries() const { return {snapshot, planes}; }
};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  double normal() { return normal_(engine_); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(engine_); }
  bool one_in(int n) { return below(n) == 0; }
  Eigen::Vector3d normals() { return {normal(), normal(), normal()}; }
  Eigen::Vector3d unit() { return normals().normalized(); }
  Eigen::Vector3d in_cube(double half_m) {
    return {uniform(-half_m, half_m), uniform(-half_m, half_m), uniform(-half_m, half_m)};
  }
  Eigen::Isometry3d pose(double half_m);
  /// Of errors up to about that many metres.
  Eigen::Matrix3d covariance(double sigma_m);

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

/// A rectangle about the record's centroid, along the axes of its basis.
Outline rectangle(const PlaneRecord& record, double width_m, double height_m);
DescribedPlane described(const PlaneRecord& record, const Outline& outline,
                         PlaneClass plane_class = PlaneClass::kOther);

/// A map of these planes, and of no cells unless parts has some.
RandomMap map_of(std::vector<DescribedPlane> planes, MapSnapshot::Parts parts = {});
/// Planes within 5 m of the origin with one or two ragged polygons, some with holes and one in ten without any, some
/// along the world's axes; and cells, dense ones and others, some of them of these planes.
RandomMap random_map(Random& random, int planes, int cells);

/// A place on the border of a plane's surface, or its centroid if it has none.
Eigen::Vector3d on_border(Random& random, const DescribedPlane& plane);
/// A filter that asks for something that is true of a part of the random planes.
PlaneFilter random_filter(Random& random);
/// Whether a plane passes, word by word.
bool passes(const DescribedPlane& plane, const PlaneFilter& filter);
/// Whether a cell does.
bool passes(const CellView& cell, const RandomMap& map, const PlaneFilter& filter);

}  // namespace planemap::testing
