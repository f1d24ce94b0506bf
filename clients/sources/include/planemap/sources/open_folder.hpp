#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <planemap/expected.hpp>
#include <planemap/sources/frame_source.hpp>
#include <string_view>

namespace planemap::sources {

/// The numbers of a pinhole camera that an image file does not hold, pixels.
struct CameraParameters {
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  bool operator==(const CameraParameters&) const = default;
};

/// Reads "fx,fy,cx,cy" (pixels, focal lengths > 0).
Expected<CameraParameters> parse_camera_parameters(std::string_view text);

/// What a recorded folder may need to be told.
struct FolderOptions {
  std::optional<CameraParameters> camera;  ///< instead of the folder's or its format's own
  std::optional<double> depth_scale_m;  ///< metres per unit of depth; empty: the format's (7-Scenes 1/1000, TUM 1/5000)
  double max_association_gap_s = 0.02;  ///< TUM: a frame's nearest pose may be at most this far from it in time
};

/// Opens a 7-Scenes or TUM RGB-D folder, whichever it is; the error names what was looked for.
Expected<std::unique_ptr<FrameSource>> open_folder(const std::filesystem::path& folder,
                                                   const FolderOptions& options = {});

}  // namespace planemap::sources
