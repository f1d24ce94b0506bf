#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <planemap/outline.hpp>
#include <planemap/plane.hpp>
#include <planemap/query/snapshot_queries.hpp>
#include <planemap/snapshot.hpp>
#include <string>
#include <vector>

namespace planemap {

struct ExportPlane {
  PlaneRecord record;
  Outline outline;
  PlaneClass plane_class = PlaneClass::kOther;
  std::vector<PlaneId> coplanar;  ///< other planes with the same parameters, as far as is known; ascending
};

/// What exporters and tables are made from, wherever the map is from.
struct ExportMap {
  std::string frame;  ///< name of the world frame
  std::uint64_t epoch = 0;
  std::uint64_t revision = 0;
  std::optional<Eigen::Vector3d> gravity;  ///< unit, down in the world frame; empty: not known
  std::vector<ExportPlane> planes;         ///< by id
  std::vector<CellView> cells;             ///< dense ones; may be left out
  std::size_t cell_count = 0;              ///< of dense ones, also where they are left out
};

/// From a snapshot of this process: outlines and classes are worked out here.
/// @param gravity  points down in the world frame, any length but 0; empty: not known
ExportMap export_map_of(const MapSnapshot& snapshot, const std::string& frame,
                        const std::optional<Eigen::Vector3d>& gravity);

/// The same with outlines and classes that are known already, and without the cells.
ExportMap export_map_of(const SnapshotQueries& queries, const std::string& frame,
                        const std::optional<Eigen::Vector3d>& gravity);

/// Links the planes that are coplanar.
void set_coplanar_links(std::vector<ExportPlane>& planes);

}  // namespace planemap
