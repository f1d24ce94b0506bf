// What the mapper's thread asks operator new for while nothing new is seen: nothing. PLANEMAP_ALLOCATION_CALLERS=30
// prints who asks most, 30 lines of it.

#include <gtest/gtest.h>

#include <array>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <planemap/mapper.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <thread>
#include <vector>

#include "common/counters.hpp"
#include "mapping/mapping_service.hpp"
#include "support/allocation_count.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kRoundFrames = 20;  // views of a room, over and over again
constexpr std::size_t kSettlingRounds = 30;
constexpr std::size_t kScans = 100;

/// The same views with the same noise, so that nothing is new after the first rounds.
class SettledScene {
 public:
  SettledScene() {
    simulation::SimulationConfig config;
    config.scene = "table-tops";
    config.frames = kRoundFrames;
    config.intrinsics = {320, 240, 292.5, 292.5, 160.0, 120.0};
    simulation::SimulatedSource source(config);
    while (auto frame = source.next()) frames_.push_back(std::move(*frame));
  }
  std::size_t size() const { return frames_.size(); }
  /// The n-th scan, with a time of its own.
  RegisteredScan scan(std::size_t n) const {
    RegisteredScan scan{0, frames_[n % frames_.size()].scan, frames_[n % frames_.size()].T_world_sensor};
    std::get<DepthScan>(scan.scan).utime = simulation::kFirstUtime + static_cast<std::int64_t>(n) * 33'333;
    return scan;
  }

 private:
  std::vector<sources::Frame> frames_;
};

/// Keeps callers, where the environment asks for it.
class Callers {
 public:
  Callers() {
    const char* most = std::getenv("PLANEMAP_ALLOCATION_CALLERS");  // NOLINT(concurrency-mt-unsafe)
    if (most != nullptr) most_ = std::strtoul(most, nullptr, 10);
    test::keep_callers(most_ > 0);
  }
  ~Callers() {
    test::keep_callers(false);
    if (most_ > 0) std::printf("%s", test::callers(most_).c_str());
  }
  Callers(const Callers&) = delete;
  Callers& operator=(const Callers&) = delete;

 private:
  std::size_t most_ = 0;
};

/// Adds up what each stage asked for.
class StageAllocations final : public StageObserver {
 public:
  void stage_begins(Stage) override { begun_ = test::allocations(); }
  void stage_ends(Stage stage) override { counts_[static_cast<std::size_t>(stage)] += test::allocations() - begun_; }
  std::uint64_t of(std::size_t stage) const { return counts_[stage]; }

 private:
  std::uint64_t begun_ = 0;
  std::array<std::uint64_t, kStageCount> counts_{};
};

TEST(Allocations, OfEachStageAreNoneInASettledScene) {
  const SettledScene scene;
  ASSERT_EQ(scene.size(), kRoundFrames);
  Mapper mapper(preset(Preset::kBest), /*epoch=*/1);
  std::shared_ptr<const MapSnapshot> snapshot;  // what a reader holds
  std::size_t n = 0;
  for (; n < kSettlingRounds * kRoundFrames; ++n) {
    const RegisteredScan scan = scene.scan(n);
    mapper.integrate(scan.scan, scan.T_world_sensor);
    snapshot = mapper.snapshot();
  }
  const std::size_t cells = snapshot->cell_count();
  StageAllocations stages;
  std::uint64_t all = 0;
  for (const std::size_t end = n + kScans; n < end; ++n) {
    const RegisteredScan scan = scene.scan(n);
    test::begin_counting_allocations();
    mapper.integrate(scan.scan, scan.T_world_sensor, &stages);
    auto next = mapper.snapshot(&stages);
    all += test::allocations();
    test::end_counting_allocations();
    snapshot.swap(next);
  }
  std::printf("allocations of %zu scans: %lu; cells: %zu, then %zu\n", kScans, all, cells, snapshot->cell_count());
  std::uint64_t by_stage = 0;
  for (std::size_t i = 0; i < kStageCount; ++i) {
    std::printf("  %-12s %lu\n", name_of(static_cast<Stage>(i)), stages.of(i));
    EXPECT_EQ(stages.of(i), 0U) << name_of(static_cast<Stage>(i));
    by_stage += stages.of(i);
  }
  EXPECT_EQ(all, by_stage) << "something between the stages allocates";
}

TEST(Allocations, OfTheMappersThreadAreNoneInASettledScene) {
  const Callers callers;
  const SettledScene scene;
  const std::size_t first = kSettlingRounds * kRoundFrames;
  std::mutex mutex;
  std::condition_variable done;
  std::size_t mapped = 0;
  std::uint64_t counted = 0;
  Counters counters;
  MappingService service(ServiceConfig{}, /*epoch=*/1, counters, [&] {  // on the mapper's thread
    {
      const std::lock_guard lock(mutex);
      ++mapped;
      if (mapped == first + kScans) {
        counted = test::allocations();
        test::end_counting_allocations();
      }
      if (mapped == first) test::begin_counting_allocations();
    }
    done.notify_one();
  });
  std::shared_ptr<const MapSnapshot> snapshot;  // what a reader holds
  for (std::size_t n = 0; n < first + kScans; ++n) {
    counters.scan_received();
    service.push(scene.scan(n));
    std::unique_lock lock(mutex);
    done.wait(lock, [&] { return mapped == n + 1; });
    snapshot = service.snapshot();
  }
  service.stop();
  ASSERT_EQ(counters.value("scans.mapped"), static_cast<std::int64_t>(first + kScans));
  std::printf("allocations of the mapper's thread for %zu scans: %lu\n", kScans, counted);
  EXPECT_EQ(counted, 0U);
}

TEST(Allocations, AreCountedByThreadAndWithTheirCallers) {
  test::begin_counting_allocations();
  std::thread([] { ::operator delete(::operator new(8)); }).join();  // not this thread's, but the thread itself
  const std::uint64_t before = test::allocations();
  test::keep_callers(true);
  ::operator delete(::operator new(8));
  ::operator delete (::operator new (64, std::align_val_t{64}), std::align_val_t{64});
  test::keep_callers(false);
  EXPECT_EQ(test::allocations(), before + 2);
  test::end_counting_allocations();
  ::operator delete(::operator new(8));
  EXPECT_EQ(test::allocations(), before + 2);
  EXPECT_NE(test::callers(1000).find("AreCountedByThreadAndWithTheirCallers"), std::string::npos);
}

}  // namespace
}  // namespace planemap::service
