#pragma once

#include <limits>
#include <map>
#include <string>

namespace planemap::service {

/// Keeps a log readable: of each kind of message one in a while, with the number of those that were held back. Not
/// thread-safe.
class RepeatGuard {
 public:
  explicit RepeatGuard(double period_s) : period_s_(period_s) {}

  /// @return 0: hold it back; else 1 + how many of its kind were held back since the last one that passed
  int pass(const std::string& kind, double now_s) {
    if (kinds_.size() >= kMaxKinds && kinds_.find(kind) == kinds_.end()) return 0;
    auto& entry = kinds_[kind];
    if (now_s - entry.last_s < period_s_) {
      ++entry.held_back;
      return 0;
    }
    const int count = 1 + entry.held_back;
    entry = {now_s, 0};
    return count;
  }

 private:
  struct Entry {
    double last_s = -std::numeric_limits<double>::infinity();
    int held_back = 0;
  };
  static constexpr std::size_t kMaxKinds = 256;  // kinds may come from outside: fingerprints

  double period_s_;
  std::map<std::string, Entry> kinds_;
};

/// For behind a message of which others were held back.
/// @param count  as pass() gave it
inline std::string repeats_text(int count) {
  return count > 1 ? " (" + std::to_string(count) + " times since this was said last)" : std::string();
}

}  // namespace planemap::service
