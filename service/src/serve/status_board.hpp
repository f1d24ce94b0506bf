#pragma once

#include <cstdint>
#include <planemap_lcm/status_t.hpp>
#include <string>

#include "common/counters.hpp"
#include "common/repeat_guard.hpp"
#include "ingest/kernel_drops.hpp"
#include "ingest/scan_intake.hpp"
#include "mapping/mapping_service.hpp"

namespace planemap::service {

/// How the service is: as a message, and as lines in the log. Not thread-safe; what it looks at is.
class StatusBoard {
 public:
  StatusBoard(const ScanIntake& intake, const MappingService& mapping, Counters& counters);

  planemap_lcm::status_t status(double now_host_s, std::int64_t utime);
  /// Logs why nothing is being mapped, or how mapping goes on: at most one line in 5 s. Call it about once a second.
  void log(double now_host_s);

 private:
  std::string idle_reason_at(double now_host_s) const;

  const ScanIntake& intake_;
  const MappingService& mapping_;
  Counters& counters_;
  KernelDrops kernel_drops_;
  RepeatGuard repeats_;
  double started_host_s_;
};

}  // namespace planemap::service
