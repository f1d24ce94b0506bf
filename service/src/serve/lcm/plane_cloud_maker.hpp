#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <planemap/snapshot.hpp>
#include <string>

#include "codec/page_codec.hpp"
#include "serve/plane_book.hpp"

namespace planemap::service {

/// The planes as a message for Drake's viewer. Not thread-safe.
class PlaneCloudMaker {
 public:
  PlaneCloudMaker(const ServiceConfig& config, PlaneBook& book);

  /// The message of a snapshot; made anew only where epoch or revision are others than the last time.
  const Page& make(const std::shared_ptr<const MapSnapshot>& snapshot);

 private:
  PlaneBook& book_;
  std::string frame_;
  std::size_t max_points_;
  std::optional<std::pair<std::uint64_t, std::uint64_t>> made_;  ///< of this epoch and revision
  Page message_;
};

}  // namespace planemap::service
