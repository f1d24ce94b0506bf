#include "lcm/reply_codec.hpp"

#include <algorithm>
#include <exception>
#include <iterator>

#include "lcm/message_checks.hpp"
#include "lcm/wire_cursor.hpp"
#include "lcm/wire_types.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::planes_t;
using planemap_lcm::reply_t;

tl::unexpected<std::string> wrong(const char* type, const char* what) {
  return tl::make_unexpected(std::string(type) + ": " + what);
}

/// Decodes a message whose counts were found to agree with its size, and which has pages.
template <class Message>
tl::expected<Message, std::string> decode(std::span<const std::uint8_t> bytes, const char* type) {
  Message message;
  try {
    const int size = static_cast<int>(bytes.size());
    if (message.decode(bytes.data(), 0, size) != size) return wrong(type, "not every byte could be read");
  } catch (const std::exception&) {
    return wrong(type, "it can't be decoded");
  }
  if (message.page_count < 1 || message.page_count > kMaxPages || message.page < 0 ||
      message.page >= message.page_count) {
    return wrong(type, "its page number is beyond its page count");
  }
  return message;
}

}  // namespace

tl::expected<reply_t, std::string> decode_reply(std::span<const std::uint8_t> bytes) {
  if (WireCursor(bytes).int64() != reply_t::getHash()) return wrong("reply_t", "another type's fingerprint");
  if (!reply_counts_agree(bytes)) return wrong("reply_t", "its counts do not agree with its size");
  auto reply = decode<reply_t>(bytes, "reply_t");
  if (!reply) return reply;
  if (const char* what = unsound_part(*reply)) return wrong("reply_t", what);
  return reply;
}

tl::expected<planes_t, std::string> decode_delta(std::span<const std::uint8_t> bytes) {
  if (WireCursor(bytes).int64() != planes_t::getHash()) return wrong("planes_t", "another type's fingerprint");
  if (!delta_counts_agree(bytes)) return wrong("planes_t", "its counts do not agree with its size");
  auto delta = decode<planes_t>(bytes, "planes_t");
  if (!delta) return delta;
  if (delta->since_revision < 0 || delta->since_revision > delta->revision) {
    return wrong("planes_t", "it goes back in revisions");
  }
  const auto sound = [](const auto& plane) { return is_sound(plane); };
  if (!std::all_of(delta->planes.begin(), delta->planes.end(), sound)) {
    return wrong("planes_t", "a plane's numbers are not sound");
  }
  return delta;
}

tl::expected<MapVersion, std::string> decode_status_version(std::span<const std::uint8_t> bytes) {
  WireCursor cursor(bytes);
  if (cursor.int64() != planemap_lcm::status_t::getHash()) return wrong("status_t", "another type's fingerprint");
  cursor.skip(8);
  cursor.string();
  MapVersion version;
  version.epoch = cursor.int64();
  version.revision = cursor.int64();
  if (!cursor.ok()) return wrong("status_t", "it ends early");
  return version;
}

Map map_of(const std::vector<reply_t>& pages) {
  Map map;
  if (pages.empty()) return map;
  map.frame = pages.front().frame;
  map.epoch = pages.front().epoch;
  map.revision = pages.front().revision;
  for (const reply_t& page : pages) {
    std::transform(page.planes.begin(), page.planes.end(), std::back_inserter(map.planes), plane_of);
    std::transform(page.cells.begin(), page.cells.end(), std::back_inserter(map.cells), cell_of);
  }
  std::stable_sort(map.planes.begin(), map.planes.end(), [](const Plane& a, const Plane& b) { return a.id < b.id; });
  return map;
}

}  // namespace planemap::client
