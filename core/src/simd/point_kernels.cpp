// SVE is left out: its vectors don't go into structs.
#define HWY_DISABLED_TARGETS (HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/point_kernels.cpp"  // read again by foreach_target.h, once for each instruction set
#include "simd/point_kernels.hpp"

#include <hwy/foreach_target.h>  // IWYU: first of Highway
#include <hwy/highway.h>

#include "simd/select_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace planemap::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kMaxLanes>;
using IntTag = hn::RebindToSigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Mask = hn::Mask<FloatTag>;
constexpr FloatTag kFloat;
constexpr IntTag kInt;

HWY_INLINE Floats set(float value) {
  return hn::Set(kFloat, value);
}

/// Stores points that are given in cells; those that are not valid get no cell.
HWY_INLINE void store(Floats sx, Floats sy, Floats sz, Mask valid, std::size_t at, PointChunk& chunk) {
  const Floats places[3] = {hn::IfThenElseZero(valid, sx), hn::IfThenElseZero(valid, sy),
                            hn::IfThenElseZero(valid, sz)};
  for (int w = 0; w < 3; ++w) {
    auto index = hn::ConvertTo(kInt, hn::Floor(places[w]));
    if (w == 0) index = hn::IfThenElse(hn::RebindMask(kInt, valid), index, hn::Set(kInt, PointChunk::kNoCell));
    hn::Store(index, kInt, chunk.cell[w] + PointChunk::kPad + at);
    hn::Store(places[w], kFloat, chunk.place_cells[w] + PointChunk::kPad + at);
  }
}

HWY_INLINE void store_variances(Floats x, Floats y, Floats z, std::size_t at, PointChunk& chunk) {
  hn::Store(x, kFloat, chunk.variance_m2[0] + PointChunk::kPad + at);
  hn::Store(y, kFloat, chunk.variance_m2[1] + PointChunk::kPad + at);
  hn::Store(z, kFloat, chunk.variance_m2[2] + PointChunk::kPad + at);
}

HWY_INLINE Mask within(Floats sx, Floats sy, Floats sz, float limit) {
  const Floats most = set(limit);  // one by one: a maximum may hide what is not a number
  return hn::And(hn::Lt(hn::Abs(sx), most), hn::And(hn::Lt(hn::Abs(sy), most), hn::Lt(hn::Abs(sz), most)));
}

/// One vector of pixels. @return masks of (mapped, no return) among them
HWY_INLINE void project_pixels(const Projection& p, const DepthPiece& piece, const Floats row[3], std::size_t at,
                               const std::uint16_t* depth, const float* ray_x, PointChunk& chunk, Mask& mapped,
                               Mask& none) {
  const hn::Rebind<std::uint16_t, FloatTag> words;
  const auto raw = hn::PromoteTo(kInt, hn::LoadU(words, depth));
  const auto no_return = hn::Or(hn::Eq(raw, hn::Zero(kInt)), hn::Eq(raw, hn::Set(kInt, 65535)));
  const auto too_near = hn::Lt(raw, hn::Set(kInt, piece.nearest));
  const auto too_far = hn::Gt(raw, hn::Set(kInt, piece.farthest));
  none = hn::RebindMask(kFloat, no_return);
  const Mask left_out = hn::RebindMask(kFloat, hn::Or(no_return, hn::Or(too_near, too_far)));

  const Floats z = hn::Mul(hn::ConvertTo(kFloat, raw), set(piece.depth_scale_m));
  const Floats x = hn::LoadU(kFloat, ray_x);
  const Floats sx = hn::MulAdd(z, hn::MulAdd(x, set(p.axis_cells[0][0]), row[0]), set(p.origin_cells[0]));
  const Floats sy = hn::MulAdd(z, hn::MulAdd(x, set(p.axis_cells[0][1]), row[1]), set(p.origin_cells[1]));
  const Floats sz = hn::MulAdd(z, hn::MulAdd(x, set(p.axis_cells[0][2]), row[2]), set(p.origin_cells[2]));
  mapped = hn::AndNot(left_out, within(sx, sy, sz, p.limit_cells));
  store(sx, sy, sz, mapped, at, chunk);

  const Floats z2 = hn::Mul(z, z);
  const Floats variance = hn::Mul(set(p.depth_factor2), hn::Mul(z2, z2));
  const Floats floor = hn::Mul(set(p.lateral_factor2), z2);
  store_variances(hn::Max(hn::Mul(hn::Mul(x, x), variance), floor),
                  hn::Max(hn::Mul(set(piece.ray_y * piece.ray_y), variance), floor), variance, at, chunk);
}

