#pragma once

#include <atomic>
#include <string>

#include "mapping/mapping_service.hpp"

namespace planemap::service {

/// How the service is, in one word and, where that is no, a sentence.
struct HealthReport {
  bool is_good = true;
  std::string reason;  ///< empty where it is good
};

/// Whether the service lives, and whether it is to be asked: one answer for all who want to know (gRPC health,
/// /healthz, /readyz, the service manager's watchdog). Safe from any thread.
class Health {
 public:
  /// The mapper needs some milliseconds for a scan; one that takes so long hangs.
  static constexpr double kStuckAfterS = 10.0;

  /// @param mapping        outlives this
  /// @param stuck_after_s  time for one scan after which the mapper is taken to hang, seconds
  explicit Health(const MappingService& mapping, double stuck_after_s = kStuckAfterS);

  /// Whether the mapper's thread makes progress: one that waits for scans, or is paused, does.
  HealthReport liveness(double now_host_s) const;
  /// Whether it lives and takes questions.
  HealthReport readiness(double now_host_s) const;
  /// It takes questions from now on.
  void begin() { state_ = State::kServing; }
  /// It takes no more questions.
  void end() { state_ = State::kEnding; }

 private:
  enum class State { kStarting, kServing, kEnding };

  const MappingService& mapping_;
  const double stuck_after_s_;
  std::atomic<State> state_ = State::kStarting;
};

}  // namespace planemap::service
