#pragma once

#include <planemap/v1/map.pb.h>
#include <planemap/v1/queries.pb.h>

#include <functional>
#include <memory>
#include <planemap/query/plane_filter.hpp>
#include <planemap/query/region.hpp>
#include <string>

#include "serve/grpc/map_index.hpp"

namespace planemap::service {

// What makes the pages of an answer, each of at most 1 MiB: fills the next one and says whether it is the last. They
// hold the index, so all pages are of one map, however long the reader takes.

/// @param match  what passes the filter, of the index's own queries
std::function<bool(v1::SnapshotPage&)> snapshot_pages(std::shared_ptr<const MapIndex> index, std::string frame,
                                                      FilterMatch match);
/// Cells of the planes that match, and the others where they do.
std::function<bool(v1::CellsPage&)> cells_pages(std::shared_ptr<const MapIndex> index, std::string frame,
                                                FilterMatch match);
std::function<bool(v1::RegionPage&)> region_pages(std::shared_ptr<const MapIndex> index, RegionContents contents);

}  // namespace planemap::service
