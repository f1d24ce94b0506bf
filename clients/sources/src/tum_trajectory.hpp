#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace planemap::sources {

/// About the year 5000: larger numbers are no times.
constexpr double kMaxTumSeconds = 1e11;

/// The camera's path in a TUM RGB-D folder (groundtruth.txt: t tx ty tz qx qy qz qw).
class TumTrajectory {
 public:
  /// Lines that can't be read (the last one may be cut short) are left out and counted; '#' begins a comment.
  static TumTrajectory parse(std::string_view text);

  /// Where the camera was. Interpolated (rotation by slerp) between its two neighbours in time if they are at most two
  /// gaps apart, else the nearest; empty if the nearest is farther than the gap.
  /// @pre utime and gap are at most kMaxTumSeconds
  std::optional<Eigen::Isometry3d> at(std::int64_t utime, std::int64_t max_gap_us) const;

  std::size_t size() const { return poses_.size(); }
  std::size_t unreadable_lines() const { return unreadable_lines_; }

 private:
  struct StampedPose {
    std::int64_t utime = 0;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  };
  static std::optional<StampedPose> parse_line(std::string_view line);

  std::vector<StampedPose> poses_;  // by time
  std::size_t unreadable_lines_ = 0;
};

}  // namespace planemap::sources
