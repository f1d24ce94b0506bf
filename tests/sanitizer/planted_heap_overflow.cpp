// Reads behind the end of a block of the heap: AddressSanitizer must say so.
#include <cstdio>
#include <vector>

int main(int argc, char** argv) {
  (void)argv;
  const std::vector<int> numbers(4, argc);
  const int* first = numbers.data();
  std::printf("%d\n", first[3 + argc]);
  return 0;
}
