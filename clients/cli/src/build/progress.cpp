#include "build/progress.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace planemap::cli {
namespace {

constexpr std::chrono::milliseconds kPeriod(200);
constexpr int kBarWidth = 24;

std::string minutes_text(double seconds) {
  const long whole = std::lround(seconds);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

Progress::Progress(bool wanted) : shown_here_(wanted && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (on_screen_) std::fputs("\r\033[K", stderr);
}

bool Progress::due() const {
  return shown_here_ && Clock::now() - last_ >= kPeriod;
}

void Progress::show(double share, std::size_t scans, std::size_t planes) {
  show(share, fmt::format("{} scans, {:.1f}/s, {} planes", scans,
                          static_cast<double>(scans) / std::max(seconds(), 1e-3), planes));
}

void Progress::show(double share, const std::string& what) {
  last_ = Clock::now();
  on_screen_ = true;
  share = std::clamp(share, 0.0, 1.0);
  const auto full = static_cast<std::size_t>(share * kBarWidth);
  const std::string bar = std::string(full, '#') + std::string(kBarWidth - full, '.');
  const std::string left = share > 0.0 ? minutes_text(seconds() * (1.0 - share) / share) : "?";
  fmt::print(stderr, "\r\033[K[{}] {:3.0f} %  {}, {} left", bar, 100.0 * share, what, left);
  std::fflush(stderr);
}

}  // namespace planemap::cli
