#include "mapping/helper_thread.hpp"

namespace planemap::service {

void HelperThread::begin(void (*work)(void*), void* argument) {
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
