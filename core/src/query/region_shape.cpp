#include "query/region_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <planemap/query/limits.hpp>
#include <string>

#include "query/argument_checks.hpp"

namespace planemap {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Error at_axis(const char* name, int axis, const std::string& what) {
  return Error{std::string(name) + "." + "xyz"[axis] + ": " + what};
}

Expected<RegionShape> shape(const BoxRegion& box) {
  RegionShape shape;
  shape.bounds = {box.min_m, box.max_m};
  for (int axis = 0; axis < 3; ++axis) {
    const double low_m = box.min_m[axis];
    const double high_m = box.max_m[axis];
    if (!(low_m < high_m)) {
      auto what = "must be less than max_m's " + text_of(high_m);
      return tl::make_unexpected(at_axis("box.min_m", axis, what + ", is " + text_of(low_m)));
    }
    const auto add = [&](double sign, double side_m) {
      if (std::isfinite(side_m)) shape.half_spaces.push_back({sign * Eigen::Vector3d::Unit(axis), sign * side_m});
    };
    add(-1.0, low_m);
    add(1.0, high_m);
  }
  return shape;
}

Expected<RegionShape> shape(const OrientedBoxRegion& box) {
  if (auto error = check_pose("oriented_box.T_world_box", box.T_world_box)) return failure(error);
  RegionShape shape;
  const Eigen::Vector3d middle_m = box.T_world_box.translation();
  Eigen::Vector3d reach_m = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (auto error = check_length(std::string("oriented_box.size_m.") + "xyz"[axis], box.size_m[axis])) {
      return failure(error);
    }
    const Eigen::Vector3d along = box.T_world_box.linear().col(axis);
    const double half_m = 0.5 * box.size_m[axis];
    shape.half_spaces.push_back({along, along.dot(middle_m) + half_m});
    shape.half_spaces.push_back({-along, -along.dot(middle_m) + half_m});
    reach_m += half_m * along.cwiseAbs();
  }
  shape.bounds = {middle_m - reach_m, middle_m + reach_m};
  return shape;
}

Expected<RegionShape> shape(const SphereRegion& sphere) {
  if (auto error = check_coordinates("sphere.centre_m", sphere.centre_m)) return failure(error);
  if (auto error = check_length("sphere.radius_m", sphere.radius_m)) return failure(error);
  RegionShape shape;
  const Eigen::Vector3d reach_m = Eigen::Vector3d::Constant(sphere.radius_m);
  shape.bounds = {sphere.centre_m - reach_m, sphere.centre_m + reach_m};
  shape.round = Round{sphere.centre_m, Eigen::Matrix3d::Identity(), sphere.radius_m};
  return shape;
}

std::optional<Error> check(const FrustumRegion& frustum) {
  if (auto error = check_pose("frustum.T_world_sensor", frustum.T_world_sensor)) return error;
  const auto check_angle = [](const char* name, double angle_rad) -> std::optional<Error> {
    if (angle_rad > 0.0 && angle_rad < M_PI) return std::nullopt;
    return Error{std::string(name) + ": must be greater than 0 and less than pi, is " + text_of(angle_rad)};
  };
  if (auto error = check_angle("frustum.horizontal_rad", frustum.horizontal_rad)) return error;
  if (auto error = check_angle("frustum.vertical_rad", frustum.vertical_rad)) return error;
  if (auto error = check_length("frustum.far_m", frustum.far_m)) return error;
  if (frustum.near_m >= 0.0 && frustum.near_m < frustum.far_m) return std::nullopt;
  return Error{"frustum.near_m: must be at least 0 and less than far_m's " + text_of(frustum.far_m) + ", is " +
               text_of(frustum.near_m)};
}

