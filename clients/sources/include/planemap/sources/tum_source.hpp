#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <planemap/expected.hpp>
#include <planemap/sources/frame_source.hpp>
#include <planemap/sources/open_folder.hpp>

namespace planemap::sources {

/// A folder as of TUM RGB-D: depth.txt (time, file of a 16-bit depth image) and groundtruth.txt (t tx ty tz qx qy qz
/// qw), associated by time. utime = seconds * 1e6. Unless told otherwise depth/5000 are metres and the camera is the
/// one TUM documents as the default (fx = fy = 525, cx = 319.5, cy = 239.5).
class TumSource final : public FrameSource {
 public:
  /// Fails if one of the two lists is missing, or has no line that can be used.
  static Expected<std::unique_ptr<TumSource>> open(const std::filesystem::path& folder,
                                                   const FolderOptions& options = {});
  /// Whether a folder has both lists.
  static bool recognises(const std::filesystem::path& folder);

  ~TumSource() override;
  std::optional<Frame> next() override;
  std::optional<std::size_t> size() const override;
  const std::map<std::string, std::size_t>& skipped() const override;
  std::optional<Eigen::Vector3d> gravity_direction() const override { return std::nullopt; }

  /// Lines of groundtruth.txt that were left out, such as a last one that was cut short.
  std::size_t unreadable_pose_lines() const;

 private:
  struct Impl;
  explicit TumSource(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::sources
