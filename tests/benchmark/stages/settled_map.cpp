#include "stages/settled_map.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "frame_source.hpp"

namespace planemap::benchmark {

namespace {

constexpr std::int64_t kPeriodUs = 33'333;

}  // namespace

StageFrames read_stage_frames(std::size_t most) {
  const char* data = std::getenv("PLANEMAP_TEST_DATA");
  const std::string kitchen = data != nullptr ? std::string(data) + "/redkitchen" : "";
  StageFrames stage{read_frames(*open_frames({.dataset = kitchen}, most), most),
                    data != nullptr ? "red kitchen" : "rendered apartment"};
  if (stage.frames.empty()) throw std::runtime_error("there is no frame to measure with");
  return stage;
}

SettledMap::SettledMap(const MapperConfig& config, const std::vector<sources::Frame>& frames)
    : frames_(frames), mapper_(config, /*epoch=*/1) {
  for (std::size_t i = 0; i < frames_.size(); ++i) map_next();
}

void SettledMap::map_next() {
  sources::Frame& frame = frames_[next_];
  next_ = (next_ + 1) % frames_.size();
  utime_ += kPeriodUs;
  frame.scan.utime = utime_;
  const Scan scan = frame.scan;
  const Stopwatch whole;
  mapper_.integrate(scan, frame.T_world_sensor, &stages_);
  auto snapshot = mapper_.snapshot(&stages_);
  whole_own_ms_ = whole.own_ms();
  snapshot_.swap(snapshot);
}

}  // namespace planemap::benchmark