Expected<RegionShape> shape(const FrustumRegion& frustum) {
  if (auto error = check(frustum)) return failure(error);
  const Eigen::Isometry3d& T = frustum.T_world_sensor;
  const double tan_x = std::tan(0.5 * frustum.horizontal_rad);
  const double tan_y = std::tan(0.5 * frustum.vertical_rad);
  RegionShape shape;
  const auto add = [&](const Eigen::Vector3d& normal_sensor, double offset_m) {
    const Eigen::Vector3d normal = T.linear() * normal_sensor.normalized();
    shape.half_spaces.push_back({normal, normal.dot(T.translation()) + offset_m});
  };
  for (const double sign : {-1.0, 1.0}) {
    add({sign, 0.0, -tan_x}, 0.0);
    add({0.0, sign, -tan_y}, 0.0);
    for (const double other : {-1.0, 1.0}) {
      const Eigen::Vector3d ray(sign * tan_x, other * tan_y, 1.0);
      shape.bounds.extend(T * Eigen::Vector3d(frustum.near_m * ray));
      shape.bounds.extend(T * Eigen::Vector3d(frustum.far_m * ray));
    }
  }
  add({0.0, 0.0, -1.0}, -frustum.near_m);
  add({0.0, 0.0, 1.0}, frustum.far_m);
  return shape;
}

Expected<RegionShape> shape(const CylinderRegion& cylinder) {
  if (auto error = check_coordinates("cylinder.from_m", cylinder.from_m)) return failure(error);
  if (auto error = check_coordinates("cylinder.to_m", cylinder.to_m)) return failure(error);
  if (auto error = check_length("cylinder.radius_m", cylinder.radius_m)) return failure(error);
  const double length_m = (cylinder.to_m - cylinder.from_m).norm();
  if (length_m <= kOnBorderM) return fail("cylinder.to_m: must not be the same point as from_m");
  const Eigen::Vector3d axis = (cylinder.to_m - cylinder.from_m) / length_m;
  RegionShape shape;
  shape.half_spaces.push_back({axis, axis.dot(cylinder.to_m)});
  shape.half_spaces.push_back({-axis, -axis.dot(cylinder.from_m)});
  const Eigen::Vector3d reach_m = cylinder.radius_m * (1.0 - axis.array().square()).max(0.0).sqrt().matrix();
  for (const Eigen::Vector3d& end_m : {cylinder.from_m, cylinder.to_m}) {
    shape.bounds.extend(end_m - reach_m);
    shape.bounds.extend(end_m + reach_m);
  }
  shape.round = Round{cylinder.from_m, Eigen::Matrix3d::Identity() - axis * axis.transpose(), cylinder.radius_m};
  return shape;
}

/// A polygon that stands for the unit circle: off by 0.08 % of the radius, 4 mm at 5 m, where outlines are simplified
/// to 2 cm.
struct UnitCircle {
  std::array<Eigen::Vector2d, 64> normals;  ///< of its sides
  double reach = 0.0;                       ///< of its sides from the middle, such that it has the circle's area

  UnitCircle() {
    const double step_rad = 2.0 * M_PI / static_cast<double>(normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const double angle_rad = static_cast<double>(i) * step_rad;
      normals[i] = {std::cos(angle_rad), std::sin(angle_rad)};
    }
    reach = std::sqrt(M_PI / (static_cast<double>(normals.size()) * std::tan(0.5 * step_rad)));
  }
};

}  // namespace

bool RegionShape::contains(const Eigen::Vector3d& p_m) const {
  const bool in_all = std::all_of(half_spaces.begin(), half_spaces.end(), [&](const HalfSpace& half_space) {
    return half_space.normal.dot(p_m) <= half_space.offset_m + kOnBorderM;
  });
  return in_all && (!round || round->distance_m(p_m) <= round->radius_m + kOnBorderM);
}

std::vector<HalfPlane> RegionShape::half_planes_on(const PlaneBasis& basis) const {
  std::vector<HalfPlane> half_planes;
  half_planes.reserve(half_spaces.size());
  for (const HalfSpace& half_space : half_spaces) {
    const Eigen::Vector3d& n = half_space.normal;
    half_planes.push_back(
        {{n.dot(basis.axis_u), n.dot(basis.axis_v)}, half_space.offset_m + kOnBorderM - n.dot(basis.origin_m)});
  }
  return half_planes;
}

