#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "feed.hpp"
#include "options.hpp"

namespace planemap::kinect_bridge {

/// What a run did.
struct Summary {
  FeedReport report;
  std::map<std::string, std::size_t> skipped;  ///< frames of the source, by reason
  double seconds = 0.0;
};

std::string summary_text(const Summary& summary, const Options& options);
std::string summary_json(const Summary& summary, const Options& options);

}  // namespace planemap::kinect_bridge
