#include <spdlog/fmt/fmt.h>

#include <iterator>
#include <numbers>

#include "export/formats.hpp"

namespace planemap {

void write_cells_csv(const ExportMap& map, std::ostream& out) {
  std::ostreambuf_iterator<char> to(out);
  fmt::format_to(to, "x,y,z,plane_id,count,nx,ny,nz,normal_deviation_deg,sx,sy,sz\n");
  for (const CellView& cell : map.cells) {
    const Eigen::Vector3d& p = cell.centre_m;
    fmt::format_to(to, "{},{},{},{},{},", p.x(), p.y(), p.z(), cell.plane_id, cell.count);
    if (cell.normal) {
      const double deviation_deg = cell.deviation_rad * 180.0 / std::numbers::pi;
      fmt::format_to(to, "{},{},{},{},", cell.normal->x(), cell.normal->y(), cell.normal->z(), deviation_deg);
    } else {
      fmt::format_to(to, ",,,,");
    }
    fmt::format_to(to, "{},{},{}\n", cell.sigma_m.x(), cell.sigma_m.y(), cell.sigma_m.z());
  }
}

}  // namespace planemap
