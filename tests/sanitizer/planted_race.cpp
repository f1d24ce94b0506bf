// Two threads write one number without a lock: ThreadSanitizer must say so.
#include <cstdio>
#include <thread>

int main() {
  int shared = 0;
  const auto write = [&shared] {
    for (int i = 0; i < 1000; ++i) ++shared;
  };
  std::thread first(write);
  std::thread second(write);
  first.join();
  second.join();
  std::printf("%d\n", shared);
  return 0;
}
