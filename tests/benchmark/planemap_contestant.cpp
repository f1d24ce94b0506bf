#include <planemap/mapper.hpp>

#include "contestant.hpp"
#include "stopwatch.hpp"

namespace planemap::benchmark {

namespace {

class StageWatch final : public StageObserver {
 public:
  void stage_begins(Stage stage) override { watches_[static_cast<std::size_t>(stage)].restart(); }
  void stage_ends(Stage stage) override {
    const auto i = static_cast<std::size_t>(stage);
    ms_[i] = watches_[i].ms();
  }
  double ms(std::size_t stage) const { return ms_[stage]; }

 private:
  std::array<Stopwatch, kStageCount> watches_;
  std::array<double, kStageCount> ms_{};
};

class Planemap final : public Contestant {
 public:
  explicit Planemap(const MapperConfig& config) : mapper_(config, /*epoch=*/1) {}

  PartTimes take(const BenchFrame& frame) override {
    StageWatch stages;
    const Stopwatch whole;
    mapper_.integrate(frame.scan, frame.T_world_sensor, &stages);
    auto snapshot = mapper_.snapshot(&stages);
    PartTimes times{{"planemap", whole.ms()}};
    snapshot_.swap(snapshot);  // a reader holds the last one
    for (std::size_t i = 0; i < kStageCount; ++i) {
      times.emplace_back(std::string("planemap.") + name_of(static_cast<Stage>(i)), stages.ms(i));
    }
    return times;
  }

 private:
  Mapper mapper_;
  std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace

std::unique_ptr<Contestant> make_planemap(const MapperConfig& config) {
  return std::make_unique<Planemap>(config);
}

}  // namespace planemap::benchmark
