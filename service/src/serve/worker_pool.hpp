#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace planemap::service {

/// Some threads that do what is asked of them in turn. The servers' own threads must not be kept waiting.
class WorkerPool {
 public:
  using Job = std::function<void()>;

  /// @param threads  > 0
  /// @param capacity  jobs that may wait
  WorkerPool(std::size_t threads, std::size_t capacity);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// @return false: as many jobs wait already as may
  bool try_post(Job job);
  /// For the next step of what was let in before: it always finds room. Whoever uses it bounds their number.
  void post(Job job);
  /// Does what still waits, then ends the threads. The destructor does it, too.
  void stop();
  std::size_t capacity() const { return capacity_; }

 private:
  void run();

  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable not_empty_;
  std::deque<Job> jobs_;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace planemap::service
