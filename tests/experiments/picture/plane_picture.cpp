#include "picture/plane_picture.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace planemap::experiments {

using namespace plot;

namespace {

std::vector<Eigen::Vector3d> corners_of_face(const PictureFace& face) {
  std::vector<Eigen::Vector3d> corners;
  for (const Polygon& polygon : face.outline.polygons) {
    for (const Eigen::Vector2d& uv_m : polygon.outer) corners.push_back(face.outline.basis.to_world(uv_m));
  }
  return corners;
}

/// Share of the corners that are in front of a plane.
double share_in_front(const std::vector<Eigen::Vector3d>& corners, const Plane& plane) {
  const auto count =
      std::count_if(corners.begin(), corners.end(), [&](const auto& p) { return plane.signed_distance_m(p) > 0.0; });
  return static_cast<double>(count) / static_cast<double>(corners.size());
}

/// A face on the page.
struct Drawn {
  std::size_t face = 0;
  std::vector<Eigen::Vector3d> corners;
  Eigen::AlignedBox2d extent;
  double nearness = 0.0;
  std::vector<std::size_t> behind;  ///< places of those that must come first
};

std::vector<Drawn> seen_faces(const Camera& camera, const std::vector<PictureFace>& faces) {
  std::vector<Drawn> seen;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i].plane.normal().dot(camera.towards()) < 0.03 || faces[i].outline.polygons.empty()) continue;
    Drawn drawn;
    drawn.face = i;
    drawn.corners = corners_of_face(faces[i]);
    for (const Eigen::Vector3d& p : drawn.corners) {
      drawn.extent.extend(camera.project(p));
      drawn.nearness += camera.nearness(p) / static_cast<double>(drawn.corners.size());
    }
    seen.push_back(std::move(drawn));
  }
  return seen;
}

/// How surely a is behind b. All planes face the viewer, so who is in front of a plane hides it.
double behind(const Drawn& a, const Plane& plane_a, const Drawn& b, const Plane& plane_b) {
  return std::max(1.0 - share_in_front(a.corners, plane_b), share_in_front(b.corners, plane_a));
}

void draw_face(SvgPage& page, const PageFit& place, const Camera& camera, const PictureFace& face) {
  std::string path;
  const auto ring = [&](const Ring& corners) {
    char command = 'M';
    for (const Eigen::Vector2d& uv_m : corners) {
      const Pixel p = place(face.outline.basis.to_world(uv_m));
      path += fmt::format("{}{:.1f} {:.1f}", command, p.x(), p.y());
      command = 'L';
    }
    path += 'Z';
  };
  for (const Polygon& polygon : face.outline.polygons) {
    ring(polygon.outer);
    for (const Ring& hole : polygon.holes) ring(hole);
  }
  const double shade = 0.72 + 0.28 * face.plane.normal().dot(camera.towards());
  const auto channel = [&](int value) { return static_cast<int>(std::lround(shade * value)); };
  const auto darker = [&](int value) { return static_cast<int>(std::lround(0.55 * shade * value)); };
  const Rgb& c = face.colour;
  page.raw(fmt::format(
      "<path fill-rule=\"evenodd\" style=\"fill:#{:02x}{:02x}{:02x};stroke:#{:02x}{:02x}{:02x};stroke-width:.7\" "
      "d=\"{}\"/>\n",
      channel(c.red), channel(c.green), channel(c.blue), darker(c.red), darker(c.green), darker(c.blue), path));
}

}  // namespace

Rgb colour_of_rank(std::size_t rank) {
  constexpr std::array kColours = {Rgb{86, 148, 222},  Rgb{234, 142, 66}, Rgb{104, 184, 112}, Rgb{222, 92, 90},
                                   Rgb{156, 124, 210}, Rgb{206, 178, 76}, Rgb{88, 190, 196},  Rgb{226, 130, 184},
                                   Rgb{156, 118, 88},  Rgb{150, 196, 74}, Rgb{70, 112, 176},  Rgb{246, 180, 130},
                                   Rgb{60, 140, 98},   Rgb{196, 90, 140}, Rgb{176, 164, 232}, Rgb{120, 150, 160}};
  return kColours[rank % kColours.size()];
}

double best_azimuth_rad(const Eigen::Vector3d& up, double elevation_rad, const std::vector<PictureFace>& faces) {
  constexpr int kDirections = 36;
  double best_rad = 0.0;
  double most_m2 = -1.0;
  for (int i = 0; i < kDirections; ++i) {
    const double azimuth_rad = 2.0 * std::numbers::pi * i / kDirections;
    const Camera camera(up, azimuth_rad, elevation_rad);
    double seen_m2 = 0.0;
    for (const PictureFace& face : faces) {
      seen_m2 += face.outline.area_m2 * std::max(face.plane.normal().dot(camera.towards()), 0.0);
    }
    if (seen_m2 <= most_m2) continue;
    most_m2 = seen_m2;
    best_rad = azimuth_rad;
  }
  return best_rad;
}

std::vector<Eigen::Vector3d> corners_of(const std::vector<PictureFace>& faces) {
  std::vector<Eigen::Vector3d> all;
  for (const PictureFace& face : faces) {
    const std::vector<Eigen::Vector3d> corners = corners_of_face(face);
    all.insert(all.end(), corners.begin(), corners.end());
  }
  return all;
}

std::vector<std::size_t> back_to_front(const Camera& camera, const std::vector<PictureFace>& faces) {
  std::vector<Drawn> left = seen_faces(camera, faces);
  for (Drawn& b : left) {
    for (std::size_t a = 0; a < left.size(); ++a) {
      if (left[a].face == b.face || !left[a].extent.intersects(b.extent)) continue;
      const Plane& plane_a = faces[left[a].face].plane;
      const Plane& plane_b = faces[b.face].plane;
      if (behind(left[a], plane_a, b, plane_b) > behind(b, plane_b, left[a], plane_a)) b.behind.push_back(left[a].face);
    }
  }
  std::vector<std::size_t> order;
  while (!left.empty()) {
    // Planes that pass through each other can form rings: then who waits for fewest comes first, the farthest of them.
    const auto next = std::min_element(left.begin(), left.end(), [](const Drawn& a, const Drawn& b) {
      return a.behind.size() != b.behind.size() ? a.behind.size() < b.behind.size() : a.nearness < b.nearness;
    });
    const std::size_t face = next->face;
    order.push_back(face);
    left.erase(next);
    for (Drawn& drawn : left) std::erase(drawn.behind, face);
  }
  return order;
}

void draw_faces(SvgPage& page, const PageFit& place, const Camera& camera, const std::vector<PictureFace>& faces) {
  for (const std::size_t i : back_to_front(camera, faces)) draw_face(page, place, camera, faces[i]);
}

}  // namespace planemap::experiments
