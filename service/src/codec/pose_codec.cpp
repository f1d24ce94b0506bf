#include "codec/pose_codec.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <bot_core/pose_t.hpp>
#include <cmath>

#include "codec/wire_reader.hpp"

namespace planemap::service {
namespace {

// Fingerprint, utime, and five arrays of doubles; only position and orientation mean the same in every stack.
constexpr std::size_t kPoseBytes = 8 + 8 + 8 * (3 + 3 + 4 + 3 + 3);
constexpr double kUnitTolerance = 1e-3;
constexpr double kMaxPositionM = 1e6;  // keeps points within the grid's integers at its finest cell

tl::unexpected<Rejection> reject(const char* reason, std::string message) {
  return tl::make_unexpected(Rejection{reason, std::move(message)});
}

}  // namespace

Decoded<StampedPose> decode_pose(std::span<const std::uint8_t> message) {
  WireReader reader(message);
  const std::int64_t fingerprint = reader.i64();
  if (!reader.ok() || fingerprint != bot_core::pose_t::getHash()) {
    return reject("unknown_type",
                  fmt::format("fingerprint {} is not bot_core.pose_t ({})", fingerprint_text(fingerprint_of(message)),
                              fingerprint_text(static_cast<std::uint64_t>(bot_core::pose_t::getHash()))));
  }
  if (message.size() != kPoseBytes) {
    return reject("size", fmt::format("pose_t: {} bytes, must be {}", message.size(), kPoseBytes));
  }
  const std::int64_t utime = reader.i64();
  Eigen::Vector3d position;
  for (double& x : position) x = reader.f64();
  reader.bytes(3 * 8);  // vel
  std::array<double, 4> wxyz{};
  for (double& x : wxyz) x = reader.f64();
  if (utime <= 0) return reject("time", fmt::format("pose_t: utime is {}, must be > 0", utime));
  if (!position.allFinite() || position.cwiseAbs().maxCoeff() > kMaxPositionM) {
    return reject("not_finite", fmt::format("pose_t: position {} {} {} (allowed: finite, up to {} m)", position.x(),
                                            position.y(), position.z(), kMaxPositionM));
  }
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const double norm = q.norm();
  if (!std::isfinite(norm) || std::abs(norm - 1.0) > kUnitTolerance) {
    return reject("quaternion", fmt::format("pose_t: orientation {} {} {} {} has length {}, must be 1 within {}",
                                            wxyz[0], wxyz[1], wxyz[2], wxyz[3], norm, kUnitTolerance));
  }
  return StampedPose{utime, position, q.normalized()};
}

}  // namespace planemap::service
