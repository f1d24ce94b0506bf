#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <planemap/expected.hpp>
#include <planemap/sources/frame_source.hpp>
#include <planemap/sources/open_folder.hpp>
#include <vector>

namespace planemap::sources {

/// A folder as of Microsoft 7-Scenes: frame-NNNNNN.depth.png (16-bit, millimetres, 0 and 65535 no return) and
/// frame-NNNNNN.pose.txt (4x4, row-major, camera to world). Beside them camera-intrinsics.txt (3x3 camera matrix) and,
/// where it is there, gravity-direction.txt (down in the world frame). Frame k was taken at k/30 s; its utime is that
/// plus 1 s.
class SevenScenesSource final : public FrameSource {
 public:
  /// Fails if the folder has no such frames, or no intrinsics are in it and none are given.
  static Expected<std::unique_ptr<SevenScenesSource>> open(const std::filesystem::path& folder,
                                                           const FolderOptions& options = {});
  /// Whether a folder has a file of a frame.
  static bool recognises(const std::filesystem::path& folder);

  std::optional<Frame> next() override;
  std::optional<std::size_t> size() const override { return frames_.size(); }
  const std::map<std::string, std::size_t>& skipped() const override { return skipped_; }
  std::optional<Eigen::Vector3d> gravity_direction() const override { return gravity_; }

 private:
  /// A frame's files; one of them may be missing.
  struct Listed {
    std::int64_t number = 0;
    std::filesystem::path depth;
    std::filesystem::path pose;
  };
  static std::vector<Listed> list_frames(const std::filesystem::path& folder);
  SevenScenesSource(std::vector<Listed> frames, const CameraParameters& camera, double depth_scale_m,
                    const std::optional<Eigen::Vector3d>& gravity);

  std::vector<Listed> frames_;
  std::size_t next_ = 0;
  CameraParameters camera_;
  double depth_scale_m_;
  std::optional<Eigen::Vector3d> gravity_;
  std::map<std::string, std::size_t> skipped_;
};

}  // namespace planemap::sources
