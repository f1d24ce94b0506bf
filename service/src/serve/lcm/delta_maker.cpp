#include "serve/lcm/delta_maker.hpp"

#include <utility>
#include <vector>

#include "codec/plane_codec.hpp"

namespace planemap::service {

DeltaMaker::DeltaMaker(const ServiceConfig& config, PlaneBook& book)
    : book_(book), frame_(config.map.frame), page_bytes_(static_cast<std::size_t>(config.publish.page_bytes)) {}

Pages DeltaMaker::make(const std::shared_ptr<const MapSnapshot>& snapshot) {
  const bool is_same_epoch = snapshot->epoch() == epoch_;
  if (is_same_epoch && snapshot->revision() == revision_) return {};
  std::uint64_t since = is_same_epoch ? revision_ : 0;
  auto delta = snapshot->delta_since(since);
  if (!delta) since = 0;
  if (since == 0) told_classes_.clear();
  std::vector<planemap_lcm::plane_t> planes;
  std::map<PlaneId, PlaneClass> classes;
  const auto queries = book_.open(snapshot);
  for (const auto& plane : queries->planes()) {
    const auto told = told_classes_.find(plane.record->id);
    const bool is_news =
        plane.record->revision > since || told == told_classes_.end() || told->second != plane.plane_class;
    if (is_news) planes.push_back(to_wire(*plane.record, *plane.outline, plane.plane_class));
    classes.emplace(plane.record->id, plane.plane_class);
  }
  std::vector<planemap_lcm::removed_plane_t> removed;
  if (delta) {
    for (const auto& gone : delta->removed) removed.push_back(to_wire(gone));
  }
  planemap_lcm::planes_t header{};
  header.utime = snapshot->utime();
  header.epoch = static_cast<std::int64_t>(snapshot->epoch());
  header.since_revision = static_cast<std::int64_t>(since);
  header.revision = static_cast<std::int64_t>(snapshot->revision());
  header.frame = frame_;
  epoch_ = snapshot->epoch();
  revision_ = snapshot->revision();
  told_classes_ = std::move(classes);
  return encode_pages(std::move(header), std::move(planes), removed, page_bytes_, snapshot->cell_size_m());
}

}  // namespace planemap::service
