#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <planemap/snapshot.hpp>
#include <stop_token>
#include <unordered_map>
#include <vector>

#include "store/map_file.hpp"
#include "store/map_rows.hpp"
#include "store/sqlite.hpp"

namespace planemap::service {

/// "plnm"; in SQLite's header, so that file(1) can tell.
constexpr std::int64_t kApplicationId = 0x706c6e6d;

/// A map as it is in a file, and the checksums of its rows.
struct ReadMap {
  StoredMap map;
  std::vector<std::uint32_t> blocks;
  std::unordered_map<PlaneId, std::uint32_t> planes;
  FactRows facts;
};

/// Opens a file and looks whether it is a map, of a format that is known; older ones are migrated where they may be
/// written.
StoreExpected<Database> open_database(const std::filesystem::path& path, Database::Access access);
/// Reads all of it at one instant, and verifies it.
StoreExpected<ReadMap> read_map(Database& database, const std::filesystem::path& path);
/// A consistent copy, which appears whole or not at all.
/// @return whether it is done; false: it was stopped before
StoreExpected<bool> copy_database(Database& database, const std::filesystem::path& path,
                                  const std::stop_token& stop = {});

/// A map as a file that is closed in good order, which appears whole or not at all; what had its name is replaced.
StoreExpected<void> write_map_file(const std::filesystem::path& path, const MapFacts& facts,
                                   const std::shared_ptr<const MapSnapshot>& map);

/// Takes out what is whole: blocks and planes whose checksums are right. Labels of planes that are lost are taken off;
/// planes that lost cells go, too, and their cells are without a plane until they are seen again.
struct Recovered {
  StoredMap map;
  std::size_t lost_blocks = 0;  ///< that are there, but not whole; those that are not there cannot be counted
  std::size_t lost_planes = 0;
};
StoreExpected<Recovered> recover_map(const std::filesystem::path& path);

/// The same map, with a table of its own of the same blocks.
MapSnapshot::Parts parts_of(const MapSnapshot& map);

}  // namespace planemap::service
