#include "surface_builder.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace planemap::simulation {
namespace {

/// Twice the area, along the normal about which the corners run counter-clockwise.
Eigen::Vector3d area_vector(const ConvexPiece& piece_m) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < piece_m.size(); ++i) {
    sum += (piece_m[i] - piece_m[0]).cross(piece_m[i + 1] - piece_m[0]);
  }
  return sum;
}

Eigen::Vector3d lifted(const Eigen::Vector2d& p_m, double height_m) {
  return {p_m.x(), p_m.y(), height_m};
}

}  // namespace

double area_m2(const ConvexPiece& piece_m) {
  return 0.5 * area_vector(piece_m).norm();
}

double area_m2(const Surface& surface) {
  double sum_m2 = 0.0;
  for (const ConvexPiece& piece_m : surface.pieces_m) sum_m2 += area_m2(piece_m);
  return sum_m2;
}

ConvexPiece level_piece(const Footprint& footprint, double height_m) {
  ConvexPiece piece_m;
  for (const Eigen::Vector2d& corner_m : footprint.corners_m()) piece_m.push_back(lifted(corner_m, height_m));
  return piece_m;
}

ConvexPiece upright_piece(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double bottom_m, double top_m) {
  return {lifted(from_m, bottom_m), lifted(to_m, bottom_m), lifted(to_m, top_m), lifted(from_m, top_m)};
}

void SurfaceBuilder::add(const std::string& name, PlaneClass plane_class, const Eigen::Vector3d& normal,
                         const std::vector<ConvexPiece>& pieces_m) {
  assert(!pieces_m.empty());
  Surface surface;
  surface.id = static_cast<SurfaceId>(surfaces_.size() + 1);
  surface.name = name;
  surface.plane_class = plane_class;
  const Eigen::Vector3d normal_world = (T_world_scene_.linear() * normal).normalized();
  for (ConvexPiece piece_m : pieces_m) {
    for (Eigen::Vector3d& corner_m : piece_m) corner_m = T_world_scene_ * corner_m;
    if (area_vector(piece_m).dot(normal_world) < 0.0) std::reverse(piece_m.begin(), piece_m.end());
    surface.pieces_m.push_back(std::move(piece_m));
  }
  surface.plane = Plane::through(surface.pieces_m.front().front(), normal_world);
  surfaces_.push_back(std::move(surface));
}

void SurfaceBuilder::add_box(const std::string& name, const Footprint& footprint, double bottom_m, double top_m,
                             const BoxFaces& faces, PlaneClass top_class) {
  const auto corners_m = footprint.corners_m();
  const auto side = [&](const char* which, const Eigen::Vector2d& normal, const Eigen::Vector2d& from_m,
                        const Eigen::Vector2d& to_m) {
    add(name + " " + which, PlaneClass::kWall, lifted(normal, 0.0), {upright_piece(from_m, to_m, bottom_m, top_m)});
  };
  if (faces.low_y) side("back", -footprint.axis(1), corners_m[0], corners_m[1]);
  if (faces.high_x) side("right side", footprint.axis(0), corners_m[1], corners_m[2]);
  if (faces.high_y) side("front", footprint.axis(1), corners_m[2], corners_m[3]);
  if (faces.low_x) side("left side", -footprint.axis(0), corners_m[3], corners_m[0]);
  if (faces.top) add(name + " top", top_class, Eigen::Vector3d::UnitZ(), {level_piece(footprint, top_m)});
}

void SurfaceBuilder::add_column(const std::string& name, const Eigen::Vector2d& centre_m, double radius_m,
                                double bottom_m, double top_m) {
  constexpr int kFacets = 36;
  const auto towards = [](double facet) {
    const double angle_rad = 2.0 * std::numbers::pi * facet / kFacets;
    return Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  };
  for (int i = 0; i < kFacets; ++i) {
    add(name + " facet " + std::to_string(i + 1), PlaneClass::kOther, lifted(towards(i + 0.5), 0.0),
        {upright_piece(centre_m + radius_m * towards(i), centre_m + radius_m * towards(i + 1), bottom_m, top_m)});
    surfaces_.back().facet = true;
  }
}

void SurfaceBuilder::add_table(const std::string& name, const Footprint& footprint, double top_m) {
  constexpr double kLegM = 0.05;  // thickness
  constexpr double kLegInsetM = 0.05;
  const double underside_m = top_m - kTableTopM;
  add_box(name, footprint, underside_m, top_m, {}, PlaneClass::kTable);
  const Eigen::Vector2d reach_m = footprint.half_size_m - Eigen::Vector2d::Constant(kLegInsetM + 0.5 * kLegM);
  for (int leg = 0; leg < 4; ++leg) {
    const Footprint foot{
        footprint.point_m(leg % 2 == 0 ? -reach_m.x() : reach_m.x(), leg / 2 == 0 ? -reach_m.y() : reach_m.y()),
        Eigen::Vector2d::Constant(0.5 * kLegM), footprint.direction};
    BoxFaces faces;
    faces.top = false;  // under the table's top
    add_box(name + " leg " + std::to_string(leg + 1), foot, 0.0, underside_m, faces, PlaneClass::kOther);
  }
}

}  // namespace planemap::simulation