void project_depth(const Projection& p, const DepthPiece& piece, PointChunk& chunk, PieceCounts& counts) {
  const std::size_t lanes = hn::Lanes(kFloat);
  Floats row[3];
  for (int w = 0; w < 3; ++w) row[w] = set(p.axis_cells[1][w] * piece.ray_y + p.axis_cells[2][w]);
  std::size_t mapped_count = 0;
  std::size_t none_count = 0;
  std::size_t at = 0;
  Mask mapped;
  Mask none;
  for (; at + lanes <= piece.size; at += lanes) {
    project_pixels(p, piece, row, at, piece.depth + at, piece.ray_x + at, chunk, mapped, none);
    mapped_count += hn::CountTrue(kFloat, mapped);
    none_count += hn::CountTrue(kFloat, none);
  }
  if (at < piece.size) {
    std::uint16_t depth[kMaxLanes] = {};
    float ray_x[kMaxLanes] = {};
    for (std::size_t i = 0; at + i < piece.size; ++i) {
      depth[i] = piece.depth[at + i];
      ray_x[i] = piece.ray_x[at + i];
    }
    project_pixels(p, piece, row, at, depth, ray_x, chunk, mapped, none);
    mapped_count += hn::CountTrue(kFloat, mapped);
    none_count += hn::CountTrue(kFloat, hn::And(none, hn::FirstN(kFloat, piece.size - at)));
  }
  chunk.size = piece.size;
  counts.mapped += mapped_count;
  counts.no_return += none_count;
  counts.out_of_range += piece.size - mapped_count - none_count;
}

HWY_INLINE Mask are_finite(Floats x, Floats y, Floats z) {
  const Floats greatest = set(3.402823466e38F);
  return hn::And(hn::Le(hn::Abs(x), greatest), hn::And(hn::Le(hn::Abs(y), greatest), hn::Le(hn::Abs(z), greatest)));
}

/// One vector of points; `here` masks those that exist.
HWY_INLINE void project_vector(const Projection& p, const CloudPiece& piece, const float* xyz_m, const float* sigma_m,
                               Mask here, std::size_t at, PointChunk& chunk, PieceCounts& counts) {
  Floats x;
  Floats y;
  Floats z;
  hn::LoadInterleaved3(kFloat, xyz_m, x, y, z);
  const Mask seen = hn::And(here, are_finite(x, y, z));
  const Mask in_range = hn::And(seen, hn::And(hn::Ge(z, set(piece.min_range_m)), hn::Le(z, set(piece.max_range_m))));
  Mask good = in_range;
  if (sigma_m != nullptr) {
    Floats ex;
    Floats ey;
    Floats ez;
    hn::LoadInterleaved3(kFloat, sigma_m, ex, ey, ez);
    const Mask not_negative =
        hn::And(hn::Ge(ex, hn::Zero(kFloat)), hn::And(hn::Ge(ey, hn::Zero(kFloat)), hn::Ge(ez, hn::Zero(kFloat))));
    good = hn::And(in_range, hn::And(are_finite(ex, ey, ez), not_negative));
    store_variances(hn::Mul(ex, ex), hn::Mul(ey, ey), hn::Mul(ez, ez), at, chunk);
  } else {
    const Floats z2 = hn::Mul(z, z);
    const Floats scale = hn::Mul(set(p.depth_factor2), z2);  // (offset / z sigma_z)^2 = offset^2 scale
    const Floats floor = hn::Mul(set(p.lateral_factor2), z2);
    store_variances(hn::Max(hn::Mul(hn::Mul(x, x), scale), floor), hn::Max(hn::Mul(hn::Mul(y, y), scale), floor),
                    hn::Mul(z2, scale), at, chunk);
  }
  Floats s[3];
  for (int w = 0; w < 3; ++w) {
    s[w] = hn::MulAdd(
        x, set(p.axis_cells[0][w]),
        hn::MulAdd(y, set(p.axis_cells[1][w]), hn::MulAdd(z, set(p.axis_cells[2][w]), set(p.origin_cells[w]))));
  }
  const Mask mapped = hn::And(good, within(s[0], s[1], s[2], p.limit_cells));
  store(s[0], s[1], s[2], mapped, at, chunk);
  const std::size_t good_count = hn::CountTrue(kFloat, good);
  const std::size_t mapped_count = hn::CountTrue(kFloat, mapped);
  const std::size_t in_range_count = hn::CountTrue(kFloat, in_range);
  const std::size_t seen_count = hn::CountTrue(kFloat, seen);
  counts.mapped += mapped_count;
  counts.invalid += in_range_count - good_count;
  counts.out_of_range += seen_count - in_range_count + good_count - mapped_count;
  counts.no_return += hn::CountTrue(kFloat, here) - seen_count;
}

