#include <algorithm>
#include <cmath>
#include <limits>
#include <planemap/simulation/renderer.hpp>
#include <stdexcept>

namespace planemap::simulation {
namespace {

constexpr double kNearM = 0.02;  // nothing nearer is drawn; a camera keeps farther off

void check(const PinholeIntrinsics& intrinsics) {
  const bool good = intrinsics.width > 0 && intrinsics.height > 0 && intrinsics.width <= 4096 &&
                    intrinsics.height <= 4096 && intrinsics.fx > 0.0 && intrinsics.fy > 0.0 &&
                    std::isfinite(intrinsics.fx) && std::isfinite(intrinsics.fy) && std::isfinite(intrinsics.cx) &&
                    std::isfinite(intrinsics.cy);
  if (!good) throw std::invalid_argument("Renderer: intrinsics need 1 to 4096 pixels a side and focal lengths > 0");
}

}  // namespace

Renderer::Renderer(std::span<const Surface> surfaces, const PinholeIntrinsics& intrinsics) : intrinsics_(intrinsics) {
  check(intrinsics);
  show(surfaces);
  const std::size_t pixels = static_cast<std::size_t>(intrinsics.width) * intrinsics.height;
  inverse_depth_.resize(pixels);
  face_index_.resize(pixels);
  image_.depth_m.resize(pixels);
  image_.surface.resize(pixels);
  image_.cos_incidence.resize(pixels);
  ray_length_.reserve(pixels);
  for (int v = 0; v < intrinsics.height; ++v) {
    for (int u = 0; u < intrinsics.width; ++u) {
      const Eigen::Vector3d ray((u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy, 1.0);
      ray_length_.push_back(static_cast<float>(ray.norm()));
    }
  }
}

void Renderer::show(std::span<const Surface> surfaces) {
  faces_.clear();
  for (const Surface& surface : surfaces) {
    for (const ConvexPiece& piece_m : surface.pieces_m) {
      faces_.push_back(Face{piece_m, surface.plane.normal(), surface.plane.d(), surface.id});
    }
  }
  if (faces_.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw std::invalid_argument("Renderer: more than 65535 polygons");
  }
  face_distance_m_.resize(faces_.size());
}

const RenderedImage& Renderer::render(const Eigen::Isometry3d& T_world_sensor) {
  std::fill(inverse_depth_.begin(), inverse_depth_.end(), 0.0F);
  const Eigen::Isometry3d T_sensor_world = T_world_sensor.inverse();
  for (std::size_t i = 0; i < faces_.size(); ++i) draw(faces_[i], i, T_sensor_world);
  resolve();
  return image_;
}

void Renderer::draw(const Face& face, std::size_t face_index, const Eigen::Isometry3d& T_sensor_world) {
  const Eigen::Vector3d normal = T_sensor_world.linear() * face.normal;
  const double d_m = face.d_m - normal.dot(T_sensor_world.translation());  // distance of the camera from the plane
  face_distance_m_[face_index] = static_cast<float>(d_m);
  if (d_m <= 0.0) return;  // seen from behind
  clip_and_project(face, T_sensor_world);
  if (corners_px_.size() < 3) return;
  // On the plane n . z (x, y, 1) + d = 0, so 1/z = -n . (x, y, 1) / d, affine in the pixel's coordinates.
  const double per_u = -normal.x() / (d_m * intrinsics_.fx);
  const double per_v = -normal.y() / (d_m * intrinsics_.fy);
  fill({-normal.z() / d_m - per_u * intrinsics_.cx - per_v * intrinsics_.cy, per_u, per_v}, face_index);
}

void Renderer::clip_and_project(const Face& face, const Eigen::Isometry3d& T_sensor_world) {
  corners_sensor_m_.clear();
  corners_px_.clear();
  for (const Eigen::Vector3d& corner_m : face.ring_m) corners_sensor_m_.push_back(T_sensor_world * corner_m);
  const auto project = [this](const Eigen::Vector3d& p_m) {
    corners_px_.emplace_back(intrinsics_.fx * p_m.x() / p_m.z() + intrinsics_.cx,
                             intrinsics_.fy * p_m.y() / p_m.z() + intrinsics_.cy);
  };
  for (std::size_t i = 0; i < corners_sensor_m_.size(); ++i) {
    const Eigen::Vector3d& p_m = corners_sensor_m_[i];
    const Eigen::Vector3d& q_m = corners_sensor_m_[(i + 1) % corners_sensor_m_.size()];
    const bool p_inside = p_m.z() >= kNearM;
    if (p_inside) project(p_m);
    if (p_inside != (q_m.z() >= kNearM)) {
      project(p_m + (kNearM - p_m.z()) / (q_m.z() - p_m.z()) * (q_m - p_m));
    }
  }
}

void Renderer::fill(const InverseDepth& inverse_depth, std::size_t face_index) {
  double top_px = std::numeric_limits<double>::infinity();
  double bottom_px = -top_px;
  for (const Eigen::Vector2d& corner : corners_px_) {
    top_px = std::min(top_px, corner.y());
    bottom_px = std::max(bottom_px, corner.y());
  }
  // A pixel belongs to the face that its centre lies in; edges are half-open, so that neighbours leave no gap.
  const int first_row = static_cast<int>(std::ceil(std::max(top_px, 0.0)));
  const int end_row = static_cast<int>(std::ceil(std::min(bottom_px, static_cast<double>(intrinsics_.height))));
  for (int v = first_row; v < end_row; ++v) {
    double left_px = std::numeric_limits<double>::infinity();
    double right_px = -left_px;
    for (std::size_t i = 0; i < corners_px_.size(); ++i) {
      const Eigen::Vector2d& p = corners_px_[i];
      const Eigen::Vector2d& q = corners_px_[(i + 1) % corners_px_.size()];
      if ((p.y() <= v) == (q.y() <= v)) continue;
      const double u = p.x() + (v - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
      left_px = std::min(left_px, u);
      right_px = std::max(right_px, u);
    }
    if (!(left_px < right_px)) continue;
    const int first = static_cast<int>(std::ceil(std::max(left_px, 0.0)));
    const int end = static_cast<int>(std::ceil(std::min(right_px, static_cast<double>(intrinsics_.width))));
    const double row_value = inverse_depth.at_origin + inverse_depth.per_v * v;
    float* const nearest = inverse_depth_.data() + static_cast<std::size_t>(v) * intrinsics_.width;
    std::uint16_t* const index = face_index_.data() + static_cast<std::size_t>(v) * intrinsics_.width;
    for (int u = first; u < end; ++u) {
      const auto value = static_cast<float>(row_value + inverse_depth.per_u * u);
      const bool nearer = value > nearest[u];
      nearest[u] = nearer ? value : nearest[u];
      index[u] = nearer ? static_cast<std::uint16_t>(face_index) : index[u];
    }
  }
}

void Renderer::resolve() {
  for (std::size_t i = 0; i < inverse_depth_.size(); ++i) {
    const float inverse = inverse_depth_[i];
    if (inverse <= 0.0F) {
      image_.depth_m[i] = 0.0F;
      image_.surface[i] = kNoSurface;
      image_.cos_incidence[i] = 0.0F;
      continue;
    }
    const std::uint16_t face = face_index_[i];
    image_.depth_m[i] = 1.0F / inverse;
    image_.surface[i] = faces_[face].surface;
    // The plane's distance from the camera is the ray's length to it times the cosine.
    image_.cos_incidence[i] = std::min(1.0F, face_distance_m_[face] * inverse / ray_length_[i]);
  }
}

}  // namespace planemap::simulation
