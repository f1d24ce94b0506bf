#include "codec/proto_parts.hpp"

namespace planemap::service {

void set(v1::Vector3& message, const Eigen::Vector3d& v) {
  message.set_x(v.x());
  message.set_y(v.y());
  message.set_z(v.z());
}

Eigen::Vector3d vector_of(const v1::Vector3& message) {
  return {message.x(), message.y(), message.z()};
}

namespace {

void set(v1::Ring& message, const Ring& ring) {
  message.mutable_uv_m()->Reserve(static_cast<int>(2 * ring.size()));
  for (const Eigen::Vector2d& uv_m : ring) {
    message.add_uv_m(static_cast<float>(uv_m.x()));
    message.add_uv_m(static_cast<float>(uv_m.y()));
  }
}

}  // namespace

void set(v1::Polygon& message, const Polygon& polygon) {
  set(*message.mutable_outer(), polygon.outer);
  for (const Ring& hole : polygon.holes) set(*message.add_holes(), hole);
}

}  // namespace planemap::service
