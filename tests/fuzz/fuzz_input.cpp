#include "fuzz_input.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace planemap::fuzz {

void finding(const char* what) {
  std::fprintf(stderr, "FINDING: %s\n", what);
  std::abort();
}

Bytes lcm_message(Input input, std::initializer_list<std::int64_t> fingerprints) {
  const auto fingerprint = static_cast<std::uint64_t>(fingerprints.begin()[take_choice(input, fingerprints.size())]);
  Bytes message;
  message.reserve(sizeof fingerprint + input.size());
  for (int shift = 56; shift >= 0; shift -= 8) message.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  message.insert(message.end(), input.begin(), input.end());
  return message;
}

MemoryFile::MemoryFile(Input bytes) : descriptor_(memfd_create("planemap-fuzz", MFD_CLOEXEC)) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = write(descriptor_, bytes.data() + done, bytes.size() - done);
    require(written > 0, "a file in memory can't be written");
    done += static_cast<std::size_t>(written);
  }
  std::snprintf(path_, sizeof path_, "/proc/self/fd/%d", descriptor_);
}

MemoryFile::~MemoryFile() {
  close(descriptor_);
}

}  // namespace planemap::fuzz
