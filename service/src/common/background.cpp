#include "common/background.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>

namespace planemap::service {

void run_in_background([[maybe_unused]] int steps) noexcept {
#ifdef __linux__
  constexpr int kLeast = 19;
  errno = 0;
  const int now = getpriority(PRIO_PROCESS, 0);  // 0: the calling thread
  if (errno == 0) setpriority(PRIO_PROCESS, 0, std::min(kLeast, now + steps));
#endif
}

}  // namespace planemap::service
