#include "fuzz_input.hpp"
#include "ingest/lcm_log_reader.hpp"
#include "memory_bound.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  const MemoryFile file({data, size});
  auto reader = service::LcmLogReader::open(file.path());
  require(reader.has_value(), "a file in memory can't be opened");
  std::uint64_t taken = 0;
  while (const auto event = reader->next()) {
    taken += service::LcmLogReader::kHeaderBytes + event->channel.size() + event->data.size();
    require(reader->position_bytes() <= size, "it read beyond the end");
  }
  require(taken + reader->gap_bytes() == size, "bytes that are neither of an event nor counted as a gap");
  return 0;
}
