#include "store/map_file.hpp"

#include <spdlog/fmt/fmt.h>
#include <sqlite3.h>

#include <algorithm>
#include <sstream>
#include <unordered_set>
#include <utility>

#include "common/version.hpp"
#include "store/block_codec.hpp"
#include "store/map_reader.hpp"
#include "store/map_rows.hpp"
#include "store/plane_row_codec.hpp"

namespace planemap::service {
namespace {

/// How far ids and revisions are reserved ahead: what a mapper uses in a second, many times over.
constexpr std::uint64_t kIdsAhead = 4096;
constexpr std::uint64_t kRevisionsAhead = 65536;

constexpr const char* kSchema = R"(
  CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
  CREATE TABLE block (slot INTEGER PRIMARY KEY, x INTEGER NOT NULL, y INTEGER NOT NULL, z INTEGER NOT NULL,
                      cells INTEGER NOT NULL, checksum INTEGER NOT NULL, data BLOB NOT NULL);
  CREATE TABLE plane (id INTEGER PRIMARY KEY, checksum INTEGER NOT NULL, data BLOB NOT NULL);
  CREATE TABLE removed (id INTEGER PRIMARY KEY, merged_into INTEGER NOT NULL, revision INTEGER NOT NULL);
)";

/// Sets a pragma that answers what it made of it.
void set_checked(Database& database, const std::string& name, const std::string& value) {
  const std::string became = database.answer(fmt::format("PRAGMA {}={}", name, value));
  if (became != value) {
    throw SqliteError(SQLITE_READONLY, fmt::format("{} cannot be {}: it stays {}", name, value, became));
  }
}

void prepare_for_writing(Database& database) {
  set_checked(database, "journal_mode", "wal");
  database.execute("PRAGMA synchronous=FULL");  // a commit outlives a power cut, not only a crash
  if (database.answer("PRAGMA synchronous") != "2") throw SqliteError(SQLITE_ERROR, "synchronous cannot be FULL");
  database.execute("PRAGMA wal_autocheckpoint=4096; PRAGMA cell_size_check=ON");
}

tl::unexpected<StoreError> cannot_be_made(const std::filesystem::path& path, const std::string& why) {
  return tl::make_unexpected(
      StoreError{StoreError::Kind::kSystem, fmt::format("{}: the map file cannot be made: {}", path.string(), why)});
}

std::int64_t to_sql(std::uint64_t number) {
  return static_cast<std::int64_t>(number);
}

std::uint64_t raised(std::uint64_t reserved, std::uint64_t used, std::uint64_t ahead, bool closing) {
  if (closing) return used;
  return reserved < used + ahead / 2 ? used + ahead : reserved;
}

}  // namespace

std::optional<Eigen::Vector3d> MapFacts::gravity_direction() const {
  std::istringstream numbers(gravity);
  Eigen::Vector3d direction;
  if (numbers >> direction.x() >> direction.y() >> direction.z() && direction.norm() > 0.5) return direction;
  return std::nullopt;
}

MapSnapshot::Parts StoredMap::continued() const {
  MapSnapshot::Parts parts = parts_of(*snapshot);
  if (!closed) {  // readers may have seen more than was committed: "since" such a revision is answered with the whole
                  // map
    parts.state.next_plane_id = std::max(parts.state.next_plane_id, reserved_ids);
    parts.revision = std::max(parts.revision + 1, reserved_revisions);
    parts.removed_complete_since = parts.revision;
  }
  return parts;
}

MapFile::MapFile(const std::filesystem::path& path, Database database)
    : path_(path), database_(std::make_unique<Database>(std::move(database))) {}

