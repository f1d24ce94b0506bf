#pragma once

#include <string>
#include <vector>

#include "soak/soak_run.hpp"

namespace planemap::system_test {

/// What a soak must show.
struct SoakBound {
  const char* name;   ///< for scripts
  const char* words;  ///< for people
  double value = 0.0;
  double most = 0.0;
  bool held() const { return value <= most; }
};

/// What a short run may show besides: in minutes what goes up and down is more than what an hour may grow by.
struct SoakSlack {
  double memory_mb = 0.0;   ///< that may be more at the end than at the beginning
  double lost_share = 0.0;  ///< of the scans, 0 to 1, that may be lost where the machine stands still
};

/// @throws std::invalid_argument if there are no readings of two times after the warm-up
std::vector<SoakBound> soak_bounds(const SoakConfig& config, const SoakResult& result, const SoakSlack& slack);
/// For people.
std::string soak_table(const SoakConfig& config, const SoakResult& result, const SoakSlack& slack);
/// The same as one object.
std::string soak_json(const SoakConfig& config, const SoakResult& result, const SoakSlack& slack);

}  // namespace planemap::system_test
