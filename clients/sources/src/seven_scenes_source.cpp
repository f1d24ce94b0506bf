#include <charconv>
#include <planemap/sources/depth_png.hpp>
#include <planemap/sources/seven_scenes_source.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "folder_frame.hpp"
#include "text_file.hpp"

namespace planemap::sources {
namespace {

constexpr double kDepthScaleM = 0.001;
constexpr std::int64_t kFirstUtime = 1'000'000;  // utime 0 means "none yet" to readers
constexpr std::int64_t kFramesPerSecond = 30;
constexpr std::string_view kPrefix = "frame-";
constexpr std::string_view kDepthSuffix = ".depth.png";
constexpr std::string_view kPoseSuffix = ".pose.txt";

/// The number in "frame-NNNNNN<suffix>"; empty for any other name.
std::optional<std::int64_t> frame_number(std::string_view name, std::string_view suffix) {
  if (!name.starts_with(kPrefix) || !name.ends_with(suffix)) return std::nullopt;
  name.remove_prefix(kPrefix.size());
  if (name.size() <= suffix.size() || name.size() > suffix.size() + 9) return std::nullopt;
  name.remove_suffix(suffix.size());
  if (name.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  std::int64_t number = 0;
  std::from_chars(name.data(), name.data() + name.size(), number);
  return number;
}

std::int64_t utime_of_frame(std::int64_t number) {
  return kFirstUtime + (number * 1'000'000 + kFramesPerSecond / 2) / kFramesPerSecond;
}

Expected<CameraParameters> read_camera(const std::filesystem::path& folder, const FolderOptions& options) {
  if (options.camera) return *options.camera;
  const auto path = folder / "camera-intrinsics.txt";
  const auto text = read_text_file(path);
  if (!text) {
    return fail(path.string() +
                ": can't be read; give the intrinsics with --intrinsics fx,fy,cx,cy "
                "(7-Scenes: 585,585,320,240)");
  }
  const auto numbers = parse_numbers(*text);
  if (!numbers || numbers->size() != 9 || (*numbers)[0] <= 0.0 || (*numbers)[4] <= 0.0) {
    return fail(path.string() + ": is no camera matrix (3x3 numbers, focal lengths greater than 0)");
  }
  return CameraParameters{(*numbers)[0], (*numbers)[4], (*numbers)[2], (*numbers)[5]};
}

/// Empty where there is no such file.
Expected<std::optional<Eigen::Vector3d>> read_gravity(const std::filesystem::path& folder) {
  const auto path = folder / "gravity-direction.txt";
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::optional<Eigen::Vector3d>();
  const auto text = read_text_file(path);
  if (!text) return tl::make_unexpected(text.error());
  const auto numbers = parse_numbers(*text);
  if (!numbers || numbers->size() != 3) return fail(path.string() + ": holds no direction (three numbers)");
  const Eigen::Vector3d direction((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  if (direction.norm() < 1e-6) return fail(path.string() + ": the direction has no length");
  return std::optional<Eigen::Vector3d>(direction.normalized());
}

}  // namespace

SevenScenesSource::SevenScenesSource(std::vector<Listed> frames, const CameraParameters& camera, double depth_scale_m,
                                     const std::optional<Eigen::Vector3d>& gravity)
    : frames_(std::move(frames)), camera_(camera), depth_scale_m_(depth_scale_m), gravity_(gravity) {}

std::vector<SevenScenesSource::Listed> SevenScenesSource::list_frames(const std::filesystem::path& folder) {
  std::map<std::int64_t, Listed> by_number;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (const auto depth = frame_number(name, kDepthSuffix)) by_number[*depth].depth = it->path();
    if (const auto pose = frame_number(name, kPoseSuffix)) by_number[*pose].pose = it->path();
  }
  std::vector<Listed> frames;
  for (auto& entry : by_number) {
    entry.second.number = entry.first;
    frames.push_back(std::move(entry.second));
  }
  return frames;
}

bool SevenScenesSource::recognises(const std::filesystem::path& folder) {
  return !list_frames(folder).empty();
}

Expected<std::unique_ptr<SevenScenesSource>> SevenScenesSource::open(const std::filesystem::path& folder,
                                                                     const FolderOptions& options) {
  if (const std::string objection = objection_to(options); !objection.empty()) return fail(objection);
  auto frames = list_frames(folder);
  if (frames.empty()) return fail(folder.string() + ": has no frame-NNNNNN.depth.png and no frame-NNNNNN.pose.txt");
  const auto camera = read_camera(folder, options);
  if (!camera) return tl::make_unexpected(camera.error());
  const auto gravity = read_gravity(folder);
  if (!gravity) return tl::make_unexpected(gravity.error());
  return std::unique_ptr<SevenScenesSource>(
      new SevenScenesSource(std::move(frames), *camera, options.depth_scale_m.value_or(kDepthScaleM), *gravity));
}

std::optional<Frame> SevenScenesSource::next() {
  while (next_ < frames_.size()) {
    const Listed& listed = frames_[next_++];
    const auto skip = [this](const char* reason) { ++skipped_[reason]; };
    if (listed.depth.empty()) {
      skip("depth image missing");
      continue;
    }
    if (listed.pose.empty()) {
      skip("pose file missing");
      continue;
    }
    const auto pose_text = read_text_file(listed.pose);
    const auto pose = pose_text ? parse_rigid_transform(*pose_text) : std::nullopt;
    if (!pose) {
      skip("pose is no rigid transform");
      continue;
    }
    auto image = read_depth_png(listed.depth);
    if (!image) {
      skip("depth image unreadable");
      continue;
    }
    return Frame{make_depth_scan(std::move(*image), utime_of_frame(listed.number), camera_, depth_scale_m_), *pose};
  }
  return std::nullopt;
}

}  // namespace planemap::sources
