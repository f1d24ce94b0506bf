#include "stages/kernels.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "simd/select_kernels.hpp"

namespace planemap::benchmark {

std::size_t project_image(const DepthScan& scan, double cell_size_m, SimdTarget target) {
  const simd::Kernels& kernels = simd::kernels(target);
  const PinholeIntrinsics& k = scan.intrinsics;
  const auto width = static_cast<std::size_t>(k.width);
  const auto per_m = static_cast<float>(1.0 / cell_size_m);
  simd::Projection projection;
  for (int axis = 0; axis < 3; ++axis) projection.axis_cells[axis][axis] = per_m;
  projection.cell_size_m = static_cast<float>(cell_size_m);
  projection.limit_cells = 500.0F;
  projection.depth_factor2 = 2e-6F;
  projection.lateral_factor2 = 7e-7F;
  std::vector<float> ray_x(width);
  for (std::size_t u = 0; u < width; ++u) ray_x[u] = static_cast<float>((static_cast<double>(u) - k.cx) / k.fx);
  static thread_local simd::PointChunk chunk;
  simd::PieceCounts counts;
  simd::DepthPiece piece;
  piece.depth_scale_m = static_cast<float>(scan.depth_scale_m);
  piece.nearest = 1;
  piece.farthest = 5000;
  for (int v = 0; v < k.height; ++v) {
    piece.ray_y = static_cast<float>((v - k.cy) / k.fy);
    for (std::size_t begin = 0; begin < width; begin += simd::kChunkPoints) {
      piece.depth = scan.depth.data() + static_cast<std::size_t>(v) * width + begin;
      piece.ray_x = ray_x.data() + begin;
      piece.size = std::min(simd::kChunkPoints, width - begin);
      kernels.project_depth(projection, piece, chunk, counts);
    }
  }
  return counts.mapped;
}

}  // namespace planemap::benchmark