void project_cloud(const Projection& p, const CloudPiece& piece, PointChunk& chunk, PieceCounts& counts) {
  const std::size_t lanes = hn::Lanes(kFloat);
  std::size_t at = 0;
  for (; at + lanes <= piece.size; at += lanes) {
    const float* sigma_m = piece.sigma_m == nullptr ? nullptr : piece.sigma_m + 3 * at;
    project_vector(p, piece, piece.xyz_m + 3 * at, sigma_m, hn::FirstN(kFloat, lanes), at, chunk, counts);
  }
  if (at < piece.size) {
    float xyz_m[3 * kMaxLanes] = {};
    float sigma_m[3 * kMaxLanes] = {};
    for (std::size_t i = 3 * at; i < 3 * piece.size; ++i) {
      xyz_m[i - 3 * at] = piece.xyz_m[i];
      if (piece.sigma_m != nullptr) sigma_m[i - 3 * at] = piece.sigma_m[i];
    }
    project_vector(p, piece, xyz_m, piece.sigma_m == nullptr ? nullptr : sigma_m, hn::FirstN(kFloat, piece.size - at),
                   at, chunk, counts);
  }
  chunk.size = piece.size;
}

/// Masks the places where a value differs from the one before it.
HWY_INLINE hn::Mask<IntTag> changes(const std::int32_t* values) {
  return hn::Ne(hn::Load(kInt, values), hn::LoadU(kInt, values - 1));
}

/// Appends the places of the masked ones, but for the chunk's first and what is behind it.
HWY_INLINE std::size_t append(hn::Mask<IntTag> mask, std::size_t at, std::size_t size, std::uint32_t* begins,
                              std::size_t count) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kInt, mask, bytes);
  for (unsigned bits = bytes[0] | unsigned{bytes[1]} << 8U; bits != 0; bits &= bits - 1) {
    const std::size_t begin = at + hwy::Num0BitsBelowLS1Bit_Nonzero32(bits);
    if (begin > 0 && begin < size) begins[count++] = static_cast<std::uint32_t>(begin);
  }
  return count;
}

std::size_t find_runs(const PointChunk& chunk, std::uint32_t* begins) {
  const std::size_t lanes = hn::Lanes(kFloat);
  std::size_t count = 0;
  if (chunk.size > 0) begins[count++] = 0;
  for (std::size_t at = 0; at < chunk.size; at += lanes) {
    const std::size_t i = PointChunk::kPad + at;
    const auto differs =
        hn::Or(changes(chunk.cell[0] + i), hn::Or(changes(chunk.cell[1] + i), changes(chunk.cell[2] + i)));
    count = append(differs, at, chunk.size, begins, count);
  }
  begins[count] = static_cast<std::uint32_t>(chunk.size);
  return count;
}

