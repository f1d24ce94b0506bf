#include "sync/pose_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planemap::service {
namespace {

/// 10 kHz for 10 s, 40 MB; a flood of poses a microsecond apart must not fill the memory.
constexpr std::size_t kMaxPoses = 100000;

std::int64_t to_us(double seconds) {
  return std::llround(seconds * 1e6);
}

Eigen::Isometry3d to_isometry(const Eigen::Vector3d& p_m, const Eigen::Quaterniond& q) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.toRotationMatrix();
  T.translation() = p_m;
  return T;
}

PoseLookup not_found(PoseMatch why, double gap_s = 0.0) {
  return {why, Eigen::Isometry3d::Identity(), gap_s, 0};
}

/// A pose's covariance in terms of the axes of the body when it has turned to q_world_body: positions are interpolated
/// along the world's axes, so their errors keep those; rotations along the body's own.
std::optional<PoseCovariance> along_axes_of(const Eigen::Quaterniond& q_world_body, const StampedPose& pose) {
  if (!pose.covariance) return std::nullopt;
  PoseCovariance turn = PoseCovariance::Identity();
  turn.topLeftCorner<3, 3>() = (q_world_body.conjugate() * pose.q_world_body).toRotationMatrix();
  return turn * *pose.covariance * turn.transpose();
}

PoseLookup interpolate(const StampedPose& a, const StampedPose& b, std::int64_t utime, std::uint64_t jumps) {
  const double share = static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  const Eigen::Quaterniond q_world_body = a.q_world_body.slerp(share, b.q_world_body);
  PoseLookup lookup{PoseMatch::kFound, to_isometry(a.p_world_m + share * (b.p_world_m - a.p_world_m), q_world_body),
                    0.0, jumps};
  const auto of_a = along_axes_of(q_world_body, a);
  const auto of_b = along_axes_of(q_world_body, b);
  if (of_a && of_b) {
    lookup.covariance = (1.0 - share) * *of_a + share * *of_b;
  } else {
    lookup.covariance = of_a ? of_a : of_b;
  }
  return lookup;
}

}  // namespace

PoseBuffer::PoseBuffer(const PoseConfig& config)
    : history_us_(to_us(config.buffer_s)),
      restart_us_(to_us(config.restart_s)),
      max_gap_us_(to_us(config.max_gap_s)),
      exact_us_(to_us(config.exact_s)),
      jump_m_(config.jump_m),
      jump_rad_(config.jump_deg * std::numbers::pi / 180.0) {}

PoseInsert PoseBuffer::insert(const StampedPose& pose) {
  const std::uint64_t jumps = poses_.empty() ? 0 : poses_.back().jumps;
  if (!poses_.empty() && pose.utime < poses_.back().utime - restart_us_) {
    poses_.assign(1, Kept{pose, jumps});
    return PoseInsert::kRestarted;
  }
  if (poses_.empty() || pose.utime > poses_.back().utime) {
    const bool jumped = !poses_.empty() && is_jump(poses_.back(), pose);
    poses_.push_back(Kept{pose, jumps + (jumped ? 1 : 0)});
    forget_old();
    return jumped ? PoseInsert::kJumped : PoseInsert::kAppended;
  }
  const auto place = std::lower_bound(poses_.begin(), poses_.end(), pose.utime,
                                      [](const StampedPose& p, std::int64_t utime) { return p.utime < utime; });
  if (place->utime == pose.utime) return PoseInsert::kDuplicate;
  if (poses_.size() >= kMaxPoses && place == poses_.begin()) return PoseInsert::kTooOld;
  poses_.insert(place, Kept{pose, jumps_at(place, pose)});
  forget_old();
  return PoseInsert::kOutOfOrder;
}

/// A late pose belongs to the side of a jump from which it is no jump itself.
std::uint64_t PoseBuffer::jumps_at(const std::deque<Kept>::const_iterator& place, const StampedPose& pose) const {
  const Kept& after = *place;
  if (place == poses_.begin()) return after.jumps;
  const Kept& before = *std::prev(place);
  return is_jump(before, pose) && !is_jump(pose, after) ? after.jumps : before.jumps;
}

void PoseBuffer::forget_old() {
  while (poses_.size() > kMaxPoses || poses_.front().utime < poses_.back().utime - history_us_) poses_.pop_front();
}

bool PoseBuffer::is_jump(const StampedPose& a, const StampedPose& b) const {
  // Over a longer gap a body may well have gone that far.
  if (b.utime - a.utime > max_gap_us_) return false;
  return (b.p_world_m - a.p_world_m).norm() > jump_m_ || a.q_world_body.angularDistance(b.q_world_body) > jump_rad_;
}

PoseLookup PoseBuffer::found(const Kept& pose) {
  return {PoseMatch::kFound, to_isometry(pose.p_world_m, pose.q_world_body), 0.0, pose.jumps, pose.covariance};
}

PoseLookup PoseBuffer::find(std::int64_t utime) const {
  if (poses_.empty()) return not_found(PoseMatch::kNoneYet);
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), utime,
                                      [](const StampedPose& p, std::int64_t t) { return p.utime < t; });
  if (after == poses_.end()) {
    if (utime - poses_.back().utime <= exact_us_) return found(poses_.back());
    return not_found(PoseMatch::kNotYet);
  }
  if (after->utime == utime) return found(*after);
  if (after == poses_.begin()) {
    if (after->utime - utime <= exact_us_) return found(*after);
    return not_found(PoseMatch::kBefore);
  }
  const Kept& before = *std::prev(after);
  const bool has_gap = after->utime - before.utime > max_gap_us_;
  if (!has_gap && !is_jump(before, *after)) return interpolate(before, *after, utime, before.jumps);
  const Kept& nearest = utime - before.utime <= after->utime - utime ? before : *after;
  if (std::abs(nearest.utime - utime) <= exact_us_) return found(nearest);
  const double gap_s = static_cast<double>(after->utime - before.utime) * 1e-6;
  return not_found(has_gap ? PoseMatch::kGap : PoseMatch::kJump, gap_s);
}

}  // namespace planemap::service
