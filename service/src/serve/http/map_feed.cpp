#include "serve/http/map_feed.hpp"

namespace planemap::service {

MapFeed::MapFeed(const ServiceConfig& config, const MappingService& mapping, PlaneBook& book)
    : mapping_(mapping), book_(book), frame_(config.map.frame), max_age_s_(config.http.update_period_s) {}

std::shared_ptr<const MapSheet> MapFeed::current() {
  const std::lock_guard lock(mutex_);
  const auto newest = mapping_.snapshot();
  const double now_s = steady_now_s();
  asked_at_s_ = now_s;
  const bool is_usable = sheet_ && sheet_->snapshot().epoch() == newest->epoch() &&
                         (now_s - taken_at_s_ < max_age_s_ || &sheet_->snapshot() == newest.get());
  if (is_usable) return sheet_;
  sheet_ = std::make_shared<const MapSheet>(book_.open(newest), frame_, sheet_.get());
  taken_at_s_ = now_s;
  return sheet_;
}

void MapFeed::forget_after(double unused_s) {
  const std::lock_guard lock(mutex_);
  if (steady_now_s() - asked_at_s_ > unused_s) sheet_ = nullptr;
}

}  // namespace planemap::service
