#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <planemap/snapshot.hpp>
#include <thread>
#include <vector>

#include "common/stopwatch.hpp"

namespace planemap::benchmark {

/// Where the mapper puts its snapshots and readers find them, as in the daemon.
class Shelf {
 public:
  /// @return the one before: it is freed where nobody else holds it
  std::shared_ptr<const MapSnapshot> put(std::shared_ptr<const MapSnapshot> snapshot) {
    const std::lock_guard lock(mutex_);
    snapshot_.swap(snapshot);
    return snapshot;
  }
  std::shared_ptr<const MapSnapshot> take() const {
    const std::lock_guard lock(mutex_);
    return snapshot_;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const MapSnapshot> snapshot_;
};

/// A thread that takes the newest snapshot some hundred times a second, and holds the last one that it took.
class Reader {
 public:
  explicit Reader(const Shelf& shelf) : thread_([this, &shelf](const std::stop_token& stop) { run(shelf, stop); }) {}

  /// Milliseconds that each taking took since the last call.
  std::vector<double> take_times() {
    std::vector<double> times_ms;
    const std::lock_guard lock(mutex_);
    times_ms.swap(take_ms_);
    return times_ms;
  }

 private:
  void run(const Shelf& shelf, const std::stop_token& stop) {
    std::shared_ptr<const MapSnapshot> held;
    while (!stop.stop_requested()) {
      const Stopwatch watch;
      auto snapshot = shelf.take();
      const double ms = watch.ms();
      held.swap(snapshot);
      snapshot.reset();
      std::unique_lock lock(mutex_);
      take_ms_.push_back(ms);
      stopped_.wait_for(lock, stop, std::chrono::milliseconds(3), [] { return false; });
    }
  }

  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::vector<double> take_ms_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace planemap::benchmark
