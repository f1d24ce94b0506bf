#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/scan_codec.hpp"
#include "common/counters.hpp"
#include "common/repeat_guard.hpp"
#include "config/service_config.hpp"
#include "ingest/idle_reason.hpp"
#include "ingest/point_filter.hpp"
#include "ingest/rate_limiter.hpp"
#include "sync/synchronizer.hpp"

namespace planemap::service {

/// From messages to registered scans: decode, check, thin out, mask, find the pose. The daemon feeds it from the bus,
/// the offline builder from a log. One thread owns it; only facts() is for any thread.
class ScanIntake {
 public:
  using Sink = std::function<void(RegisteredScan&&)>;
  using Warn = std::function<void(const std::string&)>;

  /// @param sink  takes each scan that is ready for the mapper
  /// @param warn  is told what a person should know, without repetitions
  ScanIntake(const ServiceConfig& config, Counters& counters, Sink sink, Warn warn);

  /// The channels it wants, each once.
  std::vector<std::string> channels() const;

  /// One message. Scans that it makes ready go to the sink before it returns.
  /// @param host_s  the host's steady clock, seconds
  /// @return whether the channel is one of channels(); else nothing was done
  bool on_message(std::string_view channel, std::span<const std::uint8_t> message, double host_s);
  /// Time has passed: scans that waited too long are dropped.
  void tick(double host_s);
  /// Nothing more will come.
  void finish();

  std::vector<InputFacts> facts() const;
  std::string last_problem() const;

 private:
  struct Input {
    InputConfig config;
    ScanFormat format;
    PointFilter filter;
    RateLimiter limiter;
    std::optional<std::pair<std::int64_t, std::int32_t>> last_scan;  ///< utime and seq
  };

  void on_scan(std::size_t index, std::span<const std::uint8_t> message, double host_s);
  void take_scan(std::size_t index, std::span<const std::uint8_t> message, double host_s);
  void on_pose(std::size_t stream, const std::string& channel, std::span<const std::uint8_t> message, double host_s);
  bool is_wanted(std::size_t index, const DecodedScan& decoded, double host_s);
  void leave_out(std::size_t index, const char* reason, std::string message, double host_s);
  void count_filtered(Input& input, Scan& scan);
  void reject_scan(std::size_t index, const Rejection& rejection, double host_s);
  void note_covariance(const std::string& channel);
  void note_pose(std::size_t stream, const std::string& channel, PoseInsert result, double host_s);
  void hand_on(SyncResults results, double host_s);
  void warn_once_in_a_while(const std::string& kind, const std::string& text, double host_s);
  void warn_rejection(const std::string& channel, const Rejection& rejection, double host_s);

  Counters& counters_;
  Sink sink_;
  Warn warn_;
  std::size_t max_scan_bytes_;
  bool jump_resets_map_;
  bool pose_errors_last_;  ///< pose.correlation_s is set
  bool said_that_errors_are_independent_ = false;
  std::vector<Input> inputs_;
  Synchronizer synchronizer_;
  std::map<std::string, std::size_t, std::less<>> scan_channels_;  ///< to the input's number
  std::map<std::string, std::size_t, std::less<>> pose_channels_;  ///< to the stream's number
  RepeatGuard repeats_;
  std::set<std::string> unknown_types_;  ///< channel and fingerprint that were said already

  mutable std::mutex facts_mutex_;
  std::vector<InputFacts> facts_;  ///< by input
  std::string last_problem_;
};

}  // namespace planemap::service
