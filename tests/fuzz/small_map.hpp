#pragma once

#include <planemap/query/snapshot_queries.hpp>

namespace planemap::fuzz {

/// A corner of a room with floor and three walls, ready to be asked. Made once.
const SnapshotQueries& small_map();

}  // namespace planemap::fuzz
