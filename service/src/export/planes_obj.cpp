#include <spdlog/fmt/fmt.h>

#include <cstddef>
#include <iterator>

#include "export/colour.hpp"
#include "export/formats.hpp"
#include "export/mesh.hpp"

namespace planemap {

void write_planes_obj(const ExportMap& map, std::ostream& out) {
  std::ostreambuf_iterator<char> to(out);
  fmt::format_to(to, "# planes of map {}, revision {}: metres; vertices are x y z red green blue\n", map.epoch,
                 map.revision);
  std::size_t before = 1;  // vertices are numbered from 1 through the whole file
  for (const ExportPlane& plane : map.planes) {
    const PlaneMesh mesh = mesh_of(plane.outline);
    const Colour colour = colour_of(plane.record.id);
    const Eigen::Vector3d& n = plane.record.plane.normal();
    fmt::format_to(to, "o plane_{}_{}\n", plane.record.id, name_of(plane.plane_class));
    for (const Eigen::Vector3d& p : mesh.vertices_m) {
      fmt::format_to(to, "v {:.4f} {:.4f} {:.4f} {:.3f} {:.3f} {:.3f}\n", p.x(), p.y(), p.z(), colour.red / 255.0,
                     colour.green / 255.0, colour.blue / 255.0);
    }
    fmt::format_to(to, "vn {:.6f} {:.6f} {:.6f}\n", n.x(), n.y(), n.z());
    for (const auto& [a, b, c] : mesh.triangles) {
      fmt::format_to(to, "f {}//-1 {}//-1 {}//-1\n", before + a, before + b, before + c);
    }
    before += mesh.vertices_m.size();
  }
}

}  // namespace planemap
