#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/sources/frame_source.hpp>
#include <string>
#include <vector>

#include "formats/format.hpp"
#include "sink.hpp"

namespace planemap::kinect_bridge {

/// How frames become messages.
struct FeedOptions {
  std::string channel = "PLANEMAP_SCAN";
  std::string pose_channel = "POSE";
  WireFormat format;
  std::optional<std::size_t> frames;   ///< stop after so many
  std::optional<double> rate_hz;       ///< frames a second; empty: as recorded
  std::optional<double> pose_rate_hz;  ///< poses in between, interpolated; empty: one with each frame
  bool wall_clock = false;             ///< stamp with the time of publishing, not as recorded
  bool paced = true;                   ///< false: as fast as it goes
};

/// What was fed.
struct FeedReport {
  std::size_t frames = 0;
  std::size_t poses = 0;
  std::size_t unsent = 0;  ///< messages that the sink did not take
  std::size_t late = 0;    ///< frames that went out more than half a period after their time
  std::uint64_t bytes = 0;
  std::int64_t first_utime = 0;  ///< microseconds, as published
  std::int64_t last_utime = 0;
  PinholeIntrinsics intrinsics;  ///< of the last frame
  bool stopped = false;          ///< before the source's end
};

/// The pose at a share, 0 to 1, of the way between two; the rotation by slerp.
Eigen::Isometry3d interpolated(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to, double share);

/// Waits until a time; true: stop.
using WaitUntil = std::function<bool(std::chrono::steady_clock::time_point)>;

/// Brings a source's frames to a sink: each frame's pose, then its scan, at their time.
class Feed {
 public:
  /// @param wait  called before everything that is sent
  Feed(sources::FrameSource& source, Sink& sink, const FeedOptions& options, WaitUntil wait);

  /// Until the source's end, or until `wait` says stop. Fails if the first message can't be sent, or a log not written
  /// on.
  /// @param on_frame  called after each frame
  Expected<FeedReport> run(const std::function<void(const FeedReport&)>& on_frame);

 private:
  using Clock = std::chrono::steady_clock;
  /// A frame ready to be sent.
  struct Prepared {
    std::int64_t offset_us = 0;  ///< since the first frame
    std::int64_t utime = 0;      ///< as published
    Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();
    PinholeIntrinsics intrinsics;
    std::vector<std::uint8_t> scan;
  };
  std::optional<Prepared> prepare();
  Expected<void> send(const std::string& channel, std::int64_t utime, const std::vector<std::uint8_t>& bytes);
  Expected<void> send_frame(const Prepared& frame);
  Expected<void> send_poses_between(const Prepared& from, const Prepared& to);
  bool stop_before(std::int64_t offset_us);

  sources::FrameSource& source_;
  Sink& sink_;
  FeedOptions options_;
  WaitUntil wait_;
  FeedReport report_;
  std::size_t prepared_ = 0;
  std::int64_t first_recorded_utime_ = 0;
  std::int64_t first_wall_utime_ = 0;
  Clock::time_point begin_;
};

}  // namespace planemap::kinect_bridge
