#include "codec/pose_codec.hpp"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <cmath>
#include <optional>
#include <pronto/rigid_body_pose_cov_t.hpp>

#include "codec/fingerprint.hpp"
#include "codec/wire_reader.hpp"

namespace planemap::service {
namespace {

// Fingerprint, utime, and five arrays of doubles; only position and orientation mean the same in every stack.
constexpr std::size_t kPoseBytes = 8 + 8 + 8 * (3 + 3 + 4 + 3 + 3);
// Fingerprint, utime, position, quaternion.
constexpr std::size_t kTransformBytes = 8 + 8 + 8 * (3 + 4);
// Fingerprint, utime, quaternion, position, 6x6 covariance, six flags.
constexpr std::size_t kPoseCovBytes = 8 + 8 + 8 * (4 + 3 + 36) + 6;
constexpr double kUnitTolerance = 1e-3;
constexpr double kMaxPositionM = 1e6;  // keeps points within the grid's integers at its finest cell
/// Of a covariance, in units of the standard deviations: what single precision on the way leaves of symmetry and rank.
constexpr double kRounding = 1e-6;
// The limits of pose.sigma_m and pose.sigma_rad: beyond, a pose says nothing, and a rotation is not small any more.
constexpr double kMaxSigmaM = 10.0;
constexpr double kMaxSigmaRad = 1.0;

using Numbers4 = std::array<double, 4>;

Decoded<StampedPose> to_pose(const char* type, std::int64_t utime, const Eigen::Vector3d& position,
                             const Numbers4& wxyz) {
  if (utime <= 0) return reject("time", fmt::format("{}: utime is {}, must be > 0", type, utime));
  if (!position.allFinite() || position.cwiseAbs().maxCoeff() > kMaxPositionM) {
    return reject("not_finite", fmt::format("{}: position {} {} {} (allowed: finite, up to {} m)", type, position.x(),
                                            position.y(), position.z(), kMaxPositionM));
  }
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const double norm = q.norm();
  if (!std::isfinite(norm) || std::abs(norm - 1.0) > kUnitTolerance) {
    return reject("quaternion", fmt::format("{}: orientation {} {} {} {} has length {}, must be 1 within {}", type,
                                            wxyz[0], wxyz[1], wxyz[2], wxyz[3], norm, kUnitTolerance));
  }
  return StampedPose{utime, position, q.normalized(), std::nullopt};
}

Decoded<StampedPose> decode_plain(WireReader reader) {
  const std::int64_t utime = reader.i64();
  Eigen::Vector3d position;
  for (double& x : position) x = reader.f64();
  reader.bytes(3 * 8);  // vel
  Numbers4 wxyz{};
  for (double& x : wxyz) x = reader.f64();
  return to_pose("pose_t", utime, position, wxyz);
}

Decoded<StampedPose> decode_transform(WireReader reader) {
  const std::int64_t utime = reader.i64();
  Eigen::Vector3d position;
  for (double& x : position) x = reader.f64();
  Numbers4 wxyz{};
  for (double& x : wxyz) x = reader.f64();
  return to_pose("rigid_transform_t", utime, position, wxyz);
}

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Correlations by standard deviations: metres and radians are compared so. Empty where a variance is not there that
/// others hang on.
std::optional<Matrix6d> correlations(const Matrix6d& c) {
  Eigen::Matrix<double, 6, 1> per_sigma = Eigen::Matrix<double, 6, 1>::Zero();
  for (int i = 0; i < 6; ++i) {
    if (c(i, i) > 0.0) {
      per_sigma(i) = 1.0 / std::sqrt(c(i, i));
    } else if (c(i, i) < 0.0 || !c.row(i).isZero(0.0) || !c.col(i).isZero(0.0)) {
      return std::nullopt;
    }
  }
  const Matrix6d correlation = per_sigma.asDiagonal() * c * per_sigma.asDiagonal();
  if (!correlation.allFinite()) return std::nullopt;
  return correlation;
}

/// Checks that a matrix over (chi, position) is the covariance of a pose that is of use, and mends its rounding.
Decoded<Matrix6d> checked_covariance(const Matrix6d& c) {
  if (!c.allFinite()) return reject("not_finite", "rigid_body_pose_cov_t: a number of pose_cov is not finite");
  const auto correlation = correlations(c);
  if (!correlation) {
    return reject("covariance",
                  "rigid_body_pose_cov_t: pose_cov has a variance below 0, or covariances without variances");
  }
  const double sigma_rad = std::sqrt(c.diagonal().head<3>().maxCoeff());
  const double sigma_m = std::sqrt(c.diagonal().tail<3>().maxCoeff());
  if (sigma_rad > kMaxSigmaRad || sigma_m > kMaxSigmaM) {
    return reject("uncertain", fmt::format("rigid_body_pose_cov_t: the pose may be off by {:.3g} m and {:.3g} rad (one "
                                           "sigma; up to {} m and {} rad are mapped)",
                                           sigma_m, sigma_rad, kMaxSigmaM, kMaxSigmaRad));
  }
  const double asymmetry = (*correlation - correlation->transpose()).cwiseAbs().maxCoeff();
  const Matrix6d symmetric = 0.5 * (*correlation + correlation->transpose());
  const double least = Eigen::SelfAdjointEigenSolver<Matrix6d>(symmetric, Eigen::EigenvaluesOnly).eigenvalues()(0);
  if (!(asymmetry <= kRounding && least >= -kRounding)) {
    return reject("covariance", fmt::format("rigid_body_pose_cov_t: pose_cov is no covariance: its correlations differ "
                                            "by {:.2g} from their mirror images, their least eigenvalue is {:.2g}",
                                            asymmetry, least));
  }
  Matrix6d mended = 0.5 * (c + c.transpose());
  mended.diagonal() *= 1.0 + std::max(0.0, -least);
  return mended;
}

/// The type's order is (chi, position): chi turns about the body's axes (R exp(chi)), position is along the world's.
PoseCovariance in_body_frame(const Matrix6d& chi_position, const Eigen::Quaterniond& q_world_body) {
  Matrix6d to_ours = Matrix6d::Zero();
  to_ours.topRightCorner<3, 3>() = q_world_body.toRotationMatrix().transpose();
  to_ours.bottomLeftCorner<3, 3>().setIdentity();
  return to_ours * chi_position * to_ours.transpose();
}

Decoded<StampedPose> decode_with_covariance(WireReader reader) {
  const std::int64_t utime = reader.i64();
  Numbers4 wxyz{};
  for (double& x : wxyz) x = reader.f64();
  Eigen::Vector3d position;
  for (double& x : position) x = reader.f64();
  Matrix6d stated;
  for (double& x : stated.reshaped<Eigen::RowMajor>()) x = reader.f64();
  std::array<std::int8_t, 6> active{};
  for (std::int8_t& flag : active) flag = reader.i8();
  auto pose = to_pose("rigid_body_pose_cov_t", utime, position, wxyz);
  if (!pose) return pose;
  if (!std::all_of(active.begin(), active.end(), [](std::int8_t flag) { return flag == 1; })) {
    return reject("partial",
                  fmt::format("rigid_body_pose_cov_t: active_indices are {}; only a whole pose, six times 1, "
                              "places a scan",
                              fmt::join(active, " ")));
  }
  const auto covariance = checked_covariance(stated);
  if (!covariance) return tl::make_unexpected(covariance.error());
  if (!stated.isZero(0.0)) pose->covariance = in_body_frame(*covariance, pose->q_world_body);
  return pose;
}

/// A type of pose: its length never changes.
struct PoseType {
  std::int64_t fingerprint;
  const char* name;
  std::size_t bytes;
  Decoded<StampedPose> (*decode)(WireReader);
};

const auto& pose_types() {
  static const std::array types = {
      PoseType{bot_core::pose_t::getHash(), "pose_t", kPoseBytes, decode_plain},
      PoseType{bot_core::rigid_transform_t::getHash(), "rigid_transform_t", kTransformBytes, decode_transform},
      PoseType{pronto::rigid_body_pose_cov_t::getHash(), "rigid_body_pose_cov_t", kPoseCovBytes,
               decode_with_covariance},
  };
  return types;
}

tl::unexpected<Rejection> no_pose(std::span<const std::uint8_t> message) {
  const std::uint64_t fingerprint = fingerprint_of(message);
  if (const KnownType* type = known_type(fingerprint)) {
    return reject("wrong_channel",
                  fmt::format("{} ({}) is {}", type->name, fingerprint_text(fingerprint), type->belongs));
  }
  const auto text = [](std::int64_t hash) { return fingerprint_text(static_cast<std::uint64_t>(hash)); };
  return reject(
      "unknown_type",
      fmt::format("fingerprint {} is none of the types that carry poses: bot_core.pose_t ({}), "
                  "bot_core.rigid_transform_t ({}), pronto.rigid_body_pose_cov_t ({})",
                  fingerprint_text(fingerprint), text(bot_core::pose_t::getHash()),
                  text(bot_core::rigid_transform_t::getHash()), text(pronto::rigid_body_pose_cov_t::getHash())));
}

}  // namespace

Decoded<StampedPose> decode_pose(std::span<const std::uint8_t> message) {
  WireReader reader(message);
  const std::int64_t fingerprint = reader.i64();
  const auto& types = pose_types();
  const auto type =
      std::find_if(types.begin(), types.end(), [&](const PoseType& t) { return t.fingerprint == fingerprint; });
  if (!reader.ok() || type == types.end()) return no_pose(message);
  if (message.size() != type->bytes) {
    return reject("size", fmt::format("{}: {} bytes, must be {}", type->name, message.size(), type->bytes));
  }
  return type->decode(reader);
}

}  // namespace planemap::service
