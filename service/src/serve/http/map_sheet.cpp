#include "serve/http/map_sheet.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <planemap/block_table.hpp>
#include <planemap/coplanar.hpp>
#include <utility>

#include "export/export_map.hpp"
#include "export/formats.hpp"

namespace planemap::service {
namespace {

/// Standard deviation of the signed distance of the plane's centroid, metres: what is known worst about the offset is
/// what the tilt does far away, which says nothing of the plane where it was seen.
double offset_deviation_m(const PlaneRecord& record) {
  const Eigen::Vector4d at(record.centroid_m.x(), record.centroid_m.y(), record.centroid_m.z(), 1.0);
  return std::sqrt(std::max(0.0, at.dot(record.covariance * at)));
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

/// An object of planes.json, with more in it.
std::string json_of(const DescribedPlane& plane, const std::vector<PlaneId>& coplanar) {
  std::string json = planemap::plane_json({*plane.record, *plane.outline, plane.plane_class, coplanar});
  json.pop_back();  // the closing brace
  json += fmt::format(R"(,"normalDeviation":{},"offsetDeviation":{})", number(normal_deviation_rad(*plane.record)),
                      number(offset_deviation_m(*plane.record)));
  if (!coplanar.empty()) json += fmt::format(R"(,"coplanarWith":[{}])", fmt::join(coplanar, ","));
  return json + '}';
}

CoplanarLinks links_of(std::span<const DescribedPlane> planes) {
  std::vector<SizedPlane> sized;
  sized.reserve(planes.size());
  for (const DescribedPlane& plane : planes) sized.push_back({plane.record.get(), plane.outline->area_m2});
  return coplanar_links(sized);
}

/// The sheet before, where it is of the same map.
const MapSheet* usable(const MapSheet* previous, const MapSnapshot& snapshot) {
  return previous != nullptr && previous->snapshot().epoch() == snapshot.epoch() ? previous : nullptr;
}

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> serial = 0;
  return ++serial;
}

}  // namespace

MapSheet::MapSheet(std::shared_ptr<const SnapshotQueries> queries, std::string frame, const MapSheet* previous)
    : queries_(std::move(queries)), frame_(std::move(frame)), serial_(next_serial()) {
  previous = usable(previous, snapshot());
  complete_since_ = previous != nullptr ? previous->complete_since_ : snapshot().revision();
  add_planes(previous);
  add_blocks(previous);
  for (const std::uint64_t revision : block_revisions_) {
    newest_block_revision_ = std::max(newest_block_revision_, revision);
  }
}

/// Cells may change where no plane does, and then the revision stays: what such a sheet changes is of the next
/// revision, so that whoever has the sheet before gets it.
std::uint64_t MapSheet::revision_of_change(const MapSheet* previous) const {
  const std::uint64_t revision = snapshot().revision();
  return previous != nullptr && previous->snapshot().revision() == revision ? revision + 1 : revision;
}

void MapSheet::add_planes(const MapSheet* previous) {
  if (previous != nullptr && previous->snapshot().revision() == snapshot().revision()) {
    planes_ = previous->planes_;
    return;
  }
  const auto described = queries_->planes();
  const CoplanarLinks links = links_of(described);
  planes_.reserve(described.size());
  static const std::vector<Plane> kNone;
  const auto& before = previous != nullptr ? previous->planes_ : kNone;
  auto old = before.begin();  // both are by id
  for (const DescribedPlane& plane : described) {
    const auto linked = links.find(plane.record->id);
    const std::vector<PlaneId> coplanar = linked == links.end() ? std::vector<PlaneId>{} : linked->second;
    while (old != before.end() && old->record->id < plane.record->id) ++old;
    const bool is_same = old != before.end() && old->record == plane.record && old->outline == plane.outline &&
                         old->plane_class == plane.plane_class && old->coplanar == coplanar;
    planes_.push_back(is_same ? *old
                              : Plane{plane.record, plane.outline, plane.plane_class, coplanar,
                                      std::make_shared<const std::string>(json_of(plane, coplanar)),
                                      snapshot().revision()});
  }
}

void MapSheet::add_blocks(const MapSheet* previous) {
  constexpr std::size_t kPage = BlockTable::kPageSize;
  const BlockTable& blocks = snapshot().blocks();
  const std::uint64_t changed = revision_of_change(previous);
  block_revisions_.assign(blocks.size(), changed);
  if (previous == nullptr) return;
  const BlockTable& before = previous->snapshot().blocks();
  const std::size_t known = std::min(before.size(), blocks.size());
  for (std::size_t i = 0; i < known; ++i) {
    const bool is_same = blocks.shares_page(i / kPage, before) || blocks[i] == before[i];
    if (is_same) block_revisions_[i] = previous->block_revisions_[i];
  }
}

std::string MapSheet::etag() const {
  return fmt::format("\"{}-{}\"", snapshot().epoch(), snapshot().revision());
}

std::string MapSheet::planes_document() const {
  std::string text = fmt::format(R"({{"frame": {}, "epoch": {}, "revision": {}, "planes": [)",
                                 nlohmann::json(frame_).dump(), snapshot().epoch(), snapshot().revision());
  const char* separator = "\n";
  for (const Plane& plane : planes_) {
    text += separator;
    text += *plane.json;
    separator = ",\n";
  }
  return text + "\n]}\n";
}

const std::string* MapSheet::plane_json(PlaneId id) const {
  const auto at = std::lower_bound(planes_.begin(), planes_.end(), id,
                                   [](const Plane& plane, PlaneId wanted) { return plane.record->id < wanted; });
  return at != planes_.end() && at->record->id == id ? at->json.get() : nullptr;
}

std::shared_ptr<const std::string> MapSheet::delta_json(std::optional<std::uint64_t> since) const {
  if (since && (*since < complete_since_ || !snapshot().delta_since(*since))) since.reset();
  const std::lock_guard lock(mutex_);
  auto& delta = deltas_[since];
  if (!delta) delta = std::make_shared<const std::string>(make_delta(since));
  return delta;
}

std::string MapSheet::make_delta(std::optional<std::uint64_t> since) const {
  const auto is_news = [&](std::uint64_t revision) { return !since || revision > *since; };
  std::string text = fmt::format(R"({{"epoch":{},"revision":{},"since":{},"full":{},"planes":[)", snapshot().epoch(),
                                 snapshot().revision(), since.value_or(0), !since);
  const char* separator = "";
  for (const Plane& plane : planes_) {
    if (!is_news(plane.changed_revision)) continue;
    text += separator;
    text += *plane.json;
    separator = ",";
  }
  std::vector<PlaneId> removed;
  if (since) {
    for (const RemovedPlane& gone : snapshot().removed()) {
      if (gone.revision > *since) removed.push_back(gone.id);
    }
  }
  const auto blocks = std::count_if(block_revisions_.begin(), block_revisions_.end(), is_news);
  return text + fmt::format(R"(],"removed":[{}],"blocksChanged":{}}})", fmt::join(removed, ","), blocks);
}

}  // namespace planemap::service
