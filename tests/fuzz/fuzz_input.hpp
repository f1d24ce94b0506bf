#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

// What every target has: libFuzzer's entry point is LLVMFuzzerTestOneInput; in builds without libFuzzer replay.cpp
// calls it with the files of the corpus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace planemap::fuzz {

using Bytes = std::vector<std::uint8_t>;
using Input = std::span<const std::uint8_t>;

/// Ends the process, so that the fuzzer keeps the input.
[[noreturn]] void finding(const char* what);
inline void require(bool holds, const char* what) {
  if (!holds) finding(what);
}

/// Takes the first byte as a number below `choices`. @pre choices > 0
inline std::size_t take_choice(Input& input, std::size_t choices) {
  if (input.empty()) return 0;
  const std::size_t choice = input[0] % choices;
  input = input.subspan(1);
  return choice;
}

/// An LCM message: the first byte chooses one of the fingerprints, what follows comes behind it. The fuzzer would never
/// guess a fingerprint.
Bytes lcm_message(Input input, std::initializer_list<std::int64_t> fingerprints);

/// A file in memory with these bytes, for what reads by name; gone with the object.
class MemoryFile {
 public:
  explicit MemoryFile(Input bytes);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const char* path() const { return path_; }

 private:
  int descriptor_ = -1;
  char path_[64] = {};
};

}  // namespace planemap::fuzz
