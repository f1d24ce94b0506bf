#include "store/map_file.hpp"

#include <planemap/mapper.hpp>

#include "fuzz_input.hpp"
#include "store/map_reader.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  const MemoryFile file({data, size});
  const auto read = service::MapFile::read(file.path());
  require(read || !read.error().message.empty(), "an error without words");
  if (read) {
    require(read->snapshot != nullptr, "no map");
    MapperConfig config = preset(Preset::kBest);
    config.grid.cell_size_m = read->snapshot->cell_size_m();
    (void)Mapper::restore(config, *read->snapshot);
  }
  (void)service::recover_map(file.path());
  return 0;
}
