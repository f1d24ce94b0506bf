#include "progress.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace planemap::kinect_bridge {

Progress::Progress(bool wanted, std::optional<std::size_t> frames)
    : shown_here_(wanted && isatty(STDERR_FILENO) == 1), frames_(frames) {}

Progress::~Progress() {
  if (on_screen_) std::fputs("\r\033[K", stderr);
}

void Progress::show(const FeedReport& report) {
  constexpr std::chrono::milliseconds kPeriod(200);
  const auto now = Clock::now();
  if (!shown_here_ || now - last_ < kPeriod) return;
  last_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  const std::string of = frames_ ? fmt::format("/{}", *frames_) : std::string();
  const std::string line = fmt::format("\rframe {}{}  {:.1f}/s  {:.1f} MB  {} late  {} unsent\033[K", report.frames, of,
                                       static_cast<double>(report.frames) / elapsed_s,
                                       static_cast<double>(report.bytes) / 1e6, report.late, report.unsent);
  std::fputs(line.c_str(), stderr);
  on_screen_ = true;
}

}  // namespace planemap::kinect_bridge
