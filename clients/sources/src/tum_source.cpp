#include <algorithm>
#include <cmath>
#include <planemap/sources/depth_png.hpp>
#include <planemap/sources/tum_source.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "folder_frame.hpp"
#include "text_file.hpp"
#include "tum_trajectory.hpp"

namespace planemap::sources {
namespace {

constexpr double kDepthScaleM = 1.0 / 5000.0;
constexpr CameraParameters kDefaultCamera{525.0, 525.0, 319.5, 239.5};
constexpr const char* kDepthList = "depth.txt";
constexpr const char* kPoseList = "groundtruth.txt";

struct ListedImage {
  std::int64_t utime = 0;  // microseconds; 0 or less: the line can't be read
  std::filesystem::path file;
};

/// "time file"; a line that can't be read gives a listed image without a file.
ListedImage parse_image_line(std::string_view line) {
  const auto words = split_words(line);
  const auto seconds = words.size() == 2 ? parse_number(words[0]) : std::nullopt;
  if (!seconds || *seconds <= 0.0 || *seconds > kMaxTumSeconds) return {};
  return {std::llround(*seconds * 1e6), std::filesystem::path(std::string(words[1]))};
}

std::vector<ListedImage> parse_depth_list(std::string_view text) {
  std::vector<ListedImage> images;
  for (const std::string_view line : split_lines(text)) {
    if (line.starts_with('#') || split_words(line).empty()) continue;
    images.push_back(parse_image_line(line));
  }
  std::stable_sort(images.begin(), images.end(),
                   [](const ListedImage& a, const ListedImage& b) { return a.utime < b.utime; });
  return images;
}

}  // namespace

struct TumSource::Impl {
  std::filesystem::path folder;
  std::vector<ListedImage> images;
  TumTrajectory trajectory;
  CameraParameters camera;
  double depth_scale_m = kDepthScaleM;
  std::int64_t max_gap_us = 0;
  std::size_t next = 0;
  std::map<std::string, std::size_t> skipped;

  /// The frame of a listed image, or why it is skipped.
  Expected<Frame> load(const ListedImage& image) const {
    if (image.file.empty()) return fail("line of depth.txt unreadable");
    const auto path = folder / image.file;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return fail("depth image missing");
    const auto pose = trajectory.at(image.utime, max_gap_us);
    if (!pose) return fail("no pose near the frame's time");
    auto decoded = read_depth_png(path);
    if (!decoded) return fail("depth image unreadable");
    return Frame{make_depth_scan(std::move(*decoded), image.utime, camera, depth_scale_m), *pose};
  }
};

TumSource::TumSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TumSource::~TumSource() = default;

bool TumSource::recognises(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::exists(folder / kDepthList, error) && std::filesystem::exists(folder / kPoseList, error);
}

Expected<std::unique_ptr<TumSource>> TumSource::open(const std::filesystem::path& folder,
                                                     const FolderOptions& options) {
  if (const std::string objection = objection_to(options); !objection.empty()) return fail(objection);
  const auto depth_list = read_text_file(folder / kDepthList);
  if (!depth_list) return tl::make_unexpected(depth_list.error());
  const auto pose_list = read_text_file(folder / kPoseList);
  if (!pose_list) return tl::make_unexpected(pose_list.error());

  auto impl = std::make_unique<Impl>();
  impl->folder = folder;
  impl->images = parse_depth_list(*depth_list);
  const bool any_image = std::any_of(impl->images.begin(), impl->images.end(),
                                     [](const ListedImage& image) { return !image.file.empty(); });
  if (!any_image) return fail((folder / kDepthList).string() + ": has no line 'time file'");
  impl->trajectory = TumTrajectory::parse(*pose_list);
  if (impl->trajectory.size() == 0) {
    return fail((folder / kPoseList).string() + ": has no line 'time tx ty tz qx qy qz qw'");
  }
  impl->camera = options.camera.value_or(kDefaultCamera);
  impl->depth_scale_m = options.depth_scale_m.value_or(kDepthScaleM);
  impl->max_gap_us = std::llround(options.max_association_gap_s * 1e6);
  return std::unique_ptr<TumSource>(new TumSource(std::move(impl)));
}

std::optional<Frame> TumSource::next() {
  while (impl_->next < impl_->images.size()) {
    auto frame = impl_->load(impl_->images[impl_->next++]);
    if (frame) return std::move(*frame);
    ++impl_->skipped[frame.error().message];
  }
  return std::nullopt;
}

std::optional<std::size_t> TumSource::size() const {
  return impl_->images.size();
}
const std::map<std::string, std::size_t>& TumSource::skipped() const {
  return impl_->skipped;
}
std::size_t TumSource::unreadable_pose_lines() const {
  return impl_->trajectory.unreadable_lines();
}

}  // namespace planemap::sources
