#include "plane_table.hpp"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace planemap::cli {

double offset_sigma_m(const PlaneRecord& plane) {
  // n . c + d for small errors of n and d.
  const Eigen::Vector4d gradient(plane.centroid_m.x(), plane.centroid_m.y(), plane.centroid_m.z(), 1.0);
  return std::sqrt(std::max(0.0, gradient.dot(plane.covariance * gradient)));
}

double normal_sigma_rad(const PlaneRecord& plane) {
  const Eigen::Matrix3d covariance = plane.covariance.topLeftCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().z()));
}

std::string plane_table(const ExportMap& map) {
  std::vector<const ExportPlane*> planes;
  planes.reserve(map.planes.size());
  for (const ExportPlane& plane : map.planes) planes.push_back(&plane);
  std::stable_sort(planes.begin(), planes.end(),
                   [](const ExportPlane* a, const ExportPlane* b) { return a->outline.area_m2 > b->outline.area_m2; });
  std::string text = fmt::format("{:>6}  {:<8}{:>7}{:>12}{:>10}   {:^24}{:>8}  {:>9}{:>10}  {}\n", "plane", "class",
                                 "cells", "points", "area m2", "normal", "+- deg", "d m", "+- mm", "coplanar");
  for (const ExportPlane* plane : planes) {
    const PlaneRecord& record = plane->record;
    const Eigen::Vector3d& n = record.plane.normal();
    text += fmt::format(
        "{:>6}  {:<8}{:>7}{:>12}{:>10.3f}   {:>8.4f}{:>8.4f}{:>8.4f}{:>8.3f}  {:>9.4f}{:>10.2f}  {}\n", record.id,
        name_of(plane->plane_class), record.cell_count, record.point_count, plane->outline.area_m2, n.x(), n.y(), n.z(),
        normal_sigma_rad(record) * 180.0 / std::numbers::pi, record.plane.d(), offset_sigma_m(record) * 1000.0,
        plane->coplanar.empty() ? "-" : fmt::format("{}", fmt::join(plane->coplanar, " ")));
  }
  return text;
}

}  // namespace planemap::cli
