#pragma once

#include <cstdint>
#include <span>

#include "codec/rejection.hpp"
#include "sync/pose_buffer.hpp"

namespace planemap::service {

/// Decodes bot_core.pose_t (rigid_body.pose_t has the same fingerprint), bot_core.rigid_transform_t or
/// pronto.rigid_body_pose_cov_t, told apart by the fingerprint. The quaternion is normalised; one that is no unit
/// quaternion within 1e-3 is rejected, never mended into a made-up pose. A covariance must be one to within rounding,
/// which is mended towards the greater; one of all zeros states nothing.
Decoded<StampedPose> decode_pose(std::span<const std::uint8_t> message);

}  // namespace planemap::service
