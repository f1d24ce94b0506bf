#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace planemap {

/// One object, as `planemap status --json` prints it and /api/v1/status answers, without a line's end.
/// @param status  planemap_lcm::status_t, or what a client made of one: client::Status
template <class Status>
std::string status_json(const Status& status) {
  nlohmann::ordered_json counters = nlohmann::ordered_json::object();
  for (const auto& [name, value] : status.counters) counters[name] = value;
  const nlohmann::ordered_json json = {{"version", status.version},
                                       {"utime", status.utime},
                                       {"epoch", status.epoch},
                                       {"revision", status.revision},
                                       {"planeCount", status.plane_count},
                                       {"cellCount", status.cell_count},
                                       {"blockCount", status.block_count},
                                       {"scanRateHz", status.scan_rate_hz},
                                       {"scanMs", {{"p50", status.scan_ms_p50}, {"max", status.scan_ms_max}}},
                                       {"lastScanUtime", status.last_scan_utime},
                                       {"idleReason", status.idle_reason},
                                       {"degraded", status.degraded},
                                       {"counters", std::move(counters)}};
  // Names of counters may come from outside, as fingerprints and channels do, and need not be UTF-8.
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace planemap
