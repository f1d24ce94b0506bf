#pragma once

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "store/block_codec.hpp"
#include "store/map_file.hpp"
#include "store/map_rows.hpp"
#include "store/plane_row_codec.hpp"

// How the tables of a map file are read, row by row: for read_map(), which wants all of it, and recover_map(), which
// takes what there is.

namespace planemap::service {

/// A map that is not as it was written; caught in this file.
class Damage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Numbers of the table meta. Throws Damage.
class Facts {
 public:
  explicit Facts(const FactRows& rows) : rows_(rows) {}
  const std::string& text(const char* key) const {
    const auto found = rows_.find(key);
    if (found == rows_.end()) throw Damage(fmt::format("meta lacks {}", key));
    return found->second;
  }
  template <class T>
  T whole(const char* key) const {
    const std::string& digits = text(key);
    T number{};
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (problem != std::errc() || end != digits.data() + digits.size())
      throw Damage(fmt::format("meta: {} is no number", key));
    return number;
  }
  double real(const char* key) const { return std::strtod(text(key).c_str(), nullptr); }

 private:
  const FactRows& rows_;
};

FactRows read_facts(Database& database);
/// Takes what the facts say, though their checksum be wrong: that is for the caller to ask. Throws Damage.
void take_facts(const FactRows& rows, StoredMap& map, MapSnapshot::Parts& parts);

/// Whether a mapper could go on with the map, of whatever configuration; the error says what is wrong with it.
Expected<void> check_stored(const MapSnapshot& map);

/// Calls take(slot, block or the reason why there is none, checksum) for each row from a slot on.
template <class Take>
void read_blocks(Database& database, std::int64_t from, Take&& take) {
  Statement rows =
      database.prepare("SELECT slot, x, y, z, cells, checksum, data FROM block WHERE slot>=? ORDER BY slot");
  rows.bind(1, from);
  while (rows.step()) {
    const std::int64_t slot = rows.integer(0);
    const BlockIndex index(static_cast<int>(rows.integer(1)), static_cast<int>(rows.integer(2)),
                           static_cast<int>(rows.integer(3)));
    const auto cells = static_cast<std::size_t>(rows.integer(4));
    const auto bytes = rows.blob(6);
    const std::uint32_t checksum = block_checksum(slot, index, cells, bytes);
    Expected<std::shared_ptr<Block>> block = fail("its checksum is wrong");
    if (checksum == rows.integer(5)) block = decode_block(index, bytes);
    if (block && (*block)->size() != cells) block = fail("it has other cells than it says");
    take(slot, std::move(block), checksum);
  }
}

/// Calls take(id, record or the reason why there is none, checksum) for each row from an id on.
template <class Take>
void read_planes(Database& database, std::int64_t from, Take&& take) {
  Statement rows = database.prepare("SELECT id, checksum, data FROM plane WHERE id>=? ORDER BY id");
  rows.bind(1, from);
  while (rows.step()) {
    const auto id = static_cast<PlaneId>(rows.integer(0));
    const auto bytes = rows.blob(2);
    const std::uint32_t checksum = plane_checksum(id, bytes);
    Expected<std::shared_ptr<const PlaneRecord>> plane = fail("its checksum is wrong");
    if (checksum == rows.integer(1)) plane = decode_plane(id, bytes);
    take(id, std::move(plane), checksum);
  }
}

}  // namespace planemap::service
