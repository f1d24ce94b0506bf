#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <planemap/pose_covariance.hpp>

#include "config/service_config.hpp"

namespace planemap::service {

/// Where the body was at one time.
struct StampedPose {
  std::int64_t utime = 0;                                            ///< microseconds
  Eigen::Vector3d p_world_m = Eigen::Vector3d::Zero();               ///< origin of the body
  Eigen::Quaterniond q_world_body = Eigen::Quaterniond::Identity();  ///< unit; takes body axes to world axes
  std::optional<PoseCovariance> covariance{};                        ///< of T_world_body; empty: its source says none
};

/// What became of a pose that was inserted.
enum class PoseInsert {
  kAppended,    ///< the newest
  kJumped,      ///< the newest, and farther from the one before than jump_m or jump_deg
  kOutOfOrder,  ///< put in its place among older ones
  kDuplicate,   ///< one of that utime is there; the first stays
  kTooOld,      ///< older than all of a full buffer; left out
  kRestarted,   ///< the clock stepped back by more than restart_s: the buffer was cleared and holds only this one
};

/// Why there is a pose, or none.
enum class PoseMatch {
  kFound,
  kNoneYet,  ///< the buffer is empty
  kNotYet,   ///< the time is after the newest pose
  kBefore,   ///< the time is before the oldest pose
  kGap,      ///< the poses around it are farther apart than max_gap_s
  kJump,     ///< the poses around it are a jump apart: nobody knows where the body was in between
};

struct PoseLookup {
  PoseMatch match = PoseMatch::kNoneYet;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< with kFound
  double gap_s = 0.0;                                              ///< with kGap: between the poses around it
  std::uint64_t jumps = 0;                                         ///< with kFound: jumps of these poses until then
  std::optional<PoseCovariance> covariance{};                      ///< of T_world_body; empty: no pose states one
};

/// The poses of one channel by time. Bounded; not thread-safe.
class PoseBuffer {
 public:
  explicit PoseBuffer(const PoseConfig& config);

  PoseInsert insert(const StampedPose& pose);
  /// The pose at a time: linear in position, spherical-linear in rotation between the poses around it; the nearest pose
  /// where it is within exact_s and there is none on the other side to interpolate with. Covariances are interpolated
  /// linearly: the error of the pose in between is that mean of two errors, so this is its covariance where the two
  /// are one, and more than that where they are not, whatever they share. Where only one pose states its covariance, it
  /// stands for both.
  PoseLookup find(std::int64_t utime) const;

  std::size_t size() const { return poses_.size(); }
  std::int64_t oldest_utime() const { return poses_.empty() ? 0 : poses_.front().utime; }
  std::int64_t newest_utime() const { return poses_.empty() ? 0 : poses_.back().utime; }

 private:
  struct Kept : StampedPose {
    std::uint64_t jumps = 0;  ///< from the first pose of all to this one
  };

  static PoseLookup found(const Kept& pose);
  std::uint64_t jumps_at(const std::deque<Kept>::const_iterator& place, const StampedPose& pose) const;
  bool is_jump(const StampedPose& a, const StampedPose& b) const;
  void forget_old();

  std::int64_t history_us_;
  std::int64_t restart_us_;
  std::int64_t max_gap_us_;
  std::int64_t exact_us_;
  double jump_m_;
  double jump_rad_;
  std::deque<Kept> poses_;  ///< by utime, no two equal
};

}  // namespace planemap::service
