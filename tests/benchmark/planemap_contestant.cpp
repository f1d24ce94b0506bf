#include <planemap/mapper.hpp>

#include "common/stage_watch.hpp"
#include "common/stopwatch.hpp"
#include "contestant.hpp"

namespace planemap::benchmark {

namespace {

class Planemap final : public Contestant {
 public:
  Planemap(std::string name, const MapperConfig& config) : name_(std::move(name)), mapper_(config, /*epoch=*/1) {}

  PartTimes take(const BenchFrame& frame) override {
    StageWatch stages;
    const Stopwatch whole;
    mapper_.integrate(frame.scan, frame.T_world_sensor, &stages);
    auto snapshot = mapper_.snapshot(&stages);
    PartTimes times{{name_, whole.ms(), whole.own_ms()}};
    snapshot_.swap(snapshot);  // a reader holds the last one
    for (std::size_t i = 0; i < kStageCount; ++i) {
      times.push_back({name_ + "." + name_of(static_cast<Stage>(i)), stages.ms(i), stages.own_ms(i)});
    }
    return times;
  }

 private:
  std::string name_;
  Mapper mapper_;
  std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace

std::unique_ptr<Contestant> make_planemap(const std::string& name, const MapperConfig& config) {
  return std::make_unique<Planemap>(name, config);
}

}  // namespace planemap::benchmark