/// Eq. 7 for a vector of points and all candidates of the cell they lie in.
HWY_INLINE hn::Vec<IntTag> winners(Floats x, Floats y, Floats z, const Candidate* candidates, std::uint32_t count) {
  Floats least = hn::Inf(kFloat);
  auto target = hn::Set(kInt, candidates->target);
  for (const Candidate* c = candidates; c != candidates + count; ++c) {
    const Floats distance =
        hn::MulAdd(x, set(c->slope[0]), hn::MulAdd(y, set(c->slope[1]), hn::MulAdd(z, set(c->slope[2]), set(c->bias))));
    const Mask nearer = hn::Lt(distance, least);
    target = hn::IfThenElse(hn::RebindMask(kInt, nearer), hn::Set(kInt, c->target), target);
    least = hn::Min(distance, least);
  }
  return target;
}

void assign(PointChunk& chunk, const Run* runs, std::size_t run_count, const Candidate* candidates) {
  const std::size_t lanes = hn::Lanes(kFloat);
  // Ascending, and the last vector of a run may reach into the next one, which then writes its own.
  for (const Run* run = runs; run != runs + run_count; ++run) {
    const Candidate* own = candidates + run->first_candidate;
    const auto only = hn::Set(kInt, run->candidate_count == 0 ? kNoTarget : own->target);
    for (std::size_t at = PointChunk::kPad + run->begin; at < PointChunk::kPad + run->end; at += lanes) {
      auto target = only;
      if (run->candidate_count > 1) {
        target = winners(hn::Sub(hn::LoadU(kFloat, chunk.place_cells[0] + at), set(run->centre_cells[0])),
                         hn::Sub(hn::LoadU(kFloat, chunk.place_cells[1] + at), set(run->centre_cells[1])),
                         hn::Sub(hn::LoadU(kFloat, chunk.place_cells[2] + at), set(run->centre_cells[2])), own,
                         run->candidate_count);
      }
      hn::StoreU(target, kInt, chunk.target + at);
    }
  }
}

/// Squared distances of a vector of points to a plane, and what is allowed of them.
HWY_INLINE void compare(const ScanPlane& plane, const PointChunk& chunk, std::size_t at, Floats& distance2,
                        Floats& allowed) {
  Floats distance = set(plane.d_cells);
  allowed = set(plane.allowed_cells2);
  for (int k = 0; k < 3; ++k) {
    distance = hn::MulAdd(set(plane.normal[k]), hn::LoadU(kFloat, chunk.place_cells[k] + at), distance);
    allowed = hn::MulAdd(set(plane.variance_factor[k]), hn::LoadU(kFloat, chunk.variance_m2[k] + at), allowed);
  }
  distance2 = hn::Mul(distance, distance);
}

/// Finds where in the chunk other targets begin. @param begins  as find_runs()
HWY_INLINE std::size_t find_target_runs(const PointChunk& chunk, std::uint32_t* begins) {
  const std::size_t lanes = hn::Lanes(kFloat);
  std::size_t count = 0;
  if (chunk.size > 0) begins[count++] = 0;
  for (std::size_t at = 0; at < chunk.size; at += lanes) {
    count = append(changes(chunk.target + PointChunk::kPad + at), at, chunk.size, begins, count);
  }
  begins[count] = static_cast<std::uint32_t>(chunk.size);
  return count;
}

void divide(PointChunk& chunk, const Accumulator* accumulators, const Divider* dividers) {
  const std::size_t lanes = hn::Lanes(kFloat);
  std::uint32_t begins[kChunkPoints + 1];
  const std::size_t count = find_target_runs(chunk, begins);
  for (std::size_t i = 0; i < count; ++i) {
    // A vector before may have reached into this run: what it made of a point is what this one makes of it.
    const std::int32_t winner = chunk.target[PointChunk::kPad + begins[i]];
    if (winner == kNoTarget || accumulators[winner].divider == kNoDivider) continue;
    const Divider& divider = dividers[accumulators[winner].divider];
    const auto first = hn::Set(kInt, divider.target[0]);
    const auto second = hn::Set(kInt, divider.target[1]);
    for (std::size_t at = PointChunk::kPad + begins[i]; at < PointChunk::kPad + begins[i + 1]; at += lanes) {
      const auto target = hn::LoadU(kInt, chunk.target + at);
      const auto mine = hn::Or(hn::Eq(target, first), hn::Eq(target, second));
      Floats distance2[2];
      Floats allowed[2];
      for (int side = 0; side < 2; ++side) compare(divider.plane[side], chunk, at, distance2[side], allowed[side]);
      const Mask on_second = hn::Lt(hn::Mul(distance2[1], allowed[0]), hn::Mul(distance2[0], allowed[1]));
      const auto owner = hn::IfThenElse(hn::RebindMask(kInt, on_second), second, first);
      hn::StoreU(hn::IfThenElse(mine, owner, target), kInt, chunk.target + at);
    }
  }
}

