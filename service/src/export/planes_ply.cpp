#include <spdlog/fmt/fmt.h>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>

#include "common/byte_stream.hpp"
#include "export/colour.hpp"
#include "export/formats.hpp"
#include "export/mesh.hpp"

namespace planemap {
void write_planes_ply(const ExportMap& map, std::ostream& out) {
  std::vector<PlaneMesh> meshes;
  meshes.reserve(map.planes.size());
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const ExportPlane& plane : map.planes) {
    meshes.push_back(mesh_of(plane.outline));
    vertices += meshes.back().vertices_m.size();
    triangles += meshes.back().triangles.size();
  }
  fmt::format_to(std::ostreambuf_iterator<char>(out),
                 "ply\nformat binary_little_endian 1.0\ncomment planes of map {}, revision {}; metres\n"
                 "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float nx\nproperty float ny\nproperty float nz\n"
                 "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "element face {}\nproperty list uchar int vertex_indices\nproperty int plane_id\nend_header\n",
                 map.epoch, map.revision, vertices, triangles);
  service::ByteWriter<std::string> body;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const PlaneRecord& record = map.planes[i].record;
    const Colour colour = colour_of(record.id);
    for (const Eigen::Vector3d& p_m : meshes[i].vertices_m) {
      for (const double x : p_m) body.put(static_cast<float>(x));
      for (const double x : record.plane.normal()) body.put(static_cast<float>(x));
      body.put(colour.red);
      body.put(colour.green);
      body.put(colour.blue);
    }
  }
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    for (const auto& triangle : meshes[i].triangles) {
      body.put(std::uint8_t{3});
      for (const std::uint32_t vertex : triangle) body.put(static_cast<std::int32_t>(before + vertex));
      body.put(static_cast<std::int32_t>(map.planes[i].record.id));
    }
    before += static_cast<std::uint32_t>(meshes[i].vertices_m.size());
  }
  out << body.bytes();
}

}  // namespace planemap
