#include "store/map_reader.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "store/map_parts.hpp"

namespace planemap::service {
namespace {

namespace fs = std::filesystem;
using Kind = StoreError::Kind;

tl::unexpected<StoreError> error_of(Kind kind, const fs::path& path, const std::string& what) {
  return tl::make_unexpected(StoreError{kind, fmt::format("{}: {}", path.string(), what)});
}

tl::unexpected<StoreError> error_of(const fs::path& path, const SqliteError& error) {
  return error_of(error.is_damage() ? Kind::kDamaged : Kind::kSystem, path, error.what());
}

std::vector<RemovedPlane> read_removed(Database& database) {
  std::vector<RemovedPlane> removed;
  Statement rows = database.prepare("SELECT id, merged_into, revision FROM removed ORDER BY revision, id");
  while (rows.step()) {
    removed.push_back({static_cast<PlaneId>(rows.integer(0)), static_cast<PlaneId>(rows.integer(1)),
                       static_cast<std::uint64_t>(rows.integer(2))});
  }
  return removed;
}

void expect_count(const FactRows& rows, const char* key, std::size_t count) {
  const auto stated = Facts(rows).whole<std::size_t>(key);
  if (stated != count) throw Damage(fmt::format("it has {} {}, but says {}", count, key, stated));
}

ReadMap read_whole(Database& database) {
  ReadMap read;
  read.facts = read_facts(database);
  const Facts facts(read.facts);
  if (facts.text("checksum") != facts_checksum(read.facts)) throw Damage("the checksum of meta is wrong");
  MapSnapshot::Parts parts;
  take_facts(read.facts, read.map, parts);
  std::uint64_t digest = 0;
  read_blocks(database, 0, [&](std::int64_t slot, Expected<std::shared_ptr<Block>> block, std::uint32_t checksum) {
    if (!block) throw Damage(fmt::format("block {}: {}", slot, block.error().message));
    if (slot != static_cast<std::int64_t>(parts.blocks.size()))
      throw Damage(fmt::format("block {} is missing", parts.blocks.size()));
    parts.cell_count += (*block)->size();
    parts.blocks.push_back(std::move(*block));
    read.blocks.push_back(checksum);
    digest += checksum;
  });
  read_planes(database, 0, [&](PlaneId id, Expected<std::shared_ptr<const PlaneRecord>> plane, std::uint32_t checksum) {
    if (!plane) throw Damage(fmt::format("plane {}: {}", id, plane.error().message));
    parts.planes.push_back(std::move(*plane));
    read.planes.emplace(id, checksum);
    digest += checksum;
  });
  parts.removed = read_removed(database);
  for (const RemovedPlane& gone : parts.removed) digest += removed_checksum(gone);
  expect_count(read.facts, "blocks", parts.blocks.size());
  expect_count(read.facts, "cells", parts.cell_count);
  expect_count(read.facts, "planes", parts.planes.size());
  expect_count(read.facts, "removed", parts.removed.size());
  if (facts.whole<std::uint64_t>("digest") != digest) throw Damage("rows are missing, or older than the others");
  read.map.snapshot = std::make_shared<const MapSnapshot>(std::move(parts));
  if (auto good = check_stored(*read.map.snapshot); !good) throw Damage(good.error().message);
  return read;
}

/// Steps from older formats to newer ones: the n-th takes a file of format n + 1 to format n + 2. Format 1 is the
/// first.
using Migration = void (*)(Database&);
constexpr std::array<Migration, kMapFileFormat - 1> kMigrations{};

void migrate(Database& database, int format) {
  database.execute("BEGIN IMMEDIATE");
  for (std::size_t step = static_cast<std::size_t>(format) - 1; step < kMigrations.size(); ++step)
    kMigrations.at(step)(database);
  database.execute(fmt::format("PRAGMA user_version={}", kMapFileFormat));
  database.execute("COMMIT");
}

/// Without a WAL nothing is written that is not in the file: it can be read though its folder cannot be written.
std::string immutable_uri(const fs::path& path) {
  std::string escaped;
  for (const char c : fs::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      escaped += fmt::format("%{:02x}", static_cast<unsigned>(c));
    } else {
      escaped += c;
    }
  }
  return "file:" + escaped + "?immutable=1";
}

/// The smallest page that SQLite has.
constexpr std::uintmax_t kLeastBytes = 512;

/// Whether a file's first bytes are another format's, rather than those of a damaged database.
bool is_something_else(const fs::path& path) {
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  std::array<char, 16> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  const auto size = static_cast<std::size_t>(file.gcount());
  std::size_t alike = 0;
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < size; ++i) {
    alike += head.at(i) == kMagic[i] ? 1U : 0U;
    zeros += head.at(i) == '\0' ? 1U : 0U;
  }
  return 2 * alike < size && zeros < size;
}

std::uint64_t whole_number(const std::string& digits) {
  return std::strtoull(digits.c_str(), nullptr, 10);
}

