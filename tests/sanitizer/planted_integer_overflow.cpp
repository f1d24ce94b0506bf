// Overflows a signed integer: UndefinedBehaviorSanitizer must say so.
#include <cstdio>
#include <limits>

int main(int argc, char** argv) {
  (void)argv;
  std::printf("%d\n", std::numeric_limits<int>::max() - 1 + 2 * argc);
  return 0;
}