Expected<RegionShape> shape_of(const Region& region) {
  return std::visit([](const auto& of_kind) { return shape(of_kind); }, region);
}

RoundOnPlane::RoundOnPlane(const Round& round, const PlaneBasis& basis) : radius_m_(round.radius_m + kOnBorderM) {
  map_ << basis.axis_u, basis.axis_v;
  map_ = (round.across * map_).eval();
  offset_m_ = round.across * (basis.origin_m - round.centre_m);
  // The greater stretch is 1: some direction on the plane is across the line. The other one is the cosine between.
  const Eigen::Matrix2d square = map_.transpose() * map_;
  const double turn_rad = 0.5 * std::atan2(2.0 * square(0, 1), square(0, 0) - square(1, 1));
  axes_ << std::cos(turn_rad), -std::sin(turn_rad), std::sin(turn_rad), std::cos(turn_rad);
  squared_stretches_ = (axes_.transpose() * square * axes_).diagonal().cwiseMax(0.0);
  // Along a line that lies in the plane nothing changes: any place on it will do.
  constexpr double kLeastSquaredStretch = 1e-12;
  if (squared_stretches_[1] < kLeastSquaredStretch) squared_stretches_[1] = 0.0;
  const Eigen::Vector2d gradient = axes_.transpose() * (map_.transpose() * offset_m_);
  centre_m_ = axes_.col(0) * (-gradient[0] / squared_stretches_[0]);
  if (squared_stretches_[1] > 0.0) centre_m_ -= axes_.col(1) * (gradient[1] / squared_stretches_[1]);
}

bool RoundOnPlane::touches(const std::vector<Ring>& rings) const {
  bool odd = false;
  double least_m2 = kInfinity;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d& a = ring[i];
      const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
      const Eigen::Vector3d from_m = offset_m_ + map_ * a;
      const Eigen::Vector3d step_m = map_ * (b - a);
      const double length2 = step_m.squaredNorm();
      const double along = length2 > 0.0 ? std::clamp(-from_m.dot(step_m) / length2, 0.0, 1.0) : 0.0;
      least_m2 = std::min(least_m2, (from_m + along * step_m).squaredNorm());
      if ((a.y() <= centre_m_.y()) == (b.y() <= centre_m_.y())) continue;
      odd ^= centre_m_.x() < a.x() + (centre_m_.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    }
  }
  // Where a cylinder lies along the plane, what is least within the rings is so on their border, too.
  if (odd && squared_stretches_[1] > 0.0) least_m2 = std::min(least_m2, (offset_m_ + map_ * centre_m_).squaredNorm());
  return least_m2 <= radius_m_ * radius_m_;
}

std::optional<std::vector<HalfPlane>> RoundOnPlane::half_planes() const {
  const double rest_m2 = radius_m_ * radius_m_ - (offset_m_ + map_ * centre_m_).squaredNorm();
  if (!(rest_m2 > 0.0)) return std::nullopt;
  const double rest_m = std::sqrt(rest_m2);
  std::vector<HalfPlane> half_planes;
  const auto add = [&](const Eigen::Vector2d& normal, double reach_m) {
    half_planes.push_back({normal, normal.dot(centre_m_) + reach_m});
  };
  const Eigen::Vector2d stretches = squared_stretches_.cwiseSqrt();
  if (stretches[1] == 0.0) {
    for (const double sign : {-1.0, 1.0}) add(sign * stretches[0] * axes_.col(0), rest_m);
    return half_planes;
  }
  static const UnitCircle kCircle;
  const double reach_m = rest_m * kCircle.reach;
  half_planes.reserve(kCircle.normals.size());
  for (const Eigen::Vector2d& on_circle : kCircle.normals) add(axes_ * stretches.cwiseProduct(on_circle), reach_m);
  return half_planes;
}

}  // namespace planemap
