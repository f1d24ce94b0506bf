// planemap-saving: the time for a scan while the map is saved beside that without, in turn in one run.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <support/program.hpp>
#include <support/temporary_folder.hpp>
#include <vector>

#include "common/machine.hpp"
#include "common/quantile.hpp"
#include "frame_source.hpp"
#include "mapping/mapping_service.hpp"
#include "store/map_saver.hpp"
#include "store/map_store.hpp"

namespace planemap::benchmark {
namespace {

constexpr std::chrono::seconds kLong(600);
constexpr std::uint64_t kEpoch = 1;

struct Arguments {
  FrameOptions from;
  std::size_t frames = 150;
  std::size_t rounds = 8;
  double interval_s = service::StoreConfig{}.interval_s;
  bool json = false;
};

/// A mapper as in planemapd; with a file where it is to be saved.
class Side {
 public:
  Side(service::ServiceConfig config, const std::string& path) : mapping_(config, kEpoch, counters_, {}) {
    mapping_.set_scan_listener([this](const service::MappedScan& scan) {
      const std::lock_guard lock(mutex_);
      scan_ms_.push_back(scan.scan_ms);
      mapped_.notify_all();
    });
    if (path.empty()) return;
    config.store.path = path;
    auto store = service::open_store(config, kEpoch);
    if (!store) throw std::runtime_error(store.error().message);
    saver_ = std::make_unique<service::MapSaver>(config.store, std::move(*store), mapping_, counters_);
  }
  ~Side() { mapping_.stop(); }
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;

  /// Maps all frames one after the other, as fast as it goes.
  /// @return milliseconds a scan
  std::vector<double> map(const std::vector<sources::Frame>& frames) {
    scan_ms_.clear();
    for (const sources::Frame& frame : frames) {
      counters_.scan_received();
      std::unique_lock lock(mutex_);
      const std::size_t before = scan_ms_.size();
      lock.unlock();
      mapping_.push({0, frame.scan, frame.T_world_sensor});
      lock.lock();
      if (!mapped_.wait_for(lock, kLong, [&] { return scan_ms_.size() > before; })) {
        throw std::runtime_error("a scan was not mapped");
      }
    }
    return scan_ms_;
  }
  /// All that there is to save is saved: nothing is written until more is mapped.
  void settle() {
    if (!saver_) return;
    if (auto saved = saver_->save(kLong); !saved) throw std::runtime_error(saved.error().message);
  }
  std::int64_t counter(const std::string& name) const { return counters_.value(name); }
  std::size_t cells() const { return mapping_.snapshot()->cell_count(); }

 private:
  service::Counters counters_;
  service::MappingService mapping_;
  std::mutex mutex_;  ///< of the two below
  std::condition_variable mapped_;
  std::vector<double> scan_ms_;
  std::unique_ptr<service::MapSaver> saver_;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

nlohmann::ordered_json figures_of(const std::vector<double>& ms) {
  return {{"scans", ms.size()}, {"meanMs", mean(ms)}, {"medianMs", median(ms)}, {"p95Ms", quantile(ms, 0.95)}};
}

void measure(const Arguments& arguments) {
  spdlog::set_level(spdlog::level::warn);
  const auto frames = read_frames(*open_frames(arguments.from, std::nullopt), arguments.frames);
  const TemporaryFolder folder;
  service::ServiceConfig config;
  config.store.interval_s = arguments.interval_s;
  config.store.backup_s = 0.0;  // one would fall into either side's turn
  Side saved(config, (folder.path() / "saved.planemap").string());
  Side unsaved(config, "");
  std::vector<double> with;
  std::vector<double> without;
  std::vector<double> ratios;
  for (std::size_t round = 0; round <= arguments.rounds; ++round) {
    std::vector<double> a;
    std::vector<double> b;
    for (const bool saves : {round % 2 == 0, round % 2 != 0}) {
      (saves ? a : b) = (saves ? saved : unsaved).map(frames);
      saved.settle();
    }
    if (round == 0) continue;  // the map grows
    ratios.push_back(mean(a) / mean(b));
    with.insert(with.end(), a.begin(), a.end());
    without.insert(without.end(), b.begin(), b.end());
  }
  const double ratio = median(ratios);
  if (arguments.json) {
    const nlohmann::ordered_json json = {{"machine", json_of(this_machine())},
                                         {"cells", saved.cells()},
                                         {"intervalS", arguments.interval_s},
                                         {"commits", saved.counter("store.commits")},
                                         {"lateCommits", saved.counter("store.late_commits")},
                                         {"rows", saved.counter("store.rows")},
                                         {"saving", figures_of(with)},
                                         {"notSaving", figures_of(without)},
                                         {"ratios", ratios},
                                         {"ratio", ratio}};
    std::printf("%s\n", json.dump().c_str());
    return;
  }
  std::printf(
      "%s\n%zu cells, a commit each %.2g s: %lld commits, %lld rows, %lld late\n", text_of(this_machine()).c_str(),
      saved.cells(), arguments.interval_s, static_cast<long long>(saved.counter("store.commits")),
      static_cast<long long>(saved.counter("store.rows")), static_cast<long long>(saved.counter("store.late_commits")));
  for (const auto& [name, ms] : {std::pair("saving", &with), std::pair("not saving", &without)}) {
    std::printf("%-10s  %zu scans, mean %.2f ms, median %.2f, p95 %.2f\n", name, ms->size(), mean(*ms), median(*ms),
                quantile(*ms, 0.95));
  }
  std::printf("time per scan, saving to not saving: %.3f (median of %zu rounds, %.3f to %.3f; bound: 1.1)\n", ratio,
              ratios.size(), quantile(ratios, 0.0), quantile(ratios, 1.0));
}

void define_options(CLI::App& app, Arguments& arguments) {
  define_frame_options(app, arguments.from);
  app.add_option("--frames", arguments.frames, "of a round, mapped one after the other as fast as it goes")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--rounds", arguments.rounds,
                 "in each either mapper maps all frames; one more, in which the map grows, "
                 "is not counted")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--interval", arguments.interval_s, "between two commits, s")
      ->check(CLI::Range(0.01, 60.0))
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "one object instead of the table");
  app.footer("Exit codes: 0 done, whether or not the bound is held; 1 failed, 2 wrong use.");
}

}  // namespace
}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  using namespace planemap::benchmark;
  CLI::App app("planemap-saving: the time for a scan while the map is saved, beside that without", "planemap-saving");
  Arguments arguments;
  define_options(app, arguments);
  return planemap::run_program(app, argc, argv, [&] { measure(arguments); });
}
