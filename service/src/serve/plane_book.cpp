#include "serve/plane_book.hpp"

#include <algorithm>
#include <utility>

#include "config/map_gravity.hpp"

namespace planemap::service {
namespace {

/// The newest snapshot's, and that of one which somebody asks about once more.
constexpr std::size_t kKept = 2;

}  // namespace

PlaneBook::PlaneBook(const MapConfig& config) : gravity_(gravity_of(config)) {}

std::shared_ptr<const SnapshotQueries> PlaneBook::open(const std::shared_ptr<const MapSnapshot>& snapshot) {
  const std::lock_guard lock(mutex_);
  const auto known = std::find_if(recent_.begin(), recent_.end(),
                                  [&](const auto& queries) { return &queries->snapshot() == snapshot.get(); });
  if (known != recent_.end()) {
    std::rotate(recent_.begin(), known, known + 1);
    return recent_.front();
  }
  const auto kin = std::find_if(recent_.begin(), recent_.end(),
                                [&](const auto& queries) { return queries->snapshot().epoch() == snapshot->epoch(); });
  const SnapshotQueries* previous = kin != recent_.end() ? kin->get() : nullptr;
  recent_.push_front(std::make_shared<const SnapshotQueries>(snapshot, gravity_, previous));
  if (recent_.size() > kKept) recent_.pop_back();
  return recent_.front();
}

}  // namespace planemap::service
