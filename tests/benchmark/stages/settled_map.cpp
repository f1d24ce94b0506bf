#include "stages/settled_map.hpp"

#include <cstdlib>
#include <planemap/simulation/simulated_source.hpp>
#include <planemap/sources/open_folder.hpp>
#include <stdexcept>
#include <utility>

namespace planemap::benchmark {

namespace {

constexpr std::int64_t kPeriodUs = 33'333;

std::vector<sources::Frame> all_of(sources::FrameSource& source, std::size_t most) {
  std::vector<sources::Frame> frames;
  frames.reserve(most);
  while (frames.size() < most) {
    auto frame = source.next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
  }
  if (frames.empty()) throw std::runtime_error("there is no frame to measure with");
  return frames;
}

}  // namespace

StageFrames read_stage_frames(std::size_t most) {
  if (const char* data = std::getenv("PLANEMAP_TEST_DATA")) {
    auto kitchen = sources::open_folder(std::string(data) + "/redkitchen");
    if (!kitchen) throw std::runtime_error(kitchen.error().message);
    return {all_of(**kitchen, most), "red kitchen"};
  }
  simulation::SimulationConfig apartment;
  apartment.frames = most;
  simulation::SimulatedSource source(apartment);
  return {all_of(source, most), "rendered apartment"};
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
