// Loses a block of the heap: LeakSanitizer must say so.
#include <cstdio>

int main(int argc, char** argv) {
  (void)argv;
  int* volatile lost = new int[16];
  lost[argc] = argc;
  std::printf("%d\n", lost[argc]);
  lost = nullptr;
  return 0;
}
