#include "export/cells_ply.hpp"

#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <exception>
#include <fstream>

#include "export/colour.hpp"

namespace planemap::cli {
namespace {

constexpr Colour kWithoutPlane = {150, 150, 150};

pcl::PointXYZRGBNormal point_of(const CellView& cell) {
  const Colour colour = cell.plane_id == kNoPlane ? kWithoutPlane : colour_of(cell.plane_id, 0.55);
  pcl::PointXYZRGBNormal point;
  point.getVector3fMap() = cell.centre_m.cast<float>();
  point.r = colour.red;
  point.g = colour.green;
  point.b = colour.blue;
  const Eigen::Vector3d normal = cell.normal.value_or(Eigen::Vector3d::Zero());
  point.getNormalVector3fMap() = normal.cast<float>();
  point.curvature = 0.0F;
  return point;
}

/// PCL writes no cloud without points, yet a map without cells is a map.
Expected<void> write_empty_ply(const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "ply\nformat ascii 1.0\ncomment a map without cells\nelement vertex 0\nproperty float x\nproperty float y\n"
          "property float z\nend_header\n";
  if (!file.flush()) return fail(path.string() + ": cannot be written");
  return {};
}

}  // namespace

Expected<void> write_cells_ply(const ExportMap& map, const std::filesystem::path& path) {
  if (map.cells.empty()) return write_empty_ply(path);
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud;
  cloud.reserve(map.cells.size());
  for (const CellView& cell : map.cells) cloud.push_back(point_of(cell));
  try {
    pcl::PLYWriter writer;
    if (writer.write(path.string(), cloud, /*binary=*/true, /*use_camera=*/false) != 0) {
      return fail(path.string() + ": PCL could not write it");
    }
  } catch (const std::exception& error) {
    return fail(path.string() + ": " + error.what());
  }
  return {};
}

}  // namespace planemap::cli
