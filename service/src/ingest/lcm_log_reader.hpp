#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <planemap/expected.hpp>
#include <span>
#include <string_view>
#include <vector>

namespace planemap::service {

/// One record of an LCM event log.
struct LcmLogEvent {
  std::int64_t number = 0;   ///< the logger's count of events
  std::int64_t utime = 0;    ///< microseconds, when the logger received it; may have nothing to do with the message's
  std::string_view channel;  ///< valid until the next event is read
  std::span<const std::uint8_t> data;  ///< the message; valid until the next event is read
};

/// Reads LCM event logs from the first to the last record that can be read. Where a record is damaged it goes on with
/// the next good one (lcm::LogFile stops there) and counts what it passed over. Holds one record in memory, not the
/// file.
///
/// A record: sync word 0xEDA1DA01, event number (int64), time (int64, microseconds), channel length (int32), data
/// length (int32), channel, data; all big-endian.
class LcmLogReader {
 public:
  static constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
  static constexpr std::size_t kHeaderBytes = 28;
  static constexpr std::size_t kMaxChannelBytes = 1000;
  static constexpr std::size_t kMaxDataBytes = 256u << 20u;

  /// Fails if the file can't be opened or is no regular file. Whether it is a log shows with the first event.
  static Expected<LcmLogReader> open(const std::filesystem::path& path);

  /// The next good record; empty at the end of the file.
  std::optional<LcmLogEvent> next();

  std::uint64_t size_bytes() const { return size_; }          ///< of the file
  std::uint64_t position_bytes() const { return position_; }  ///< how far it was read
  std::uint64_t gaps() const { return gaps_; }                ///< stretches that were passed over
  std::uint64_t gap_bytes() const { return gap_bytes_; }      ///< what they hold

 private:
  /// Where a record's parts are.
  struct Extent {
    std::size_t channel_bytes = 0;
    std::size_t data_bytes = 0;
    std::uint64_t end = 0;  ///< offset of the byte after it
  };

  LcmLogReader(std::ifstream file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  std::span<const std::uint8_t> bytes_at(std::uint64_t offset, std::size_t count);
  std::optional<Extent> plausible_record_at(std::uint64_t offset);
  bool sync_or_end_at(std::uint64_t offset);
  std::optional<std::uint64_t> find_sync(std::uint64_t from, std::uint64_t to);
  std::optional<std::uint64_t> find_record(std::uint64_t from, std::uint64_t to);
  bool swallows_others(std::uint64_t offset, const Extent& extent);
  void skip_to(std::uint64_t offset);

  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t gap_bytes_ = 0;
  std::vector<std::uint8_t> window_;  ///< part of the file, from window_begin_ on
  std::uint64_t window_begin_ = 0;
};

}  // namespace planemap::service
