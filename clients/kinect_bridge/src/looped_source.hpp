#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <planemap/expected.hpp>
#include <planemap/sources/frame_source.hpp>

namespace planemap::kinect_bridge {

/// A recording over and over again: after its last frame it is opened anew, and the utimes go on.
class LoopedSource final : public sources::FrameSource {
 public:
  using Open = std::function<Expected<std::unique_ptr<sources::FrameSource>>()>;
  /// Fails if the source can't be opened.
  static Expected<std::unique_ptr<sources::FrameSource>> open(const Open& open);

  std::optional<sources::Frame> next() override;  ///< empty only if a whole round has no frame
  std::optional<std::size_t> size() const override { return std::nullopt; }
  const std::map<std::string, std::size_t>& skipped() const override;
  std::optional<Eigen::Vector3d> gravity_direction() const override { return source_->gravity_direction(); }

 private:
  LoopedSource(Open open, std::unique_ptr<sources::FrameSource> source);
  sources::Frame shifted(sources::Frame frame);

  Open open_;
  std::unique_ptr<sources::FrameSource> source_;
  std::map<std::string, std::size_t> skipped_before_;  // in earlier rounds
  mutable std::map<std::string, std::size_t> skipped_;
  std::int64_t shift_us_ = 0;        // added to the recorded utimes
  std::int64_t last_utime_ = 0;      // as given
  std::int64_t last_period_us_ = 0;  // between the last two frames
  bool first_of_round_ = false;
  bool started_ = false;
};

}  // namespace planemap::kinect_bridge
