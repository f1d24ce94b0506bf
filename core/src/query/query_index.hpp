#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <planemap/described_plane.hpp>
#include <planemap/query/plane_filter.hpp>
#include <planemap/snapshot.hpp>
#include <vector>

#include "plane_blocks.hpp"
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
  PlaneBlocks plane_blocks{BlockTable()};  ///< for the next index: which blocks are to be looked at for changed planes

  /// Calls visit(cell view) for the dense cells whose virtual centres are in a box, in an order that depends on the map
  /// alone.
  template <class Visit>
  void visit_cells(const Eigen::AlignedBox3d& box, Visit&& visit) const;
  /// Place of a plane; empty: there is none of that id.
  std::optional<std::size_t> find(PlaneId id) const;
};

template <class Visit>
void QueryIndex::visit_cells(const Eigen::AlignedBox3d& box, Visit&& visit) const {
  const double edge_m = snapshot->cell_size_m() * kBlockEdge;
  // Virtual centres lie up to a few cells outside of their cubes, never a block.
  const Eigen::Vector3d margin_m = Eigen::Vector3d::Constant(edge_m);
  const Eigen::AlignedBox3d reach(box.min() - margin_m, box.max() + margin_m);
  const auto indices = blocks->indices();
  for (std::size_t slot = 0; slot < indices.size(); ++slot) {
    const Eigen::Vector3d corner_m = indices[slot].cast<double>() * edge_m;
    if (!reach.intersects(Eigen::AlignedBox3d(corner_m, corner_m + margin_m))) continue;
    const Block& block = *snapshot->blocks()[slot];
    for (std::size_t i = 0; i < block.size(); ++i) {
      if (!snapshot->is_dense(block.cell(i))) continue;
      const CellView view = snapshot->view_of(block, i);
      if (box.contains(view.centre_m)) visit(view);
    }
  }
}

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
