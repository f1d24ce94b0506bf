#include "codec/proto_status_codec.hpp"

namespace planemap::service {

v1::GetStatusResponse to_proto(const planemap_lcm::status_t& status, std::int64_t map_utime, bool is_paused) {
  v1::GetStatusResponse message;
  message.set_utime(status.utime);
  message.set_version(status.version);
  message.mutable_map()->set_epoch(static_cast<std::uint64_t>(status.epoch));
  message.mutable_map()->set_revision(static_cast<std::uint64_t>(status.revision));
  message.mutable_map()->set_utime(map_utime);
  message.set_plane_count(static_cast<std::uint64_t>(status.plane_count));
  message.set_cell_count(static_cast<std::uint64_t>(status.cell_count));
  message.set_block_count(static_cast<std::uint64_t>(status.block_count));
  message.set_scan_rate_hz(status.scan_rate_hz);
  message.set_scan_ms_p50(status.scan_ms_p50);
  message.set_scan_ms_max(status.scan_ms_max);
  message.set_idle_reason(status.idle_reason);
  message.set_degraded(status.degraded);
  message.set_paused(is_paused);
  for (const auto& counter : status.counters) (*message.mutable_counters())[counter.name] = counter.value;
  return message;
}

}  // namespace planemap::service
