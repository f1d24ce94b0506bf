#include "seen_surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace planemap::accuracy {

namespace {

constexpr std::uint32_t kLeastHits = 2;  // a single pixel of a square is its corner

std::uint64_t key_of(std::int32_t i, std::int32_t j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32) | static_cast<std::uint32_t>(j);
}

std::uint64_t key_of(const Eigen::Vector2d& uv_m) {
  return key_of(static_cast<std::int32_t>(std::floor(uv_m.x() / SeenSurfaces::kPitch_m)),
                static_cast<std::int32_t>(std::floor(uv_m.y() / SeenSurfaces::kPitch_m)));
}

Eigen::Vector2i square_of(std::uint64_t key) {
  return {static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32)),
          static_cast<std::int32_t>(static_cast<std::uint32_t>(key))};
}

Eigen::Vector2d centre_of(std::uint64_t key) {
  return (square_of(key).cast<double>().array() + 0.5) * SeenSurfaces::kPitch_m;
}

}  // namespace

SeenSurfaces::SeenSurfaces(const std::vector<simulation::Surface>& surfaces, double max_range_m)
    : surfaces_(surfaces), max_range_m_(max_range_m), hits_(surfaces.size()), frames_(surfaces.size()) {
  for (const simulation::Surface& surface : surfaces_) {
    bases_.push_back(basis_of(surface.plane, surface.pieces_m.front().front()));
  }
}

void SeenSurfaces::add(const simulation::SimulatedSource& source, const DepthScan& scan) {
  const auto labels = source.label_image();
  const auto depths = source.true_depth_m();
  const PinholeIntrinsics& k = scan.intrinsics;
  const Eigen::Isometry3d& T_world_sensor = source.true_T_world_sensor();
  std::vector<bool> seen(surfaces_.size(), false);
  constexpr int kStep = 3;  // every ninth pixel: at 5 m they are 2.6 cm apart, closer than the raster
  for (int v = 0; v < k.height; v += kStep) {
    for (int u = 0; u < k.width; u += kStep) {
      const auto pixel = static_cast<std::size_t>(v * k.width + u);
      const simulation::SurfaceId label = labels[pixel];
      const double z = depths[pixel];
      if (label == simulation::kNoSurface || scan.depth[pixel] == kNoReturn || z > max_range_m_) continue;
      const Eigen::Vector3d p_sensor_m(z * (u - k.cx) / k.fx, z * (v - k.cy) / k.fy, z);
      const std::size_t surface = label - 1U;
      ++hits_[surface][key_of(bases_[surface].to_plane(T_world_sensor * p_sensor_m))];
      seen[surface] = true;
    }
  }
  for (std::size_t surface = 0; surface < seen.size(); ++surface) frames_[surface] += seen[surface] ? 1U : 0U;
}

std::vector<SeenSurfaces::Patch> SeenSurfaces::patches() const {
  std::vector<Patch> patches;
  for (std::size_t surface = 0; surface < surfaces_.size(); ++surface) {
    std::vector<std::uint64_t> keys;
    for (const auto& [key, hits] : hits_[surface]) {
      if (hits >= kLeastHits) keys.push_back(key);
    }
    std::sort(keys.begin(), keys.end());
    double area_m2 = kPitch_m * kPitch_m;
    if (surfaces_[surface].facet && !keys.empty()) {
      area_m2 = std::min(area_m2, simulation::area_m2(surfaces_[surface]) / static_cast<double>(keys.size()));
    }
    for (const std::uint64_t key : keys) {
      patches.push_back({surface, bases_[surface].to_world(centre_of(key)), area_m2});
    }
  }
  return patches;
}

std::vector<Eigen::Vector2i> SeenSurfaces::squares(std::size_t surface) const {
  std::vector<std::uint64_t> keys;
  for (const auto& [key, hits] : hits_[surface]) {
    if (hits >= kLeastHits) keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Eigen::Vector2i> squares;
  squares.reserve(keys.size());
  for (const std::uint64_t key : keys) squares.push_back(square_of(key));
  return squares;
}

double SeenSurfaces::seen_m2(std::size_t surface) const {
  return kPitch_m * kPitch_m * static_cast<double>(squares(surface).size());
}

bool SeenSurfaces::all_seen_about(std::size_t surface, const Eigen::Vector3d& p_world_m, double distance_m) const {
  const Eigen::Vector2d uv_m = bases_[surface].to_plane(p_world_m);
  const Eigen::Array2i first = ((uv_m.array() - distance_m) / kPitch_m).floor().cast<int>();
  const Eigen::Array2i last = ((uv_m.array() + distance_m) / kPitch_m).floor().cast<int>();
  for (int i = first.x(); i <= last.x(); ++i) {
    for (int j = first.y(); j <= last.y(); ++j) {
      const auto found = hits_[surface].find(key_of(i, j));
      if (found == hits_[surface].end() || found->second < kLeastHits) return false;
    }
  }
  return true;
}

}  // namespace planemap::accuracy
