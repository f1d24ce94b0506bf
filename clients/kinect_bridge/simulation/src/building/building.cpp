#include "building.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace planemap::simulation {
namespace {

constexpr double kMoveM = 1.0;  // the camera may go so far before the pieces around it are chosen anew
constexpr SurfaceId kFloorId = 1;
constexpr SurfaceId kCeilingId = 2;
constexpr SurfaceId kIdsAWing = 8192;  // names of a wing's surfaces, and of its pieces

SurfaceId first_name(std::size_t wing) {
  return static_cast<SurfaceId>((wing + 1) * kIdsAWing);
}

/// Whether a piece has a point within a ball: by its bounding box.
bool is_near(const ConvexPiece& piece_m, const Eigen::Vector3d& p_m, double radius_m) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner_m : piece_m) box.extend(corner_m);
  return box.squaredExteriorDistance(p_m) <= radius_m * radius_m;
}

}  // namespace

Building::Building(std::uint64_t seed, double sight_m)
    : seed_(seed), sight_m_(sight_m), T_world_building_(make_wing(seed, 0).apartment.T_world_apartment), walk_(seed) {}

Eigen::Isometry3d Building::T_world_sensor(double time_s) {
  return T_world_building_ * walk_.T_scene_sensor(time_s);
}

Building::Part Building::make_part(std::size_t number) const {
  Part part;
  part.surfaces = make_surfaces(make_wing(seed_, number).apartment);
  if (part.surfaces.size() >= kIdsAWing) throw std::runtime_error("Building: a wing has too many surfaces");
  for (Surface& surface : part.surfaces) {
    if (surface.name == "floor" || surface.name == "ceiling") {
      surface.id = surface.name == "floor" ? kFloorId : kCeilingId;
    } else {
      surface.id = first_name(number) + surface.id;
      surface.name = "wing " + std::to_string(number + 1) + " " + surface.name;
    }
    const auto index = static_cast<std::uint32_t>(&surface - part.surfaces.data());
    for (std::uint32_t piece = 0; piece < surface.pieces_m.size(); ++piece) part.pieces.emplace_back(index, piece);
  }
  if (part.pieces.size() >= kIdsAWing) throw std::runtime_error("Building: a wing has too many pieces of surfaces");
  return part;
}

const Building::Part& Building::part(std::size_t number) {
  const auto found = parts_.find(number);
  if (found != parts_.end()) return found->second;
  return parts_.emplace(number, make_part(number)).first->second;
}

std::optional<std::vector<Surface>> Building::look_from(const Eigen::Vector3d& p_world_m) {
  if (looked_from_m_ && (p_world_m - *looked_from_m_).norm() < kMoveM) return std::nullopt;
  looked_from_m_ = p_world_m;
  const double radius_m = sight_m_ + kMoveM;
  const double y_m = (T_world_building_.inverse() * p_world_m).y();
  const auto wing_at = [](double at_m) {
    return static_cast<std::size_t>(std::max(0.0, std::floor(at_m / kWingPitchM)));
  };
  const std::size_t first = wing_at(y_m - radius_m);
  const std::size_t last = wing_at(y_m + radius_m);
  std::erase_if(parts_, [&](const auto& entry) { return entry.first < first || entry.first > last; });
  std::vector<Surface> near;
  for (std::size_t number = first; number <= last; ++number) {
    const Part& wing = part(number);
    for (std::size_t i = 0; i < wing.pieces.size(); ++i) {
      const Surface& surface = wing.surfaces[wing.pieces[i].first];
      const ConvexPiece& piece_m = surface.pieces_m[wing.pieces[i].second];
      if (!is_near(piece_m, p_world_m, radius_m)) continue;
      near.push_back({first_name(number) + static_cast<SurfaceId>(i),
                      surface.name,
                      surface.plane,
                      surface.plane_class,
                      surface.facet,
                      {piece_m}});
    }
  }
  return near;
}

void Building::name(std::span<SurfaceId> labels) {
  SurfaceId last_piece = kNoSurface;
  SurfaceId last_surface = kNoSurface;
  for (SurfaceId& label : labels) {
    if (label == kNoSurface) continue;
    if (label != last_piece) {
      const std::size_t number = label / kIdsAWing - 1;
      const std::size_t piece = label % kIdsAWing;
      const Part& wing = parts_.at(number);
      if (seen_.size() <= number) seen_.resize(number + 1);
      seen_[number].resize(wing.pieces.size());
      seen_[number][piece] = true;
      last_piece = label;
      last_surface = wing.surfaces[wing.pieces[piece].first].id;
    }
    label = last_surface;
  }
}

std::vector<Surface> Building::seen() const {
  std::map<SurfaceId, Surface> by_id;
  for (std::size_t number = 0; number < seen_.size(); ++number) {
    if (seen_[number].empty()) continue;
    const Part wing = make_part(number);
    for (std::size_t i = 0; i < wing.pieces.size(); ++i) {
      if (!seen_[number][i]) continue;
      const Surface& whole = wing.surfaces[wing.pieces[i].first];
      auto [at, is_new] = by_id.try_emplace(whole.id, whole);
      if (is_new) at->second.pieces_m.clear();
      at->second.pieces_m.push_back(whole.pieces_m[wing.pieces[i].second]);
    }
  }
  std::vector<Surface> surfaces;
  surfaces.reserve(by_id.size());
  for (auto& entry : by_id) surfaces.push_back(std::move(entry.second));
  return surfaces;
}

}  // namespace planemap::simulation
