#include "mapping/scan_queue.hpp"

#include <stdexcept>
#include <utility>

namespace planemap::service {

ScanQueue::ScanQueue(std::size_t capacity) : capacity_(capacity) {
  if (capacity == 0) throw std::invalid_argument("ScanQueue: capacity must be > 0");
}

std::size_t ScanQueue::push_dropping_oldest(RegisteredScan&& scan) {
  auto queued = std::make_unique<RegisteredScan>(std::move(scan));
  std::unique_ptr<RegisteredScan> dropped;  // freed after the lock is
  {
    const std::lock_guard lock(mutex_);
    if (scans_.size() >= capacity_) {
      dropped = std::move(scans_.front());
      scans_.pop_front();
    }
    scans_.push_back(std::move(queued));
  }
  not_empty_.notify_one();
  return dropped ? 1 : 0;
}

std::unique_ptr<RegisteredScan> ScanQueue::pop(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  not_empty_.wait(lock, stop, [this] { return !scans_.empty() || is_interrupted_; });
  if (stop.stop_requested() || std::exchange(is_interrupted_, false)) return nullptr;
  auto scan = std::move(scans_.front());
  scans_.pop_front();
  return scan;
}

void ScanQueue::interrupt() {
  {
    const std::lock_guard lock(mutex_);
    is_interrupted_ = true;
  }
  not_empty_.notify_one();
}

std::size_t ScanQueue::clear() {
  std::deque<std::unique_ptr<RegisteredScan>> cleared;
  const std::lock_guard lock(mutex_);
  cleared.swap(scans_);
  return cleared.size();
}

std::size_t ScanQueue::size() const {
  const std::lock_guard lock(mutex_);
  return scans_.size();
}

}  // namespace planemap::service
