#pragma once

namespace planemap {

/// Instruction set that the assignment runs on. All give the same map to rounding; for the same bytes it must be the
/// same one.
enum class SimdTarget {
  kAuto,    ///< the best that this machine has
  kAvx2,    ///< x86: AVX2 with FMA
  kAvx512,  ///< x86: AVX-512 F, BW, CD, DQ, VL
  kSse4,    ///< x86: SSE4.2
  kNeon,    ///< ARM
  kScalar,  ///< any machine
};

/// Whether this machine has it, and this binary was built for it.
bool is_supported(SimdTarget target);

}  // namespace planemap
