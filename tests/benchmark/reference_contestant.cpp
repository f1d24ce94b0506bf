// The floor that planemap is measured against: one loop from depth to ten sums a cell, written by hand, in a geometric
// grid that is a hash of blocks. No uncertainty, no expected distances, no normals, no planes.
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "common/stopwatch.hpp"
#include "contestant.hpp"

namespace planemap::benchmark {

namespace {

struct Sums {
  float n = 0.0F;
  float x = 0.0F, y = 0.0F, z = 0.0F;
  float xx = 0.0F, xy = 0.0F, xz = 0.0F, yy = 0.0F, yz = 0.0F, zz = 0.0F;

  void add(float px, float py, float pz) {
    n += 1.0F;
    x += px;
    y += py;
    z += pz;
    xx += px * px;
    xy += px * py;
    xz += px * pz;
    yy += py * py;
    yz += py * pz;
    zz += pz * pz;
  }
  void add(const Sums& other) {
    n += other.n;
    x += other.x;
    y += other.y;
    z += other.z;
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
  }
};

struct Block {
  Sums cells[512];
};

/// floor() by conversion: std::floor is a call without SSE4.1.
inline int floor_to_int(float x) {
  const int i = static_cast<int>(x);
  return i - static_cast<int>(x < static_cast<float>(i));
}

class Reference final : public Contestant {
 public:
  Reference(const SensorConfig& sensor, double cell_size_m) : sensor_(sensor), per_m_(1.0 / cell_size_m) {}

  PartTimes take(const BenchFrame& frame) override {
    const auto& scan = std::get<DepthScan>(frame.scan);
    const Stopwatch whole;
    add(scan, frame.T_world_sensor);
    return {{"reference", whole.ms(), whole.own_ms()}};
  }

 private:
  void add(const DepthScan& scan, const Eigen::Isometry3d& T_world_sensor);
  Sums& cell(int x, int y, int z);

  SensorConfig sensor_;
  double per_m_;
  std::vector<float> ray_x_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;
  std::uint64_t last_key_ = ~std::uint64_t{0};
  Block* last_ = nullptr;
};

Sums& Reference::cell(int x, int y, int z) {
  constexpr std::uint64_t kMask = (1U << 21) - 1;
  const std::uint64_t key = (static_cast<std::uint64_t>(x >> 3) & kMask) |
                            (static_cast<std::uint64_t>(y >> 3) & kMask) << 21 |
                            (static_cast<std::uint64_t>(z >> 3) & kMask) << 42;
  if (key != last_key_) {
    auto& found = blocks_[key];
    if (!found) found = std::make_unique<Block>();
    last_ = found.get();
    last_key_ = key;
  }
  return last_->cells[(x & 7) | (y & 7) << 3 | (z & 7) << 6];
}

void Reference::add(const DepthScan& scan, const Eigen::Isometry3d& T_world_sensor) {
  const PinholeIntrinsics& k = scan.intrinsics;
  ray_x_.resize(static_cast<std::size_t>(k.width));
  for (int u = 0; u < k.width; ++u) ray_x_[static_cast<std::size_t>(u)] = static_cast<float>((u - k.cx) / k.fx);
  // In cells, from the world's origin.
  const Eigen::Matrix3f R = (T_world_sensor.linear() * per_m_).cast<float>();
  const Eigen::Vector3f origin = (T_world_sensor.translation() * per_m_).cast<float>();
  const auto scale_m = static_cast<float>(scan.depth_scale_m);
  const auto near_m = static_cast<float>(sensor_.min_range_m);
  const auto far_m = static_cast<float>(sensor_.max_range_m);
  const std::uint16_t* depth = scan.depth.data();
  Sums run;  // of neighbours that lie in one cell
  int run_x = 0, run_y = 0, run_z = 0;
  for (int v = 0; v < k.height; ++v) {
    const Eigen::Vector3f row = R.col(1) * static_cast<float>((v - k.cy) / k.fy) + R.col(2);
    for (int u = 0; u < k.width; ++u, ++depth) {
      const float z_m = static_cast<float>(*depth) * scale_m;
      if (*depth == kNoReturnHigh || z_m < near_m || z_m > far_m) continue;
      const float ray = ray_x_[static_cast<std::size_t>(u)];
      const float px = origin.x() + z_m * (R(0, 0) * ray + row.x());
      const float py = origin.y() + z_m * (R(1, 0) * ray + row.y());
      const float pz = origin.z() + z_m * (R(2, 0) * ray + row.z());
      const int x = floor_to_int(px), y = floor_to_int(py), z = floor_to_int(pz);
      if (((x ^ run_x) | (y ^ run_y) | (z ^ run_z)) != 0) {
        if (run.n > 0.0F) cell(run_x, run_y, run_z).add(run);
        run = Sums{};
        run_x = x;
        run_y = y;
        run_z = z;
      }
      run.add(px - static_cast<float>(x), py - static_cast<float>(y), pz - static_cast<float>(z));
    }
  }
  if (run.n > 0.0F) cell(run_x, run_y, run_z).add(run);
}

}  // namespace

std::unique_ptr<Contestant> make_reference(const SensorConfig& sensor, double cell_size_m) {
  return std::make_unique<Reference>(sensor, cell_size_m);
}

}  // namespace planemap::benchmark
