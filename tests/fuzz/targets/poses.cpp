#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <cmath>
#include <pronto/rigid_body_pose_cov_t.hpp>

#include "codec/pose_codec.hpp"
#include "fuzz_input.hpp"
#include "memory_bound.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  const Bytes message = lcm_message({data, size}, {bot_core::pose_t::getHash(), bot_core::rigid_transform_t::getHash(),
                                                   pronto::rigid_body_pose_cov_t::getHash()});
  const MemoryBound bound(decoding_bound(message.size()));
  const auto pose = service::decode_pose(message);
  bound.check("decode_pose");
  if (!pose) return 0;
  require(std::abs(pose->q_world_body.norm() - 1.0) < 1e-9, "a quaternion that is not unit");
  require(pose->p_world_m.allFinite(), "a pose that is not finite");
  if (pose->covariance) {
    const PoseCovariance factor = cholesky_factor(*pose->covariance);
    require(factor.allFinite(), "a covariance without a factor");
  }
  return 0;
}
