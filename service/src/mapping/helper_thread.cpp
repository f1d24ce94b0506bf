#include "mapping/helper_thread.hpp"

#ifdef __linux__
#include <pthread.h>
#include <sched.h>
#endif

namespace planemap::service {

/// A thread that is woken may be put behind the one that woke it, and begin when that waits for it: virtual processors
/// that are idle do not look so to Linux.
void HelperThread::keep_off_this_processor() {
#ifdef __linux__
  const int here = sched_getcpu();
  if (here == kept_off_ || here < 0) return;
  cpu_set_t processors;
  if (pthread_getaffinity_np(pthread_self(), sizeof processors, &processors) != 0) return;
  if (CPU_COUNT(&processors) < 2) return;
  CPU_CLR(static_cast<unsigned>(here), &processors);
  if (pthread_setaffinity_np(thread_.native_handle(), sizeof processors, &processors) == 0) kept_off_ = here;
#endif
}

void HelperThread::begin(void (*work)(void*), void* argument) {
  keep_off_this_processor();
  {
    const std::lock_guard lock(mutex_);
    work_ = work;
    argument_ = argument;
  }
  changed_.notify_all();
}

void HelperThread::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return work_ == nullptr; });
}

void HelperThread::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return work_ != nullptr; })) {
    lock.unlock();
    work_(argument_);
    lock.lock();
    work_ = nullptr;
    changed_.notify_all();
  }
}

std::unique_ptr<HelperThread> helper_thread_for(int threads) {
  return threads > 1 ? std::make_unique<HelperThread>() : nullptr;
}

}  // namespace planemap::service
