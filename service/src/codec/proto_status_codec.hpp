#pragma once

#include <planemap/v1/planemap_service.pb.h>

#include <cstdint>
#include <planemap_lcm/status_t.hpp>

namespace planemap::service {

/// The same status as remote clients see it.
/// @param map_utime  microseconds, of the newest mapped scan
v1::GetStatusResponse to_proto(const planemap_lcm::status_t& status, std::int64_t map_utime, bool is_paused);

}  // namespace planemap::service
