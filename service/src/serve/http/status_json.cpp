#include "serve/http/status_json.hpp"

#include <nlohmann/json.hpp>

namespace planemap::service {

std::string status_json(const planemap_lcm::status_t& status) {
  nlohmann::ordered_json counters = nlohmann::ordered_json::object();
  for (const auto& counter : status.counters) counters[counter.name] = counter.value;
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
                                       {"counters", std::move(counters)}};
  // Names of counters may come from outside, as fingerprints and channels do.
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace planemap::service
