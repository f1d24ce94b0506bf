#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace planemap::cli {

/// A line on stderr that is written over again and again; nothing where stderr is no terminal.
class Progress {
 public:
  explicit Progress(bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Whether the line is old enough to be written again: ask before working out what to show.
  bool due() const;
  /// @param share  of the input that is done, 0 to 1
  void show(double share, std::size_t scans, std::size_t planes);
  /// @param what  is being done
  void show(double share, const std::string& what);

 private:
  using Clock = std::chrono::steady_clock;

  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  bool shown_here_;
  bool on_screen_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = begin_;
};

}  // namespace planemap::cli