StoreExpected<MapFile> MapFile::create(const std::filesystem::path& path, const MapFacts& facts) {
  try {
    std::filesystem::remove(path);
    for (const char* suffix : kSqliteSuffixes) std::filesystem::remove(path.string() + suffix);
    Database database(path, Database::Access::kCreate);
    database.execute("PRAGMA page_size=1024");  // what does not fill a page is lost: 5 B a cell more at 4096
    database.execute(fmt::format("PRAGMA application_id={}", kApplicationId));
    prepare_for_writing(database);
    database.execute("BEGIN");
    database.execute(kSchema);
    database.execute(fmt::format("PRAGMA user_version={}", kMapFileFormat));
    database.execute("COMMIT");
    MapFile file(path, std::move(database));
    file.facts_ = facts;
    file.is_prepared_ = true;
    return file;
  } catch (const SqliteError& error) {
    return cannot_be_made(path, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return cannot_be_made(path, error.code().message());
  }
}

StoreExpected<MapFile::Opened> MapFile::open(const std::filesystem::path& path) {
  auto opened = open_database(path, Database::Access::kWrite);
  if (!opened) return tl::make_unexpected(opened.error());
  auto map = read_map(*opened, path);
  if (!map) return tl::make_unexpected(map.error());
  MapFile file(path, std::move(*opened));
  file.facts_ = map->map.facts;
  file.last_ = map->map.snapshot;
  file.rows_ = {std::move(map->blocks), std::move(map->planes), std::move(map->facts), map->map.reserved_ids,
                map->map.reserved_revisions};
  return Opened{std::move(file), std::move(map->map)};
}

StoreExpected<StoredMap> MapFile::read(const std::filesystem::path& path) {
  auto opened = open_database(path, Database::Access::kRead);
  if (!opened) return tl::make_unexpected(opened.error());
  auto map = read_map(*opened, path);
  if (!map) return tl::make_unexpected(map.error());
  return std::move(map->map);
}

StoreExpected<std::size_t> MapFile::commit(const std::shared_ptr<const MapSnapshot>& map) {
  return commit(map, false);
}

StoreExpected<std::size_t> MapFile::close(const std::shared_ptr<const MapSnapshot>& map) {
  auto written = commit(map, true);
  if (!written) return written;
  try {
    database_->answer("PRAGMA wal_checkpoint(TRUNCATE)");
    // One file, that can be read where nothing can be written; where somebody else reads it now, it stays as it is.
    database_->answer("PRAGMA journal_mode=DELETE");
  } catch (const SqliteError&) {  // what was committed is in the WAL, which the next one to open it takes in
  }
  return written;
}

StoreExpected<std::size_t> MapFile::commit(const std::shared_ptr<const MapSnapshot>& map, bool closing) {
  Rows rows = rows_;
  try {
    if (!is_prepared_) prepare_for_writing(*database_);
    is_prepared_ = true;
    database_->execute("BEGIN IMMEDIATE");
    const std::size_t written = write(*map, rows, closing);
    database_->execute("COMMIT");
    rows_ = std::move(rows);
    last_ = map;
    return written;
  } catch (const std::exception& error) {
    const std::string message = fmt::format("{}: the map cannot be saved: {}", path_.string(), error.what());
    try {
      database_->execute("ROLLBACK");
    } catch (const SqliteError&) {  // SQLite rolled back by itself
    }
    return tl::make_unexpected(StoreError{StoreError::Kind::kSystem, message});
  }
}

std::size_t MapFile::write(const MapSnapshot& map, Rows& rows, bool closing) {
  const MapSnapshot* last = last_.get();
  std::size_t written = 0;
  if (last == nullptr || last->epoch() != map.epoch()) {
    database_->execute("DELETE FROM block; DELETE FROM plane; DELETE FROM removed");
    rows.blocks.clear();
    rows.planes.clear();
    rows.reserved_ids = 1;
    rows.reserved_revisions = 0;
    last = nullptr;
  }
  written += write_blocks(map, last, rows);
  written += write_planes(map, last, rows);
  written += write_removed(map, last);
  write_facts(map, rows, closing);
  return written;
}

/// Blocks that were not copied since the last commit are the same objects; whole pages of the table, mostly.
std::size_t MapFile::write_blocks(const MapSnapshot& map, const MapSnapshot* last, Rows& rows) {
  Statement put = database_->prepare("REPLACE INTO block VALUES (?,?,?,?,?,?,?)");
  const BlockTable& blocks = map.blocks();
  rows.blocks.resize(blocks.size(), 0);
  std::size_t written = 0;
  for (std::size_t slot = 0; slot < blocks.size(); ++slot) {
    if (last != nullptr && slot % BlockTable::kPageSize == 0 &&
        blocks.shares_page(slot / BlockTable::kPageSize, last->blocks()) &&
        slot + BlockTable::kPageSize <= last->block_count()) {
      slot += BlockTable::kPageSize - 1;
      continue;
    }
    if (last != nullptr && slot < last->block_count() && blocks[slot] == last->blocks()[slot]) continue;
    const Block& block = *blocks[slot];
    const Bytes bytes = encode_block(block);
    const auto key = static_cast<std::int64_t>(slot);
    rows.blocks[slot] = block_checksum(key, block.index(), block.size(), bytes);
    const BlockIndex& index = block.index();
    put.bind(1, key).bind(2, index.x()).bind(3, index.y()).bind(4, index.z());
    put.bind(5, static_cast<std::int64_t>(block.size())).bind(6, rows.blocks[slot]).bind(7, bytes).run();
    ++written;
  }
  return written;
}

std::size_t MapFile::write_planes(const MapSnapshot& map, const MapSnapshot* last, Rows& rows) {
  Statement put = database_->prepare("REPLACE INTO plane VALUES (?,?,?)");
  Statement drop = database_->prepare("DELETE FROM plane WHERE id=?");
  std::size_t written = 0;
  std::size_t old = 0;
  const auto drop_before = [&](PlaneId id) {  // of those that were there
    for (; last != nullptr && old < last->planes().size() && last->planes()[old]->id < id; ++old) {
      drop.bind(1, to_sql(last->planes()[old]->id)).run();
      rows.planes.erase(last->planes()[old]->id);
      ++written;
    }
  };
  for (const auto& plane : map.planes()) {
    drop_before(plane->id);
    if (last != nullptr && old < last->planes().size() && last->planes()[old]->id == plane->id) {
      if (last->planes()[old++] == plane) continue;
    }
    const Bytes bytes = encode_plane(*plane);
    const std::uint32_t checksum = plane_checksum(plane->id, bytes);
    put.bind(1, to_sql(plane->id)).bind(2, checksum).bind(3, bytes).run();
    rows.planes[plane->id] = checksum;
    ++written;
  }
  drop_before(UINT64_MAX);
  return written;
}

/// The list grows at its end and is cut at its front.
std::size_t MapFile::write_removed(const MapSnapshot& map, const MapSnapshot* last) {
  std::unordered_set<PlaneId> old;
  if (last != nullptr) {
    if (last->removed().size() == map.removed().size() &&
        (map.removed().empty() || last->removed().back().id == map.removed().back().id)) {
      return 0;
    }
    for (const RemovedPlane& gone : last->removed()) old.insert(gone.id);
  }
  std::size_t written = 0;
  Statement put = database_->prepare("REPLACE INTO removed VALUES (?,?,?)");
  for (const RemovedPlane& gone : map.removed()) {
    if (old.erase(gone.id) != 0) continue;
    put.bind(1, to_sql(gone.id)).bind(2, to_sql(gone.merged_into)).bind(3, to_sql(gone.revision)).run();
    ++written;
  }
  Statement drop = database_->prepare("DELETE FROM removed WHERE id=?");
  for (const PlaneId id : old) {
    drop.bind(1, to_sql(id)).run();
    ++written;
  }
  return written;
}

void MapFile::write_facts(const MapSnapshot& map, Rows& rows, bool closing) {
  const MapperState& state = map.state();
  rows.reserved_ids = raised(rows.reserved_ids, state.next_plane_id, kIdsAhead, closing);
  rows.reserved_revisions = raised(rows.reserved_revisions, map.revision() + 1, kRevisionsAhead, closing);
  FactRows facts;
  facts["format"] = std::to_string(kMapFileFormat);
  facts["version"] = version();
  facts["frame"] = facts_.frame;
  facts["gravity"] = facts_.gravity;
  facts["config"] = facts_.config;
  facts["epoch"] = std::to_string(map.epoch());
  facts["revision"] = std::to_string(map.revision());
  facts["utime"] = std::to_string(map.utime());
  facts["cell_size_m"] = text_of(map.cell_size_m());
  facts["density_threshold"] = std::to_string(map.density_threshold());
  facts["removed_complete_since"] = std::to_string(map.removed_complete_since());
  facts["next_plane_id"] = std::to_string(state.next_plane_id);
  facts["reserved_ids"] = std::to_string(rows.reserved_ids);
  facts["reserved_revisions"] = std::to_string(rows.reserved_revisions);
  facts["closed"] = closing ? "1" : "0";
  facts["poses_err"] = state.poses_err ? "1" : "0";
  facts["pose_variance_m2"] = text_of(state.pose_variance_m2);
  facts["scans"] = std::to_string(state.scans);
  std::string pose;
  for (Eigen::Index i = 0; i < 36; ++i) pose += (i == 0 ? "" : " ") + text_of(state.last_pose.data()[i]);
  facts["last_pose"] = pose;
  facts["blocks"] = std::to_string(map.block_count());
  facts["cells"] = std::to_string(map.cell_count());
  facts["planes"] = std::to_string(map.planes().size());
  facts["removed"] = std::to_string(map.removed().size());
  std::uint64_t digest = 0;
  for (const std::uint32_t checksum : rows.blocks) digest += checksum;
  for (const auto& plane : rows.planes) digest += plane.second;
  for (const RemovedPlane& gone : map.removed()) digest += removed_checksum(gone);
  facts["digest"] = std::to_string(digest);
  facts["checksum"] = facts_checksum(facts);
  Statement put = database_->prepare("REPLACE INTO meta VALUES (?,?)");
  for (const auto& [key, value] : facts) {
    const auto known = rows.facts.find(key);
    if (known == rows.facts.end() || known->second != value) put.bind(1, key).bind(2, value).run();
  }
  rows.facts = std::move(facts);
}

}  // namespace planemap::service
