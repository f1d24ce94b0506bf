#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace planemap::test {

// A program that links this counts what operator new is asked for, by thread. Nothing of it allocates while it counts.

/// From now on, and from zero, of the calling thread.
void begin_counting_allocations();
/// Of the calling thread since it began; goes on after the end of counting, but does not grow.
std::uint64_t allocations();
void end_counting_allocations();

/// Whether the counted allocations' callers are kept, of all threads; takes some microseconds for each.
void keep_callers(bool keep);
/// Who asked most often, a line for each: how often, and the innermost two functions of the project with their lines.
/// Asks addr2line, which comes with the compiler.
/// @param most  lines
std::string callers(std::size_t most);

}  // namespace planemap::test
