#include "support/allocation_count.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <sstream>
#include <string_view>
#include <vector>

namespace planemap::test {
namespace {

constexpr int kFrames = 24;
constexpr std::size_t kMaxStacks = 8192;  // different ones; a power of two

struct Stack {
  std::array<void*, kFrames> frames;
  int size = 0;
  std::uint64_t count = 0;
};

thread_local bool t_is_counting = false;
thread_local std::uint64_t t_count = 0;
std::atomic<bool> g_keeps_callers{false};
std::mutex g_mutex;  // of the stacks
std::array<Stack, kMaxStacks> g_stacks;
std::uint64_t g_not_kept = 0;  // the table was full

void keep_stack() {
  t_is_counting = false;  // what is called here may allocate
  std::array<void*, kFrames> frames;
  const int size = backtrace(frames.data(), kFrames);
  std::size_t hash = 0;
  for (int i = 0; i < size; ++i) {
    hash = (hash ^ reinterpret_cast<std::size_t>(frames[i])) * std::size_t{0x9e3779b97f4a7c15U};
  }
  {
    const std::lock_guard lock(g_mutex);
    bool is_kept = false;
    for (std::size_t probe = 0; probe < kMaxStacks && !is_kept; ++probe) {
      Stack& stack = g_stacks[((hash >> 40U) + probe) & (kMaxStacks - 1)];
      is_kept = stack.count == 0 ||
                (stack.size == size && std::equal(frames.begin(), frames.begin() + size, stack.frames.begin()));
      if (!is_kept) continue;
      stack.frames = frames;
      stack.size = size;
      ++stack.count;
    }
    if (!is_kept) ++g_not_kept;
  }
  t_is_counting = true;
}

void note() {
  if (!t_is_counting) return;
  ++t_count;
  if (g_keeps_callers) keep_stack();
}

void* allocate(std::size_t size) {
  note();
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}

void* allocate(std::size_t size, std::align_val_t alignment) {
  note();
  const auto step = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(step, (std::max<std::size_t>(size, 1) + step - 1) / step * step)) return memory;
  throw std::bad_alloc();
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> piece;
  while (const std::size_t read = fread(piece.data(), 1, piece.size(), pipe)) text.append(piece.data(), read);
  pclose(pipe);
  return text;
}

/// Functions and lines of return addresses in this program, innermost first: for each address those that were inlined,
/// too. Pairs of lines, as addr2line gives them.
std::vector<std::string> places_of(const Stack& stack) {
  std::ostringstream command;
  command << "addr2line -f -C -i -e /proc/" << getpid() << "/exe" << std::hex;
  for (int i = 0; i < stack.size; ++i) {
    Dl_info where{};
    if (dladdr(stack.frames[i], &where) == 0) continue;
    const auto offset =
        reinterpret_cast<std::uintptr_t>(stack.frames[i]) - reinterpret_cast<std::uintptr_t>(where.dli_fbase);
    command << " 0x" << offset - 1;
  }
  std::istringstream lines(output_of(command.str() + " 2>/dev/null"));
  std::vector<std::string> places;
  for (std::string line; std::getline(lines, line);) places.push_back(line);
  return places;
}

/// The innermost two functions of the project.
std::string own_functions_of(const Stack& stack) {
  const std::vector<std::string> places = places_of(stack);
  std::string text;
  int found = 0;
  for (std::size_t i = 0; i + 1 < places.size() && found < 2; i += 2) {
    std::string name = places[i];
    constexpr std::string_view kAnonymous = "(anonymous namespace)::";
    for (std::size_t at = 0; (at = name.find(kAnonymous)) != std::string::npos;) name.erase(at, kAnonymous.size());
    name.resize(std::min(name.find_first_of("<("), name.size()));  // without arguments
    if (name.find("planemap::") == std::string::npos || name.find("planemap::test::") != std::string::npos) continue;
    text += (found == 0 ? "" : "  <-  ") + name + " (" + std::filesystem::path(places[i + 1]).filename().string() + ")";
    ++found;
  }
  return found > 0 ? text : "none of the project's functions";
}

}  // namespace

void begin_counting_allocations() {
  std::array<void*, 1> frame;
  backtrace(frame.data(), 1);  // loads what it needs, once
  t_count = 0;
  t_is_counting = true;
}

std::uint64_t allocations() {
  return t_count;
}

void end_counting_allocations() {
  t_is_counting = false;
}

void keep_callers(bool keep) {
  g_keeps_callers = keep;
}

std::string callers(std::size_t most) {
  std::map<std::string, std::uint64_t> counts;
  const std::lock_guard lock(g_mutex);
  for (const Stack& stack : g_stacks) {
    if (stack.count > 0) counts[own_functions_of(stack)] += stack.count;
  }
  if (g_not_kept > 0) counts["others, too many to be kept apart"] = g_not_kept;
  std::vector<std::pair<std::uint64_t, std::string>> sorted;
  sorted.reserve(counts.size());
  for (const auto& [place, count] : counts) sorted.emplace_back(count, place);
  std::sort(sorted.rbegin(), sorted.rend());
  std::ostringstream text;
  for (std::size_t i = 0; i < std::min(most, sorted.size()); ++i) {
    text << sorted[i].first << "  " << sorted[i].second << "\n";
  }
  return text.str();
}

}  // namespace planemap::test

void* operator new(std::size_t size) {
  return planemap::test::allocate(size);
}
void* operator new[](std::size_t size) {
  return planemap::test::allocate(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return planemap::test::allocate(size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return planemap::test::allocate(size, alignment);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
