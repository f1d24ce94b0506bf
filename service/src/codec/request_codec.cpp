#include "codec/request_codec.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <planemap_lcm/request_t.hpp>

#include "codec/fingerprint.hpp"
#include "codec/wire_reader.hpp"
#include "config/service_config.hpp"

namespace planemap::service {
namespace {

constexpr std::string_view kReplyPrefix = "PLANEMAP_REPLY";

/// LCM's string: a length that counts the zero at the end, then the characters.
Decoded<std::string> read_reply_channel(WireReader& reader) {
  const std::int32_t size = reader.i32();
  if (!reader.ok()) return reject("truncated", "request_t: ends before reply_channel");
  const auto most = static_cast<std::int32_t>(kMaxChannelChars) + 1;
  if (size < 1 || size > most) {
    return reject("reply_channel",
                  fmt::format("request_t: reply_channel has a length of {} (allowed: 1 to {})", size, most));
  }
  const auto bytes = reader.bytes(static_cast<std::size_t>(size));
  if (!reader.ok() || bytes.back() != 0) return reject("truncated", "request_t: reply_channel does not end");
  std::string channel(bytes.begin(), bytes.end() - 1);
  const bool plain = std::all_of(channel.begin(), channel.end(), [](unsigned char c) { return std::isgraph(c) != 0; });
  if (!plain || channel.rfind(kReplyPrefix, 0) != 0) {
    return reject("reply_channel",
                  fmt::format("request_t: reply_channel must begin with {} and be printable", kReplyPrefix));
  }
  return channel;
}

// Bytes of the types in a request, member by member as in lcmtypes/planemap_lcm.
constexpr std::size_t kStringLeastBytes = 4 + 1;
constexpr std::size_t kPointBytes = 3 * 8 + 8 + 6 * 8;
constexpr std::size_t kNearestLeastBytes = 4 + 8 + 4;
constexpr std::size_t kRayBytes = 7 * 8;
constexpr std::size_t kRaysLeastBytes = 1 + 1 + 4;
constexpr std::size_t kRegionBytes = 1 + (3 + 3 + 3 + 4) * 8 + 5 * 8 + 2;
constexpr std::size_t kPlaneBytes = 8;
constexpr std::size_t kFloorplanBytes = 5 * 8;

void walk_filter(WireReader& reader) {
  reader.bytes(4 * 8);
  for (std::size_t left = reader.count(kStringLeastBytes); left > 0 && reader.ok(); --left) {
    // A string without its closing zero would not be read back as it was sent, one of no length not at all.
    const auto text = reader.bytes(std::max<std::size_t>(reader.count(1), 1));
    if (reader.ok() && text.back() != 0) reader.bytes(reader.remaining() + 1);
  }
}

/// Whether the counts of the filter and the queries agree with the rest of the message: the generated decoder takes
/// memory for a count before it looks.
bool arguments_agree(WireReader reader) {
  walk_filter(reader);
  for (std::size_t left = reader.count(kNearestLeastBytes); left > 0 && reader.ok(); --left) {
    reader.bytes(4 + 8);
    reader.bytes(kPointBytes * reader.count(kPointBytes));
  }
  for (std::size_t left = reader.count(kRaysLeastBytes); left > 0 && reader.ok(); --left) {
    reader.bytes(1 + 1);
    reader.bytes(kRayBytes * reader.count(kRayBytes));
  }
  for (const std::size_t bytes : {kRegionBytes, kPlaneBytes, kFloorplanBytes})
    reader.bytes(bytes * reader.count(bytes));
  return reader.ok() && reader.remaining() == 0;
}

}  // namespace

Decoded<Request> decode_request(std::span<const std::uint8_t> message) {
  WireReader reader(message);
  if (reader.i64() != planemap_lcm::request_t::getHash() || !reader.ok()) {
    return reject(
        "unknown_type",
        fmt::format("fingerprint {} is not planemap_lcm.request_t ({})", fingerprint_text(fingerprint_of(message)),
                    fingerprint_text(static_cast<std::uint64_t>(planemap_lcm::request_t::getHash()))));
  }
  reader.i64();  // utime: the client's clock says nothing here
  Request request;
  request.request_id = reader.i64();
  auto channel = read_reply_channel(reader);
  if (!channel) return tl::make_unexpected(channel.error());
  request.reply_channel = std::move(*channel);
  request.operation = reader.i16();
  request.epoch = reader.i64();
  request.revision = reader.i64();
  request.page = reader.i32();
  if (!reader.ok()) return reject("truncated", fmt::format("request_t: ends early, at byte {}", message.size()));
  if (!arguments_agree(reader)) {
    return reject("size", fmt::format("request_t: its counts do not agree with its {} bytes", message.size()));
  }
  const auto arguments = message.last(reader.remaining());
  request.argument_bytes.assign(arguments.begin(), arguments.end());
  const int size = static_cast<int>(message.size());
  if (request.arguments.decode(message.data(), 0, size) != size) {
    return reject("size", "request_t: not every byte could be read");
  }
  return request;
}

}  // namespace planemap::service
