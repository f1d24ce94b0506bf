#pragma once

#include <array>
#include <planemap/mapper.hpp>

#include "common/stopwatch.hpp"

namespace planemap::benchmark {

/// How long each stage of one scan took.
class StageWatch final : public StageObserver {
 public:
  void stage_begins(Stage stage) override { watches_[static_cast<std::size_t>(stage)].restart(); }
  void stage_ends(Stage stage) override {
    const auto i = static_cast<std::size_t>(stage);
    ms_[i] = watches_[i].ms();
    own_ms_[i] = watches_[i].own_ms();
  }
  double ms(std::size_t stage) const { return ms_[stage]; }
  double own_ms(std::size_t stage) const { return own_ms_[stage]; }  ///< the thread's own time

 private:
  std::array<Stopwatch, kStageCount> watches_;
  std::array<double, kStageCount> ms_{};
  std::array<double, kStageCount> own_ms_{};
};

}  // namespace planemap::benchmark