/// A vector of points.
struct Points {
  Floats x, y, z, ex, ey, ez;
};

HWY_INLINE Points load(const PointChunk& chunk, std::size_t at, const float centre_cells[3]) {
  return {hn::Sub(hn::LoadU(kFloat, chunk.place_cells[0] + at), set(centre_cells[0])),
          hn::Sub(hn::LoadU(kFloat, chunk.place_cells[1] + at), set(centre_cells[1])),
          hn::Sub(hn::LoadU(kFloat, chunk.place_cells[2] + at), set(centre_cells[2])),
          hn::LoadU(kFloat, chunk.variance_m2[0] + at),
          hn::LoadU(kFloat, chunk.variance_m2[1] + at),
          hn::LoadU(kFloat, chunk.variance_m2[2] + at)};
}

HWY_INLINE Points masked(const Points& p, Mask mask) {
  return {hn::IfThenElseZero(mask, p.x),  hn::IfThenElseZero(mask, p.y),  hn::IfThenElseZero(mask, p.z),
          hn::IfThenElseZero(mask, p.ex), hn::IfThenElseZero(mask, p.ey), hn::IfThenElseZero(mask, p.ez)};
}

/// The sums of an Accumulator in registers.
struct Sums {
  Floats s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11;

  static HWY_INLINE Sums of(const Points& p) {
    return {p.x,
            p.y,
            p.z,
            hn::Mul(p.x, p.x),
            hn::Mul(p.x, p.y),
            hn::Mul(p.x, p.z),
            hn::Mul(p.y, p.y),
            hn::Mul(p.y, p.z),
            hn::Mul(p.z, p.z),
            p.ex,
            p.ey,
            p.ez};
  }
  HWY_INLINE void add(const Points& p) {
    s0 = hn::Add(s0, p.x);
    s1 = hn::Add(s1, p.y);
    s2 = hn::Add(s2, p.z);
    s3 = hn::MulAdd(p.x, p.x, s3);
    s4 = hn::MulAdd(p.x, p.y, s4);
    s5 = hn::MulAdd(p.x, p.z, s5);
    s6 = hn::MulAdd(p.y, p.y, s6);
    s7 = hn::MulAdd(p.y, p.z, s7);
    s8 = hn::MulAdd(p.z, p.z, s8);
    s9 = hn::Add(s9, p.ex);
    s10 = hn::Add(s10, p.ey);
    s11 = hn::Add(s11, p.ez);
  }
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void add_to(float* sums, Floats a, Floats b, Floats c, Floats d) {
  const Floats each[4] = {a, b, c, d};
  for (int i = 0; i < 4; ++i) sums[i] += hn::GetLane(each[i]);
}
#else
/// Sums of four vectors' lanes, block by block of four: (a b c d) of each.
HWY_INLINE Floats sums_of_blocks(Floats a, Floats b, Floats c, Floats d) {
  const hn::RepartitionToWide<FloatTag> pair;
  const auto ab = hn::BitCast(pair, hn::Add(hn::InterleaveLower(kFloat, a, b), hn::InterleaveUpper(kFloat, a, b)));
  const auto cd = hn::BitCast(pair, hn::Add(hn::InterleaveLower(kFloat, c, d), hn::InterleaveUpper(kFloat, c, d)));
  return hn::Add(hn::BitCast(kFloat, hn::InterleaveLower(pair, ab, cd)),
                 hn::BitCast(kFloat, hn::InterleaveUpper(pair, ab, cd)));
}

/// Adds the sums of four vectors' lanes to four floats.
HWY_INLINE void add_to(float* sums, Floats a, Floats b, Floats c, Floats d) {
  const hn::Full128<float> four;
  const Floats blocks = sums_of_blocks(a, b, c, d);
#if HWY_MAX_BYTES >= 64
  const hn::Half<FloatTag> eight;
  const auto halves = hn::Add(hn::LowerHalf(eight, blocks), hn::UpperHalf(eight, blocks));
  const auto sum = hn::Add(hn::LowerHalf(four, halves), hn::UpperHalf(four, halves));
#elif HWY_MAX_BYTES >= 32
  const auto sum = hn::Add(hn::LowerHalf(four, blocks), hn::UpperHalf(four, blocks));
#else
  const auto sum = blocks;
#endif
  hn::Store(hn::Add(sum, hn::Load(four, sums)), four, sums);
}
#endif

HWY_INLINE void flush(const Sums& s, std::size_t n, Accumulator& accumulator) {
  accumulator.count += static_cast<std::uint32_t>(n);
  add_to(accumulator.sums, s.s0, s.s1, s.s2, s.s3);
  add_to(accumulator.sums + 4, s.s4, s.s5, s.s6, s.s7);
  add_to(accumulator.sums + 8, s.s8, s.s9, s.s10, s.s11);
}

void accumulate(const PointChunk& chunk, Accumulator* accumulators) {
  const std::size_t lanes = hn::Lanes(kFloat);
  std::uint32_t begins[kChunkPoints + 1];
  const std::size_t count = find_target_runs(chunk, begins);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t at = PointChunk::kPad + begins[i];
    const std::size_t end = PointChunk::kPad + begins[i + 1];
    if (chunk.target[at] == kNoTarget) continue;
    Accumulator& accumulator = accumulators[chunk.target[at]];
    const std::size_t n = end - at;
    Sums sums = Sums::of(masked(load(chunk, at, accumulator.centre_cells), hn::FirstN(kFloat, n)));
    for (at += lanes; at < end; at += lanes) {
      sums.add(masked(load(chunk, at, accumulator.centre_cells), hn::FirstN(kFloat, end - at)));
    }
    flush(sums, n, accumulator);
  }
}

