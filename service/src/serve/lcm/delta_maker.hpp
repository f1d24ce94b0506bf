#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <planemap/snapshot.hpp>
#include <string>

#include "codec/page_codec.hpp"
#include "serve/plane_book.hpp"

namespace planemap::service {

/// What has changed since the last delta, as messages. Not thread-safe.
class DeltaMaker {
 public:
  DeltaMaker(const ServiceConfig& config, PlaneBook& book);

  /// Empty if nothing has changed. After a change of epoch, or where the snapshot does not reach back far enough, the
  /// delta holds all planes and is said to be since revision 0.
  Pages make(const std::shared_ptr<const MapSnapshot>& snapshot);

 private:
  PlaneBook& book_;
  std::string frame_;
  std::size_t page_bytes_;
  std::uint64_t epoch_ = 0;
  std::uint64_t revision_ = 0;
  std::map<PlaneId, PlaneClass> told_classes_;  ///< a class may change with another plane, the record staying as it is
};

}  // namespace planemap::service
