#include "serve/grpc/map_pages.hpp"

#include <algorithm>
#include <cstddef>
#include <planemap/block.hpp>
#include <utility>

#include "codec/proto_answer_codec.hpp"
#include "serve/grpc/pages.hpp"

namespace planemap::service {
namespace {

/// Where the pages of the planes have come to.
struct PlanePages {
  std::shared_ptr<const MapIndex> index;
  std::string frame;
  FilterMatch match;
  std::size_t next = 0;   ///< of match.planes
  std::size_t place = 0;  ///< of the index's planes
  std::uint32_t page = 0;

  v1::Plane plane() {
    const auto planes = index->queries().planes();
    while (planes[place].record->id < match.planes[next]) ++place;
    v1::Plane message = to_proto(planes[place]);
    cut_to_fit(message, kMaxItemBytes);
    return message;
  }

  bool operator()(v1::SnapshotPage& message) {
    const MapSnapshot& snapshot = index->snapshot();
    *message.mutable_map() = version_of(snapshot);
    message.set_frame(frame);
    message.set_cell_size_m(snapshot.cell_size_m());
    message.set_plane_count(match.planes.size());
    message.set_page(page++);
    for (PageRoom room; next < match.planes.size(); ++next) {
      v1::Plane item = plane();
      if (!room.take(item.ByteSizeLong())) break;
      *message.add_planes() = std::move(item);
    }
    message.set_last(next == match.planes.size());
    return message.last();
  }
};

/// Where the pages of the cells have come to.
struct CellPages {
  std::shared_ptr<const MapIndex> index;
  std::string frame;
  FilterMatch match;
  std::size_t block = 0;
  std::size_t ordinal = 0;
  std::uint32_t page = 0;

  bool is_wanted(const CellView& cell) const {
    if (match.other_cells) return true;  // nothing is asked of planes
    return std::binary_search(match.planes.begin(), match.planes.end(), cell.plane_id);
  }
  /// @return false: the page is full
  bool add_block(v1::CellsPage& message, PageRoom& room) {
    const MapSnapshot& snapshot = index->snapshot();
    const Block& cells = *snapshot.blocks()[block];
    for (; ordinal < cells.size(); ++ordinal) {
      if (!snapshot.is_dense(cells.cell(ordinal))) continue;
      const CellView view = snapshot.view_of(cells, ordinal);
      if (!is_wanted(view)) continue;
      v1::Cell item = to_proto(view);
      if (!room.take(item.ByteSizeLong())) return false;
      *message.add_cells() = std::move(item);
    }
    return true;
  }

  bool operator()(v1::CellsPage& message) {
    const MapSnapshot& snapshot = index->snapshot();
    *message.mutable_map() = version_of(snapshot);
    message.set_frame(frame);
    message.set_cell_size_m(snapshot.cell_size_m());
    message.set_page(page++);
    PageRoom room;
    for (; block < snapshot.blocks().size(); ++block, ordinal = 0) {
      if (!add_block(message, room)) break;
    }
    message.set_last(block == snapshot.blocks().size());
    return message.last();
  }
};

struct RegionPages {
  std::shared_ptr<const MapIndex> index;
  RegionContents contents;
  std::size_t plane = 0;
  std::size_t cell = 0;
  std::uint32_t page = 0;

  static v1::RegionPlane plane_item(const RegionPlane& found) {
    v1::RegionPlane item = to_proto(found);
    // Clipped polygons are smaller than their outlines, so both fit where the outline takes half.
    if (item.ByteSizeLong() > kMaxItemBytes) cut_to_fit(*item.mutable_plane(), kMaxItemBytes / 2);
    if (item.ByteSizeLong() > kMaxItemBytes) item.clear_polygons();
    return item;
  }

  bool operator()(v1::RegionPage& message) {
    *message.mutable_map() = version_of(index->snapshot());
    message.set_page(page++);
    PageRoom room;
    for (; plane < contents.planes.size(); ++plane) {
      v1::RegionPlane item = plane_item(contents.planes[plane]);
      if (!room.take(item.ByteSizeLong())) return false;
      *message.add_planes() = std::move(item);
    }
    for (; cell < contents.cells.size(); ++cell) {
      v1::Cell item = to_proto(contents.cells[cell]);
      if (!room.take(item.ByteSizeLong())) return false;
      *message.add_cells() = std::move(item);
    }
    message.set_last(true);
    return true;
  }
};

}  // namespace

std::function<bool(v1::SnapshotPage&)> snapshot_pages(std::shared_ptr<const MapIndex> index, std::string frame,
                                                      FilterMatch match) {
  return PlanePages{std::move(index), std::move(frame), std::move(match)};
}

std::function<bool(v1::CellsPage&)> cells_pages(std::shared_ptr<const MapIndex> index, std::string frame,
                                                FilterMatch match) {
  return CellPages{std::move(index), std::move(frame), std::move(match)};
}

std::function<bool(v1::RegionPage&)> region_pages(std::shared_ptr<const MapIndex> index, RegionContents contents) {
  return RegionPages{std::move(index), std::move(contents)};
}

}  // namespace planemap::service