const Kernels* target_kernels() {
  static const Kernels kKernels = {project_depth, project_cloud, find_runs, assign, divide, accumulate};
  return &kKernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace planemap::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <array>
#include <cstddef>
#include <stdexcept>

namespace planemap::simd {
namespace {

HWY_EXPORT(target_kernels);

std::int64_t highway_target(SimdTarget target) {
  constexpr std::int64_t kPlain = HWY_TARGETS & (HWY_EMU128 | HWY_SCALAR);
  switch (target) {
    case SimdTarget::kAuto:
      return HWY_TARGETS;
    case SimdTarget::kAvx2:
      return HWY_TARGETS & HWY_AVX2;
    case SimdTarget::kAvx512:
      return HWY_TARGETS & HWY_AVX3;
    case SimdTarget::kSse4:
      return HWY_TARGETS & HWY_SSE4;
    case SimdTarget::kNeon:
      return HWY_TARGETS & HWY_NEON;
    case SimdTarget::kScalar:
      return kPlain;
  }
  return 0;
}

/// By SimdTarget; nullptr: not supported. Nothing else in the process asks Highway to choose.
std::array<const Kernels*, 6> all_kernels() {
  std::array<const Kernels*, 6> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::int64_t target = highway_target(static_cast<SimdTarget>(i)) & hwy::SupportedTargets();
    if (target == 0) continue;
    hwy::GetChosenTarget().Update(target);
    table[i] = HWY_DYNAMIC_DISPATCH(target_kernels)();
  }
  return table;
}

const Kernels* find_kernels(SimdTarget target) {
  static const std::array<const Kernels*, 6> kTable = all_kernels();
  return kTable[static_cast<std::size_t>(target)];
}

}  // namespace

const Kernels& kernels(SimdTarget target) {
  const Kernels* found = find_kernels(target);
  if (found == nullptr) throw std::invalid_argument("core.simd: this machine does not have that instruction set");
  return *found;
}

}  // namespace planemap::simd

namespace planemap {

bool is_supported(SimdTarget target) {
  return simd::find_kernels(target) != nullptr;
}

}  // namespace planemap
#endif
