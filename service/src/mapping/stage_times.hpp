#pragma once

#include <array>
#include <chrono>
#include <planemap/mapper.hpp>
#include <vector>

namespace planemap::service {

/// Milliseconds of each stage for each scan.
struct StageTimes {
  std::array<std::vector<double>, kStageCount>
      stage_ms;                 ///< by Stage; one entry a scan, 0 where a stage was not needed
  std::vector<double> scan_ms;  ///< the whole scan
};

/// Measures one scan's stages by the steady clock.
class StageTimer final : public StageObserver {
 public:
  using Clock = std::chrono::steady_clock;

  void stage_begins(Stage stage) override { begun_[static_cast<std::size_t>(stage)] = Clock::now(); }
  void stage_ends(Stage stage) override {
    const auto index = static_cast<std::size_t>(stage);
    ms_[index] += std::chrono::duration<double, std::milli>(Clock::now() - begun_[index]).count();
  }
  /// Milliseconds since the last reset; a stage that ran twice counts twice.
  const std::array<double, kStageCount>& ms() const { return ms_; }
  void reset() { ms_ = {}; }

 private:
  std::array<Clock::time_point, kStageCount> begun_{};
  std::array<double, kStageCount> ms_{};
};

}  // namespace planemap::service
