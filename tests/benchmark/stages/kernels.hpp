#pragma once

#include <planemap/scan.hpp>
#include <planemap/simd_target.hpp>

namespace planemap::benchmark {

/// From depth to points in cells, and no more: projects a whole image with the kernels of an instruction set.
/// @return points that have a cell
std::size_t project_image(const DepthScan& scan, double cell_size_m, SimdTarget target);

}  // namespace planemap::benchmark
