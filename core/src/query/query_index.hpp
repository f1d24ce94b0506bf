#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/described_plane.hpp>
#include <planemap/query/plane_filter.hpp>
#include <planemap/snapshot.hpp>
#include <vector>

#include "query/block_index.hpp"
#include "query/plane_tree.hpp"
#include "query/prepared_surface.hpp"

namespace planemap {

/// What queries go by. Places of planes are the same in all vectors and in the tree.
struct QueryIndex {
  std::shared_ptr<const MapSnapshot> snapshot;
  std::optional<Eigen::Vector3d> up;  ///< unit; empty: gravity is not known
  std::vector<DescribedPlane> planes;
  std::vector<std::shared_ptr<const PreparedSurface>> surfaces;
  std::vector<double> normal_deviations_rad;
  PlaneTree tree;
  std::shared_ptr<const BlockIndexTable> blocks;

  /// Place of a plane; empty: there is none of that id.
  std::optional<std::size_t> find(PlaneId id) const;
};

/// A filter made ready to be asked about the planes of one index. Both must outlive it.
class FilterTest {
 public:
  FilterTest(const QueryIndex& index, const PlaneFilter& filter);

  /// Whether the plane at a place may be named.
  bool passes(std::size_t plane) const;
  /// Whether a cell of that plane, or of none, may be.
  bool passes_cell_of(PlaneId id) const;

 private:
  const QueryIndex& index_;
  const PlaneFilter& filter_;
  std::uint32_t classes_ = 0;  ///< a bit for each
  bool passes_all_ = true;
};

}  // namespace planemap
