#include "memory_bound.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PLANEMAP_MEASURES_MEMORY
#include <sanitizer/allocator_interface.h>
#endif
#endif

namespace planemap::fuzz {
namespace {

struct Meter {
  bool is_on = false;
  std::int64_t held = 0;
  std::int64_t peak = 0;
};
thread_local Meter t_meter;

#ifdef PLANEMAP_MEASURES_MEMORY
void note_malloc(const volatile void*, std::size_t size) {
  if (!t_meter.is_on) return;
  t_meter.held += static_cast<std::int64_t>(size);
  t_meter.peak = std::max(t_meter.peak, t_meter.held);
}

void note_free(const volatile void* memory) {
  if (!t_meter.is_on || memory == nullptr) return;
  t_meter.held -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(const_cast<const void*>(memory)));
}

const bool kHooked = __sanitizer_install_malloc_and_free_hooks(note_malloc, note_free) != 0;
#endif

}  // namespace

MemoryBound::MemoryBound(std::size_t most_bytes) : most_bytes_(most_bytes) {
  t_meter = Meter{true, 0, 0};
}

MemoryBound::~MemoryBound() {
  t_meter.is_on = false;
}

void MemoryBound::check(const char* what) const {
  t_meter.is_on = false;
#ifdef PLANEMAP_MEASURES_MEMORY
  if (!kHooked) std::abort();
#endif
  if (t_meter.peak <= static_cast<std::int64_t>(most_bytes_)) return;
  std::fprintf(stderr, "FINDING: %s held %lld bytes, at most %zu are allowed\n", what,
               static_cast<long long>(t_meter.peak), most_bytes_);
  std::abort();
}

}  // namespace planemap::fuzz
