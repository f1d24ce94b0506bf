#pragma once

#include <chrono>
#include <planemap/client/map_types.hpp>
#include <planemap/client/query_types.hpp>
#include <string>

#include "grpc_channel.hpp"

namespace planemap::client {

// Answers that come in pages.

/// All planes.
Expected<Map> read_snapshot(GrpcChannel& channel, std::chrono::milliseconds timeout);
/// All dense cells.
Expected<Map> read_cells(GrpcChannel& channel, std::chrono::milliseconds timeout);
/// Both, of one version.
Expected<Map> read_whole_map(GrpcChannel& channel, std::chrono::milliseconds timeout);
Expected<RegionAnswer> read_region(GrpcChannel& channel, const v1::QueryRegionRequest& request,
                                   std::chrono::milliseconds timeout);

/// An answer that contradicts itself, or holds numbers that are none.
tl::unexpected<Error> malformed(const std::string& what);

}  // namespace planemap::client
