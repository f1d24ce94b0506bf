#include "build/build_run.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <numeric>
#include <utility>

#include "build/frame_prefetcher.hpp"
#include "build/input_hash.hpp"
#include "build/progress.hpp"
#include "ingest/lcm_log_reader.hpp"
#include "mapping/offline_builder.hpp"

namespace planemap::cli {
namespace {

namespace fs = std::filesystem;
using service::OfflineBuilder;
using service::ServiceConfig;

/// All that shapes the map beside the input's bytes, as text.
std::string settings_of(const BuildInput& input, ServiceConfig config) {
  config.mapping = {};  // the map is the same for any number of threads
  std::string text = service::to_yaml(config);
  const auto& camera = input.folder.camera;
  if (camera) text += fmt::format("camera {} {} {} {}\n", camera->fx, camera->fy, camera->cx, camera->cy);
  if (input.folder.depth_scale_m) text += fmt::format("depth scale {}\n", *input.folder.depth_scale_m);
  if (input.frames) text += fmt::format("frames {}\n", *input.frames);
  return text;
}

void finish(OfflineBuilder& builder, BuildResult& result) {
  builder.finish();
  result.snapshot = builder.snapshot();
  result.counters = builder.counters();
  result.points = builder.points();
  result.times = builder.times();
  result.last_problem = builder.last_problem();
}

std::size_t total_of(const std::map<std::string, std::size_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0},
                         [](std::size_t sum, const auto& count) { return sum + count.second; });
}

Expected<BuildResult> build_from_folder(const BuildInput& input, ServiceConfig config, Progress& progress) {
  auto source = sources::open_folder(input.path, input.folder);
  if (!source) return tl::make_unexpected(source.error());
  const auto gravity = (*source)->gravity_direction();
  if (config.map.gravity.empty() && gravity) config.map.gravity = {gravity->x(), gravity->y(), gravity->z()};
  const auto epoch = epoch_of(input.path, settings_of(input, config));
  if (!epoch) return tl::make_unexpected(epoch.error());

  BuildResult result;
  OfflineBuilder builder(config, *epoch);
  const std::size_t total = std::min((*source)->size().value_or(0), input.frames.value_or(SIZE_MAX));
  FramePrefetcher frames(**source);
  for (std::size_t count = 0; !input.frames || count < *input.frames;) {
    auto frame = frames.next();
    if (!frame) break;
    builder.add_frame(std::move(frame->scan), frame->T_world_sensor);
    ++count;
    if (progress.due() && total > 0) {
      const std::size_t read = count + (input.frames ? 0 : total_of(frames.skipped()));
      progress.show(static_cast<double>(read) / static_cast<double>(total), count, builder.snapshot()->planes().size());
    }
  }
  finish(builder, result);
  result.skipped = frames.skipped();
  result.config = std::move(config);
  return result;
}

Expected<BuildResult> build_from_log(const BuildInput& input, ServiceConfig config, Progress& progress) {
  auto log = service::LcmLogReader::open(input.path);
  if (!log) return tl::make_unexpected(log.error());
  const auto epoch = epoch_of(input.path, settings_of(input, config));
  if (!epoch) return tl::make_unexpected(epoch.error());

  BuildResult result;
  OfflineBuilder builder(config, *epoch);
  const auto count_of = [&](const char* name) {
    const auto counters = builder.counters();
    const auto found = counters.find(name);
    return found == counters.end() ? std::size_t{0} : static_cast<std::size_t>(found->second);
  };
  while (const auto event = log->next()) {
    ++result.channels[std::string(event->channel)];
    if (!builder.add_event(event->channel, event->data)) continue;
    if (input.frames && count_of("scans.received") >= *input.frames) break;
    if (progress.due()) {
      progress.show(static_cast<double>(log->position_bytes()) / static_cast<double>(log->size_bytes()),
                    count_of("scans.mapped"), builder.snapshot()->planes().size());
    }
  }
  if (result.channels.empty()) return fail(input.path.string() + ": is no LCM event log: there is no record in it");
  finish(builder, result);
  result.gaps = log->gaps();
  result.gap_bytes = log->gap_bytes();
  result.config = std::move(config);
  return result;
}

}  // namespace

std::int64_t BuildResult::mapped() const {
  const auto found = counters.find("scans.mapped");
  return found == counters.end() ? 0 : found->second;
}

Expected<BuildResult> build_map(const BuildInput& input, ServiceConfig config, bool wants_progress) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Progress progress(wants_progress);
  auto result = fs::is_directory(input.path) ? build_from_folder(input, std::move(config), progress)
                                             : build_from_log(input, std::move(config), progress);
  if (result) result->seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return result;
}

}  // namespace planemap::cli
