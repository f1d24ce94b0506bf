#include <planemap/mapper.hpp>
#include <utility>

#include "common/stage_watch.hpp"
#include "common/stopwatch.hpp"
#include "contestant.hpp"
#include "mapping/helper_thread.hpp"

namespace planemap::benchmark {

namespace {

class Planemap final : public Contestant {
 public:
  Planemap(std::string name, const MapperConfig& config, int threads)
      : name_(std::move(name)),
        helper_(service::helper_thread_for(threads)),
        mapper_(config, /*epoch=*/1, helper_.get()) {}

  PartTimes take(const BenchFrame& frame) override {
    StageWatch stages;
    const Stopwatch whole;
    mapper_.integrate(frame.scan, frame.T_world_sensor, &stages);
    auto snapshot = mapper_.snapshot(&stages);
    // Of two threads' own times neither is what a scan takes.
    PartTimes times{{name_, whole.ms(), helper_ ? whole.ms() : whole.own_ms()}};
    snapshot_.swap(snapshot);  // a reader holds the last one
    for (std::size_t i = 0; i < kStageCount; ++i) {
      times.push_back(
          {name_ + "." + name_of(static_cast<Stage>(i)), stages.ms(i), helper_ ? stages.ms(i) : stages.own_ms(i)});
    }
    return times;
  }

 private:
  std::string name_;
  const std::unique_ptr<service::HelperThread> helper_;
  Mapper mapper_;
  std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace

std::unique_ptr<Contestant> make_planemap(const std::string& name, const MapperConfig& config, int threads) {
  return std::make_unique<Planemap>(name, config, threads);
}

}  // namespace planemap::benchmark
