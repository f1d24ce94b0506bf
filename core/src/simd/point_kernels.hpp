#pragma once

#include <cstddef>
#include <cstdint>

// What the assignment does to every point, for vectors of points. Plain structs and pointers only: the kernels are
// compiled once for each instruction set, and an inline function of a library that slipped in would be, too.
namespace planemap::simd {

constexpr std::size_t kChunkPoints = 320;  ///< half a row of a Kinect: a chunk and what it needs stay in the L1 cache
constexpr std::size_t kMaxLanes = 16;      ///< widest vector that is used, floats
constexpr std::size_t kSumCount = 12;      ///< sums of an Accumulator

/// From the sensor frame to cells. World coordinates are counted in cells from the cell that the sensor is in, so
/// floats are precise to a millionth of a cell at 20 cells, and to far less than any sensor's error at any range.
struct Projection {
  float axis_cells[3][3] = {};   ///< [k][w]: component along world axis w of the sensor's k-th axis, cells per metre
  float origin_cells[3] = {};    ///< the sensor within its cell, 0 to 1
  float cell_size_m = 0.0F;      ///< edge of a cell
  float limit_cells = 0.0F;      ///< points that are farther away along an axis have no cell
  float depth_factor2 = 0.0F;    ///< (sigma_z / z^2)^2, 1/m2
  float lateral_factor2 = 0.0F;  ///< floor of (sigma_x / z)^2
};

/// A piece of a row of a depth image.
struct DepthPiece {
  const std::uint16_t* depth = nullptr;
  const float* ray_x = nullptr;  ///< (u - cx) / fx of each pixel
  std::size_t size = 0;          ///< pixels, at most kChunkPoints
  float ray_y = 0.0F;            ///< (v - cy) / fy
  float depth_scale_m = 0.0F;    ///< metres per unit of depth
  std::int32_t nearest = 0;      ///< least depth that is mapped, in units of depth
  std::int32_t farthest = 0;     ///< greatest
};

/// A piece of a point cloud, sensor frame.
struct CloudPiece {
  const float* xyz_m = nullptr;    ///< x0 y0 z0 x1 ...
  const float* sigma_m = nullptr;  ///< standard errors, laid out alike; nullptr: the sensor model gives them
  std::size_t size = 0;            ///< points, at most kChunkPoints
  float min_range_m = 0.0F;        ///< nearest z that is mapped
  float max_range_m = 0.0F;        ///< farthest
};

/// Where the points of a piece went.
struct PieceCounts {
  std::size_t mapped = 0;
  std::size_t no_return = 0;
  std::size_t out_of_range = 0;
  std::size_t invalid = 0;
};

/// Projected points as arrays. Behind the last point there is room for a vector, and before the first, too.
struct PointChunk {
  static constexpr std::size_t kPad = kMaxLanes;
  static constexpr std::size_t kRoom = kPad + kChunkPoints + kPad;
  static constexpr std::int32_t kNoCell = INT32_MIN;  ///< cell[0] of what is not mapped

  std::size_t size = 0;
  alignas(64) std::int32_t cell[3][kRoom] = {};  ///< the cell that each point lies in, from the sensor's
  alignas(64) float place_cells[3][kRoom] = {};  ///< from the lower corner of the sensor's cell, along the world's axes
  alignas(64) float variance_m2[3][kRoom] = {};  ///< along the sensor's axes
  alignas(64) std::int32_t target[kRoom] = {};   ///< who takes the point; kNoTarget: nobody
};

constexpr std::int32_t kNoTarget = -1;
constexpr std::int32_t kNoDivider = -1;

/// A virtual centre that may win points. For a point q its expected squared distance (Eq. 7), but for terms that all
/// candidates share, is bias + slope . q; q from the centre of the cell that the points lie in, all in cells.
struct Candidate {
  float slope[3];       ///< -2 c
  float bias;           ///< |c|^2 + S_s / n^2
  std::int32_t target;  ///< who takes the points that it wins
};

/// A plane as the points of one scan are compared with it: their squared distance over what their errors allow. As it
/// is made, a plane at the distance that is just allowed.
struct ScanPlane {
  float normal[3] = {};           ///< unit, along the world's axes
  float d_cells = 1.0F;           ///< offset from the lower corner of the sensor's cell
  float variance_factor[3] = {};  ///< from a point's variances along the sensor's axes, m2, to what they allow, cells2
  float allowed_cells2 = 1.0F;    ///< beside that
};

/// Two cells that share a place, and the planes by which their points are told apart.
struct Divider {
  std::int32_t target[2];
  ScanPlane plane[2];
};

/// Neighbouring points that lie in one cell.
struct Run {
  std::uint32_t begin = 0;  ///< in the chunk
  std::uint32_t end = 0;
  std::uint32_t first_candidate = 0;
  std::uint32_t candidate_count = 0;  ///< 0: the points lie in no cell
  float centre_cells[3] = {};         ///< of the cell, as PointChunk::place_cells
};

/// Sums over the points that a cell takes: q (3), q q^T (xx xy xz yy yz zz) with q from the cell's centre, in cells;
/// the variances along the sensor's axes (3), square metres.
struct Accumulator {
  float centre_cells[3] = {};  ///< of the cell, as PointChunk::place_cells
  std::uint32_t count = 0;     ///< points
  alignas(16) float sums[kSumCount] = {};
  std::int32_t divider = kNoDivider;  ///< by which its points are told from those of the other cell at its place
};

/// The kernels for one instruction set. All give the same to rounding.
struct Kernels {
  void (*project_depth)(const Projection&, const DepthPiece&, PointChunk& chunk, PieceCounts& counts);
  void (*project_cloud)(const Projection&, const CloudPiece&, PointChunk& chunk, PieceCounts& counts);
  /// Writes where in the chunk another cell begins, ascending, and the chunk's size behind them.
  /// @param begins  room for kChunkPoints + 1
  /// @return how many runs there are
  std::size_t (*find_runs)(const PointChunk& chunk, std::uint32_t* begins);
  /// Finds for each point the candidate with the smallest expected squared distance. The runs cover the chunk.
  void (*assign)(PointChunk& chunk, const Run* runs, std::size_t run_count, const Candidate* candidates);
  /// Gives the points that went to either cell of a divider to the one whose plane they are nearer to.
  void (*divide)(PointChunk& chunk, const Accumulator* accumulators, const Divider* dividers);
  /// Adds the points to those that take them.
  void (*accumulate)(const PointChunk& chunk, Accumulator* accumulators);
};

}  // namespace planemap::simd
