#include "tum_trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "text_file.hpp"

namespace planemap::sources {
namespace {

constexpr double kQuaternionTolerance = 1e-2;  // of its length from 1; TUM writes four digits

}  // namespace

std::optional<TumTrajectory::StampedPose> TumTrajectory::parse_line(std::string_view line) {
  const auto numbers = parse_numbers(line);
  if (!numbers || numbers->size() != 8) return std::nullopt;
  const std::vector<double>& n = *numbers;
  Eigen::Quaterniond rotation(n[7], n[4], n[5], n[6]);
  if (std::abs(rotation.norm() - 1.0) > kQuaternionTolerance || std::abs(n[0]) > kMaxTumSeconds) return std::nullopt;
  rotation.normalize();
  return StampedPose{std::llround(n[0] * 1e6), {n[1], n[2], n[3]}, rotation};
}

TumTrajectory TumTrajectory::parse(std::string_view text) {
  TumTrajectory trajectory;
  for (const std::string_view line : split_lines(text)) {
    if (line.starts_with('#') || split_words(line).empty()) continue;
    if (const auto pose = parse_line(line)) {
      trajectory.poses_.push_back(*pose);
    } else {
      ++trajectory.unreadable_lines_;
    }
  }
  std::stable_sort(trajectory.poses_.begin(), trajectory.poses_.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.utime < b.utime; });
  return trajectory;
}

std::optional<Eigen::Isometry3d> TumTrajectory::at(std::int64_t utime, std::int64_t max_gap_us) const {
  const auto to_transform = [](const Eigen::Vector3d& position_m, const Eigen::Quaterniond& rotation) {
    Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
    transform.linear() = rotation.toRotationMatrix();
    transform.translation() = position_m;
    return transform;
  };
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), utime,
                                      [](const StampedPose& pose, std::int64_t time) { return pose.utime < time; });
  const StampedPose* later = after == poses_.end() ? nullptr : &*after;
  const StampedPose* earlier = after == poses_.begin() ? nullptr : &*(after - 1);
  const StampedPose* nearest = later;
  if (later == nullptr || (earlier != nullptr && utime - earlier->utime < later->utime - utime)) nearest = earlier;
  if (nearest == nullptr || std::abs(nearest->utime - utime) > max_gap_us) return std::nullopt;
  if (earlier == nullptr || later == nullptr || later->utime - earlier->utime > 2 * max_gap_us) {
    return to_transform(nearest->position_m, nearest->rotation);
  }
  const double share = static_cast<double>(utime - earlier->utime) / static_cast<double>(later->utime - earlier->utime);
  return to_transform((1.0 - share) * earlier->position_m + share * later->position_m,
                      earlier->rotation.slerp(share, later->rotation));
}

}  // namespace planemap::sources
