#pragma once

#include <cstdint>
#include <memory>
#include <planemap/mapper.hpp>
#include <planemap/sources/frame_source.hpp>
#include <vector>

#include "common/stage_watch.hpp"

namespace planemap::benchmark {

/// The red kitchen where its recording is (PLANEMAP_TEST_DATA), else a rendered apartment.
struct StageFrames {
  std::vector<sources::Frame> frames;
  const char* name = "";
};
/// @param most  frames
StageFrames read_stage_frames(std::size_t most);

/// A map that has seen all frames already and goes on seeing them, round after round.
class SettledMap {
 public:
  SettledMap(const MapperConfig& config, const std::vector<sources::Frame>& frames);

  /// Maps the next frame and publishes. What it took is in stages().
  void map_next();
  const StageWatch& stages() const { return stages_; }
  double whole_own_ms() const { return whole_own_ms_; }
  /// The newest one; a reader holds it while the next frame is mapped, so what changes then is copied before.
  const std::shared_ptr<const MapSnapshot>& snapshot() const { return snapshot_; }

 private:
  std::vector<sources::Frame> frames_;
  Mapper mapper_;
  std::size_t next_ = 0;
  std::int64_t utime_ = 0;
  StageWatch stages_;
  double whole_own_ms_ = 0.0;
  std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace planemap::benchmark
