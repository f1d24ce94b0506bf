#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <planemap/second_thread.hpp>
#include <stop_token>
#include <thread>

namespace planemap::service {

/// A thread that lives on between the works that it is given.
class HelperThread final : public SecondThread {
 public:
  HelperThread() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void begin(void (*work)(void*), void* argument) override;
  void wait() override;

 private:
  void run(const std::stop_token& stop);
  void keep_off_this_processor();

  int kept_off_ = -1;  ///< processor that the thread may not run on; of the caller of begin() alone
  std::mutex mutex_;
  std::condition_variable_any changed_;
  void (*work_)(void*) = nullptr;  ///< nullptr: it is done
  void* argument_ = nullptr;

  std::jthread thread_;  ///< last: ends before what it uses
};

/// The thread for mapping.threads = 2; nullptr for 1.
std::unique_ptr<HelperThread> helper_thread_for(int threads);

}  // namespace planemap::service
