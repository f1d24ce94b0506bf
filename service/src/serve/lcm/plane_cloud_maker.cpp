#include "serve/lcm/plane_cloud_maker.hpp"

#include <utility>

#include "codec/plane_cloud.hpp"

namespace planemap::service {

PlaneCloudMaker::PlaneCloudMaker(const ServiceConfig& config, PlaneBook& book)
    : book_(book), frame_(config.map.frame), max_points_(static_cast<std::size_t>(config.publish.point_cloud_points)) {}

const Page& PlaneCloudMaker::make(const std::shared_ptr<const MapSnapshot>& snapshot) {
  const std::pair wanted(snapshot->epoch(), snapshot->revision());
  if (made_ != wanted) {
    message_ = encode(to_point_cloud(book_.open(snapshot)->planes(), snapshot->utime(), frame_, max_points_));
    made_ = wanted;
  }
  return message_;
}

}  // namespace planemap::service
