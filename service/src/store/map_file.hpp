#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/snapshot.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "store/sqlite.hpp"

namespace planemap::service {

/// The format that this version writes, and the newest that it reads (docs/map_file.md).
constexpr int kMapFileFormat = 1;

/// Why a map file could not be used.
struct StoreError {
  enum class Kind {
    kSystem,   ///< the disk is full, the folder read-only, there is no file, ...
    kDamaged,  ///< it is not as it was written
    kNewer,    ///< of a version to come
    kOther,    ///< another program's database, or a map that does not fit
  };
  Kind kind = Kind::kSystem;
  std::string message;  ///< a sentence with the file's name
};
template <class T>
using StoreExpected = tl::expected<T, StoreError>;

/// What a file says of its map beside the map itself.
struct MapFacts {
  std::string frame = "world";
  std::string gravity;  ///< x y z, down in the world frame; empty: not known
  std::string config;   ///< YAML that the map was made with
  std::string version;  ///< of the program that wrote it

  std::optional<Eigen::Vector3d> gravity_direction() const;  ///< empty: not known
};

/// What is in a file.
struct StoredMap {
  /// As it was last committed.
  std::shared_ptr<const MapSnapshot> snapshot;
  MapFacts facts;
  int format = kMapFileFormat;
  std::uint64_t bytes = 0;               ///< of the file, with what waits beside it in the WAL
  PlaneId reserved_ids = 1;              ///< ids below this may be known to a reader
  std::uint64_t reserved_revisions = 0;  ///< and revisions below this
  bool closed = false;                   ///< it was closed in good order: nothing beyond what is in it was seen

  /// The map to go on with: behind all that a reader may have seen.
  MapSnapshot::Parts continued() const;
};

/// A map in one SQLite database. Each commit is one transaction; a checksum of each row, one of all rows and one of the
/// facts tell whether what is read is what was committed, all of it and nothing older.
class MapFile {
 public:
  /// A new file; what was there is written over. In WAL mode.
  static StoreExpected<MapFile> create(const std::filesystem::path& path, const MapFacts& facts);
  struct Opened;
  /// Opens, migrates and verifies a file, to go on with it; the first commit changes it.
  static StoreExpected<Opened> open(const std::filesystem::path& path);
  /// Reads a file without changing it; also one that a daemon is writing.
  static StoreExpected<StoredMap> read(const std::filesystem::path& path);

  /// Writes what changed since the last commit; of a map of another epoch all. Ids and revisions are reserved ahead.
  /// @return rows that were written or removed
  StoreExpected<std::size_t> commit(const std::shared_ptr<const MapSnapshot>& map);
  /// Frame, gravity and configuration, with the next commit.
  void set_facts(const MapFacts& facts) { facts_ = facts; }
  /// The map as it was last committed; nullptr: nothing was.
  const std::shared_ptr<const MapSnapshot>& committed() const { return last_; }
  /// The last commit: marks are what was used, so that nothing is skipped, and the file is one file without a WAL.
  StoreExpected<std::size_t> close(const std::shared_ptr<const MapSnapshot>& map);

 private:
  MapFile(const std::filesystem::path& path, Database database);

  /// What is known of the rows, as of the last commit.
  struct Rows {
    std::vector<std::uint32_t> blocks;                  ///< checksum by slot
    std::unordered_map<PlaneId, std::uint32_t> planes;  ///< checksum by id
    std::map<std::string, std::string> facts;           ///< of the table meta
    PlaneId reserved_ids = 1;
    std::uint64_t reserved_revisions = 0;
  };

  StoreExpected<std::size_t> commit(const std::shared_ptr<const MapSnapshot>& map, bool closing);
  std::size_t write(const MapSnapshot& map, Rows& rows, bool closing);
  std::size_t write_blocks(const MapSnapshot& map, const MapSnapshot* last, Rows& rows);
  std::size_t write_planes(const MapSnapshot& map, const MapSnapshot* last, Rows& rows);
  std::size_t write_removed(const MapSnapshot& map, const MapSnapshot* last);
  void write_facts(const MapSnapshot& map, Rows& rows, bool closing);

  std::filesystem::path path_;
  std::unique_ptr<Database> database_;
  MapFacts facts_;
  std::shared_ptr<const MapSnapshot> last_;  ///< as committed; its blocks and records tell what changed since
  Rows rows_;
  bool is_prepared_ = false;  ///< the connection is set up for commits
};

struct MapFile::Opened {
  MapFile file;
  StoredMap map;
};

}  // namespace planemap::service
