#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "config/service_config.hpp"
#include "mapping/mapping_service.hpp"
#include "serve/http/map_sheet.hpp"
#include "serve/plane_book.hpp"

namespace planemap::service {

/// The newest sheet for all who ask, made while somebody does. Safe from any thread; who asks for what is being made
/// waits for it. The mapper never does.
class MapFeed {
 public:
  /// @param mapping, book  outlive it
  MapFeed(const ServiceConfig& config, const MappingService& mapping, PlaneBook& book);

  /// A sheet of the newest snapshot, or of one that was the newest at most http.update_period_s ago; never of another
  /// epoch than the newest.
  std::shared_ptr<const MapSheet> current();
  /// Lets go of a sheet that nobody has asked for in that time: it keeps what the mapper has left behind.
  void forget_after(double unused_s);

 private:
  const MappingService& mapping_;
  PlaneBook& book_;
  const std::string frame_;
  const double max_age_s_;

  std::mutex mutex_;  ///< of what follows; held while a sheet is made
  std::shared_ptr<const MapSheet> sheet_;
  double taken_at_s_ = 0.0;  ///< when its snapshot was the newest
  double asked_at_s_ = 0.0;
};

}  // namespace planemap::service
