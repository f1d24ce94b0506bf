#include <planemap/sources/open_folder.hpp>
#include <planemap/sources/seven_scenes_source.hpp>
#include <planemap/sources/tum_source.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "text_file.hpp"

namespace planemap::sources {
namespace {

/// An opened source as the base that callers know.
template <class Source>
Expected<std::unique_ptr<FrameSource>> as_frame_source(Expected<std::unique_ptr<Source>> source) {
  if (!source) return tl::make_unexpected(source.error());
  return std::unique_ptr<FrameSource>(std::move(*source));
}

}  // namespace

Expected<CameraParameters> parse_camera_parameters(std::string_view text) {
  std::string spaced(text);
  for (char& c : spaced) {
    if (c == ',') c = ' ';
  }
  const auto numbers = parse_numbers(spaced);
  if (!numbers || numbers->size() != 4 || (*numbers)[0] <= 0.0 || (*numbers)[1] <= 0.0) {
    return fail("'" + std::string(text) + "' are no intrinsics: fx,fy,cx,cy in pixels, fx and fy greater than 0");
  }
  return CameraParameters{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
}

Expected<std::unique_ptr<FrameSource>> open_folder(const std::filesystem::path& folder, const FolderOptions& options) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return fail(folder.string() + ": there is no such folder");
  if (!std::filesystem::is_directory(folder, error)) return fail(folder.string() + ": is no folder");
  if (SevenScenesSource::recognises(folder)) return as_frame_source(SevenScenesSource::open(folder, options));
  if (TumSource::recognises(folder)) return as_frame_source(TumSource::open(folder, options));
  return fail(
      folder.string() +
      ": is neither a 7-Scenes folder (frame-NNNNNN.depth.png with frame-NNNNNN.pose.txt) nor a TUM RGB-D folder "
      "(depth.txt with groundtruth.txt)");
}

}  // namespace planemap::sources
