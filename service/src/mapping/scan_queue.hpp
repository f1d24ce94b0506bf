#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <stop_token>

#include "sync/synchronizer.hpp"

namespace planemap::service {

/// Scans on their way to the mapper. Bounded: a full queue lets the oldest go, since the newest says more about where
/// the robot is. Any number of threads may use it.
class ScanQueue {
 public:
  /// @param capacity  > 0
  explicit ScanQueue(std::size_t capacity);

  /// @return how many scans had to go: 0 or 1
  std::size_t push_dropping_oldest(RegisteredScan&& scan);
  /// Waits for a scan; nullptr after a stop request or an interrupt(), though scans may be left.
  std::unique_ptr<RegisteredScan> pop(const std::stop_token& stop);
  /// Ends a pop() that waits, or else the next one.
  void interrupt();
  /// Empties the queue. @return how many scans were in it
  std::size_t clear();
  std::size_t size() const;
  std::size_t capacity() const { return capacity_; }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable_any not_empty_;
  std::deque<std::unique_ptr<RegisteredScan>> scans_;
  bool is_interrupted_ = false;
};

}  // namespace planemap::service
