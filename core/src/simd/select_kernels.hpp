#pragma once

#include "planemap/simd_target.hpp"
#include "simd/point_kernels.hpp"

namespace planemap::simd {

/// The kernels for an instruction set. Throws std::invalid_argument where it is not supported.
const Kernels& kernels(SimdTarget target);

}  // namespace planemap::simd
