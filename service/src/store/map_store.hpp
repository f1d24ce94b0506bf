#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <planemap/expected.hpp>
#include <planemap/snapshot.hpp>
#include <string>

#include "config/service_config.hpp"
#include "store/file_lock.hpp"
#include "store/map_file.hpp"

namespace planemap::service {

/// A map file that is the process's own, and the map to begin with.
struct MapStore {
  std::filesystem::path path;
  FileLock lock;
  MapFacts facts;
  std::unique_ptr<MapFile> file;               ///< nullptr: it cannot be written now
  std::shared_ptr<const MapSnapshot> initial;  ///< nullptr: an empty map
  std::string problem;                         ///< why there is no file; empty: there is
};

/// Opens the file that the configuration names, or makes a new one; ids and revisions are reserved when this returns,
/// or the map is in a new epoch, and `problem` says why. A
/// damaged file is set aside as PATH.damaged-UTC, said loudly; the map is then that of PATH.backup in a new epoch,
/// else empty. The error says why the service must not start: a newer format, another program's file, a map of
/// another frame or cell size, a file that another process has open, or one that is there and cannot be read.
/// @param new_epoch  of a map that begins, below 2^53, greater than those of all before
Expected<MapStore> open_store(const ServiceConfig& config, std::uint64_t new_epoch);

/// What a configuration says of its map.
MapFacts facts_of(const ServiceConfig& config);

}  // namespace planemap::service