/// A finished file takes its name; what SQLite has beside a file that had it before would be taken for the new one's.
void put_in_place(const fs::path& part, const fs::path& path) {
  for (const char* suffix : kSqliteSuffixes) fs::remove(path.string() + suffix);
  fs::rename(part, path);
}

}  // namespace

StoreExpected<Database> open_database(const fs::path& path, Database::Access access) {
  std::error_code problem;
  if (!fs::exists(path, problem)) return error_of(Kind::kSystem, path, "there is no such file");
  if (fs::is_directory(path, problem)) return error_of(Kind::kOther, path, "is a folder");
  const auto size = fs::file_size(path, problem);
  if (size == 0 && !problem) return error_of(Kind::kDamaged, path, "the file is empty");
  if (is_something_else(path)) return error_of(Kind::kOther, path, "is no map file: it is none of SQLite's databases");
  if (size < kLeastBytes && !problem) return error_of(Kind::kDamaged, path, "the file is cut short");  // new, to SQLite
  try {
    const bool alone = access == Database::Access::kRead && !fs::exists(path.string() + "-wal");
    Database database(alone ? fs::path(immutable_uri(path)) : path, access);
    const std::int64_t application = std::atoll(database.answer("PRAGMA application_id").c_str());
    const int format = std::atoi(database.answer("PRAGMA user_version").c_str());
    const bool has_meta = !database.answer("SELECT name FROM sqlite_master WHERE name='meta'").empty();
    if (application != kApplicationId) {
      if (has_meta) return error_of(Kind::kDamaged, path, "the mark of a map file is missing");
      return error_of(Kind::kOther, path, "is a database, but none of planemap's");
    }
    if (!has_meta) return error_of(Kind::kDamaged, path, "the table meta is missing");
    const FactRows facts = read_facts(database);
    const auto stated = facts.find("format");
    if (stated == facts.end() || stated->second != std::to_string(format) || format < 1) {
      return error_of(Kind::kDamaged, path, "it does not say of what format it is");
    }
    if (format > kMapFileFormat) {
      return error_of(Kind::kNewer, path,
                      fmt::format("was written by a newer planemap (format {}, this one knows up to {}): use that "
                                  "version, or another file",
                                  format, kMapFileFormat));
    }
    if (format < kMapFileFormat && access != Database::Access::kRead) migrate(database, format);
    return database;
  } catch (const SqliteError& error) {
    return error_of(path, error);
  }
}

StoreExpected<ReadMap> read_map(Database& database, const fs::path& path) {
  try {
    database.execute("BEGIN");
    if (const std::string state = database.answer("PRAGMA quick_check(1)"); state != "ok") throw Damage(state);
    ReadMap read = read_whole(database);
    read.map.bytes =
        whole_number(database.answer("PRAGMA page_count")) * whole_number(database.answer("PRAGMA page_size"));
    database.execute("COMMIT");
    return read;
  } catch (const Damage& damage) {
    return error_of(Kind::kDamaged, path, damage.what());
  } catch (const SqliteError& error) {
    return error_of(path, error);
  }
}

StoreExpected<bool> copy_database(Database& database, const fs::path& path, const std::stop_token& stop) {
  const fs::path part = path.string() + ".part";
  try {
    const bool done = database.copy_to(part, stop);
    if (done) {
      put_in_place(part, path);
    } else {
      fs::remove(part);
    }
    return done;
  } catch (const SqliteError& error) {
    std::error_code ignored;
    fs::remove(part, ignored);
    return error_of(Kind::kSystem, path, fmt::format("the copy cannot be written: {}", error.what()));
  } catch (const fs::filesystem_error& error) {
    return error_of(Kind::kSystem, path, fmt::format("the copy cannot be written: {}", error.code().message()));
  }
}

StoreExpected<void> write_map_file(const fs::path& path, const MapFacts& facts,
                                   const std::shared_ptr<const MapSnapshot>& map) {
  const fs::path part = path.string() + ".part";
  try {
    {
      auto file = MapFile::create(part, facts);
      if (!file) return tl::make_unexpected(file.error());
      if (auto written = file->close(map); !written) return tl::make_unexpected(written.error());
    }
    put_in_place(part, path);
    return {};
  } catch (const fs::filesystem_error& error) {
    return error_of(Kind::kSystem, path, fmt::format("the map cannot be written: {}", error.code().message()));
  }
}

MapSnapshot::Parts parts_of(const MapSnapshot& map) {
  MapSnapshot::Parts parts;
  parts.epoch = map.epoch();
  parts.revision = map.revision();
  parts.utime = map.utime();
  parts.cell_size_m = map.cell_size_m();
  parts.density_threshold = map.density_threshold();
  parts.cell_count = map.cell_count();
  parts.removed_complete_since = map.removed_complete_since();
  parts.planes.assign(map.planes().begin(), map.planes().end());
  parts.removed.assign(map.removed().begin(), map.removed().end());
  for (const auto& block : map.blocks()) parts.blocks.push_back(block);
  parts.state = map.state();
  return parts;
}

}  // namespace planemap::service
