#include "ingest/lcm_log_reader.hpp"

#include <algorithm>
#include <array>
#include <system_error>

namespace planemap::service {
namespace {

constexpr std::size_t kWindowBytes = 1u << 20u;
constexpr std::size_t kSyncBytes = 4;

std::uint64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = (value << 8u) | byte;
  return value;
}

bool is_printable(std::uint8_t c) {
  return c >= 0x20 && c < 0x7f;
}

}  // namespace

Expected<LcmLogReader> LcmLogReader::open(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return fail(path.string() + ": no such file");
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) return fail(path.string() + ": " + error.message());
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(path.string() + ": can't be opened for reading; check its permissions");
  return LcmLogReader(std::move(file), size);
}

std::optional<LcmLogEvent> LcmLogReader::next() {
  std::optional<Extent> extent = plausible_record_at(position_);
  if (!extent || swallows_others(position_, *extent)) {
    const std::optional<std::uint64_t> good = find_record(position_ + 1, size_);
    skip_to(good.value_or(size_));
    if (!good) return std::nullopt;
    extent = plausible_record_at(position_);
  }
  const auto record = bytes_at(position_, static_cast<std::size_t>(extent->end - position_));
  if (record.empty()) return std::nullopt;  // the file was cut while it was read
  LcmLogEvent event;
  event.number = static_cast<std::int64_t>(big_endian(record.subspan(4, 8)));
  event.utime = static_cast<std::int64_t>(big_endian(record.subspan(12, 8)));
  const auto channel = record.subspan(kHeaderBytes, extent->channel_bytes);
  event.channel = {reinterpret_cast<const char*>(channel.data()), channel.size()};
  event.data = record.subspan(kHeaderBytes + extent->channel_bytes, extent->data_bytes);
  position_ = extent->end;
  return event;
}

/// Bytes of the file, valid until the next call; empty where there are not so many.
std::span<const std::uint8_t> LcmLogReader::bytes_at(std::uint64_t offset, std::size_t count) {
  if (offset > size_ || count > size_ - offset) return {};
  if (offset < window_begin_ || offset + count > window_begin_ + window_.size()) {
    window_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(std::max(count, kWindowBytes), size_ - offset)));
    window_begin_ = offset;
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(offset));
    file_.read(reinterpret_cast<char*>(window_.data()), static_cast<std::streamsize>(window_.size()));
    window_.resize(static_cast<std::size_t>(file_.gcount()));
    if (window_.size() < count) return {};
  }
  return std::span<const std::uint8_t>(window_).subspan(static_cast<std::size_t>(offset - window_begin_), count);
}

/// The record that begins there, by its sync word, lengths and channel; empty: none does.
std::optional<LcmLogReader::Extent> LcmLogReader::plausible_record_at(std::uint64_t offset) {
  const auto header = bytes_at(offset, kHeaderBytes);
  if (header.empty() || big_endian(header.first(kSyncBytes)) != kSyncWord) return std::nullopt;
  Extent extent;
  extent.channel_bytes = static_cast<std::size_t>(big_endian(header.subspan(20, 4)));  // negative ones become huge
  extent.data_bytes = static_cast<std::size_t>(big_endian(header.subspan(24, 4)));
  if (extent.channel_bytes == 0 || extent.channel_bytes > kMaxChannelBytes) return std::nullopt;
  if (extent.data_bytes > kMaxDataBytes) return std::nullopt;
  extent.end = offset + kHeaderBytes + extent.channel_bytes + extent.data_bytes;
  if (extent.end > size_) return std::nullopt;
  const auto channel = bytes_at(offset + kHeaderBytes, extent.channel_bytes);
  if (channel.empty() || !std::all_of(channel.begin(), channel.end(), is_printable)) return std::nullopt;
  return extent;
}

bool LcmLogReader::sync_or_end_at(std::uint64_t offset) {
  if (offset == size_) return true;
  const auto bytes = bytes_at(offset, kSyncBytes);
  return !bytes.empty() && big_endian(bytes) == kSyncWord;
}

/// Offset of the first sync word in [from, to).
std::optional<std::uint64_t> LcmLogReader::find_sync(std::uint64_t from, std::uint64_t to) {
  constexpr std::array<std::uint8_t, kSyncBytes> kSync = {0xED, 0xA1, 0xDA, 0x01};
  while (from + kSyncBytes <= to) {
    const auto bytes = bytes_at(from, static_cast<std::size_t>(std::min<std::uint64_t>(kWindowBytes, to - from)));
    if (bytes.empty()) return std::nullopt;
    const auto found = std::search(bytes.begin(), bytes.end(), kSync.begin(), kSync.end());
    if (found != bytes.end()) return from + static_cast<std::uint64_t>(found - bytes.begin());
    from += bytes.size() - (kSyncBytes - 1);  // a word may lie across two windows
  }
  return std::nullopt;
}

/// Offset of the first good record that begins in [from, to): plausible, and followed by a sync word or the file's end,
/// which chance and damaged lengths hardly ever are.
std::optional<std::uint64_t> LcmLogReader::find_record(std::uint64_t from, std::uint64_t to) {
  while (const auto sync = find_sync(from, to)) {
    const auto extent = plausible_record_at(*sync);
    if (extent && sync_or_end_at(extent->end)) return sync;
    from = *sync + 1;
  }
  return std::nullopt;
}

/// Whether a record's length is wrong so that others lie inside of it.
bool LcmLogReader::swallows_others(std::uint64_t offset, const Extent& extent) {
  // The record and what follows in one window: else the look behind it would cost reading the record once more.
  bytes_at(offset, static_cast<std::size_t>(std::min<std::uint64_t>(extent.end + kSyncBytes, size_) - offset));
  return !sync_or_end_at(extent.end) && find_record(offset + 1, extent.end).has_value();
}

void LcmLogReader::skip_to(std::uint64_t offset) {
  if (offset == position_) return;
  ++gaps_;
  gap_bytes_ += offset - position_;
  position_ = offset;
}

}  // namespace planemap::service
