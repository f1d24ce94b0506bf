#include "store/map_store.hpp"

#include <spdlog/fmt/chrono.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <ctime>
#include <system_error>
#include <utility>

#include "store/map_reader.hpp"

namespace planemap::service {
namespace {

namespace fs = std::filesystem;
using Kind = StoreError::Kind;

/// Why a map of a file is not that of the configuration; empty: it is.
std::string mismatch(const StoredMap& map, const ServiceConfig& config) {
  if (map.facts.frame != config.map.frame) {
    return fmt::format("its frame is '{}', the configuration's '{}' (map.frame)", map.facts.frame, config.map.frame);
  }
  const double cell_m = map.snapshot->cell_size_m();
  if (cell_m != config.mapper.grid.cell_size_m) {
    return fmt::format("its cells are {} m wide, the configuration's {} m (grid.cell_size_m)", cell_m,
                       config.mapper.grid.cell_size_m);
  }
  return {};
}

/// Renames the file and what SQLite has beside it.
/// @param why  one word, part of the new name
/// @return the new name; empty: it cannot be renamed
fs::path set_aside(const fs::path& path, const char* why) {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const std::string name = fmt::format("{}.{}-{:%Y%m%dT%H%M%SZ}", path.string(), why, fmt::gmtime(now));
  fs::path aside = name;
  for (int n = 2; fs::exists(aside); ++n) aside = fmt::format("{}-{}", name, n);
  std::error_code problem;
  fs::rename(path, aside, problem);
  if (problem) return {};
  for (const char* suffix : kSqliteSuffixes) {
    std::error_code none;
    fs::rename(path.string() + suffix, aside.string() + suffix, none);
  }
  return aside;
}

std::shared_ptr<const MapSnapshot> with_epoch(MapSnapshot::Parts parts, std::uint64_t epoch) {
  parts.epoch = epoch;
  return std::make_shared<const MapSnapshot>(std::move(parts));
}

/// An empty map, for the first commit of a new file.
std::shared_ptr<const MapSnapshot> empty_map(const ServiceConfig& config, std::uint64_t epoch) {
  MapSnapshot::Parts parts;
  parts.epoch = epoch;
  parts.cell_size_m = config.mapper.grid.cell_size_m;
  parts.density_threshold = config.mapper.grid.density_threshold;
  parts.state.last_pose = configured_covariance(config.mapper.pose_error);
  return std::make_shared<const MapSnapshot>(std::move(parts));
}

void begin_file(MapStore& store, const ServiceConfig& config, std::uint64_t new_epoch) {
  auto file = MapFile::create(store.path, store.facts);
  if (!file) {
    store.problem = file.error().message;
    return;
  }
  if (auto written = file->commit(store.initial ? store.initial : empty_map(config, new_epoch)); !written) {
    store.problem = written.error().message;
    return;
  }
  store.file = std::make_unique<MapFile>(std::move(*file));
}

fs::path backup_of(const fs::path& path) {
  return path.string() + ".backup";
}

/// A map begins where there was one whose file has gone: its backup is not written over.
void keep_old_backup(const fs::path& path) {
  const fs::path backup = backup_of(path);
  if (!fs::exists(backup)) return;
  spdlog::warn("{}: there is no such file, but a backup of one: it is not used, and kept as {}", path.string(),
               set_aside(backup, "unused").string());
}

/// After damage: the last good backup, in an epoch of its own, since what came after it was seen and is lost.
void take_backup(MapStore& store, const ServiceConfig& config, std::uint64_t new_epoch) {
  const fs::path backup = backup_of(store.path);
  if (!fs::exists(backup)) {
    spdlog::error("{}: there is no backup: the map begins empty", store.path.string());
    return;
  }
  auto map = MapFile::read(backup);
  const std::string why = map ? mismatch(*map, config) : map.error().message;
  if (!why.empty()) {
    spdlog::error("{}: the backup cannot be used either: {}; the map begins empty, the backup is kept as {}",
                  backup.string(), why, set_aside(backup, "unused").string());
    return;
  }
  map->closed = false;
  store.initial = with_epoch(map->continued(), new_epoch);
  spdlog::error("{}: going on with the backup: {} planes, {} cells, in a new epoch {}", backup.string(),
                store.initial->planes().size(), store.initial->cell_count(), new_epoch);
}

Expected<void> go_on(MapStore& store, MapFile::Opened opened, const ServiceConfig& config, std::uint64_t new_epoch) {
  if (const std::string why = mismatch(opened.map, config); !why.empty()) {
    return fail(fmt::format("{}: {}; set that, or use another file", store.path.string(), why));
  }
  store.initial = std::make_shared<const MapSnapshot>(opened.map.continued());
  opened.file.set_facts(store.facts);
  spdlog::info(
      "{}: going on with {} planes, {} cells, epoch {}, revision {}{}", store.path.string(),
      store.initial->planes().size(), store.initial->cell_count(), store.initial->epoch(), store.initial->revision(),
      opened.map.closed ? "" : "; it was not closed in good order, so ids and revisions skip what was reserved");
  if (auto written = opened.file.commit(store.initial); !written) {
    store.problem = written.error().message;
    store.initial = with_epoch(opened.map.continued(), new_epoch);
    spdlog::error("{}; mapping goes on in a new epoch, {}, as nothing can be reserved in the old one", store.problem,
                  new_epoch);
  }
  store.file = std::make_unique<MapFile>(std::move(opened.file));
  return {};
}

}  // namespace

MapFacts facts_of(const ServiceConfig& config) {
  MapFacts facts;
  facts.frame = config.map.frame;
  for (const double x : config.map.gravity)
    facts.gravity += (facts.gravity.empty() ? "" : " ") + fmt::format("{:.17g}", x);
  facts.config = to_yaml(config);
  return facts;
}

Expected<MapStore> open_store(const ServiceConfig& config, std::uint64_t new_epoch) {
  MapStore store;
  store.path = config.store.path;
  store.facts = facts_of(config);
  auto lock = FileLock::take(store.path);
  if (!lock) return tl::make_unexpected(lock.error());
  store.lock = std::move(*lock);
  std::error_code problem;
  if (!fs::exists(store.path, problem)) {
    keep_old_backup(store.path);
    begin_file(store, config, new_epoch);
    if (store.file) spdlog::info("{}: a new map file, epoch {}", store.path.string(), new_epoch);
    return store;
  }
  auto opened = MapFile::open(store.path);
  if (opened) {
    if (auto good = go_on(store, std::move(*opened), config, new_epoch); !good)
      return tl::make_unexpected(good.error());
    return store;
  }
  if (opened.error().kind != Kind::kDamaged) return fail(opened.error().message);
  const fs::path aside = set_aside(store.path, "damaged");
  if (aside.empty()) return fail(opened.error().message + "; the file is damaged, and cannot be renamed");
  spdlog::error("THE MAP FILE IS DAMAGED: {}. It is kept as {}; 'planemap recover {} -o OUT' takes out what is whole",
                opened.error().message, aside.string(), aside.string());
  take_backup(store, config, new_epoch);
  begin_file(store, config, new_epoch);
  return store;
}

}  // namespace planemap::service
