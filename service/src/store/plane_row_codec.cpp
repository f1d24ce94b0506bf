#include "store/plane_row_codec.hpp"

#include <planemap/plane_state.hpp>

#include "store/packing.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kMostMerged = 1'000'000;
constexpr std::size_t kMostBytes = 4096 + 8 * kMostMerged;

/// All numbers of a record and a state but the plane's own, in the order on file; merged ids come behind.
template <class Record, class State, class Visit>
void visit_numbers(Record& record, State& state, Visit&& visit) {
  visit(record.cell_count);
  visit(record.point_count);
  visit(record.first_seen_utime);
  visit(record.last_seen_utime);
  visit(record.quality);
  visit(record.revision);
  for (Eigen::Index i = 0; i < 16; ++i) visit(record.covariance.data()[i]);
  for (auto& x : record.centroid_m) visit(x);
  auto& fit = state.fit;
  for (auto& x : fit.centroid_m) visit(x);
  for (auto& x : fit.tangent_1) visit(x);
  for (auto& x : fit.tangent_2) visit(x);
  for (auto* x : {&fit.spread_1_m2, &fit.spread_2_m2, &fit.residual_m2, &fit.deviation_rad, &fit.weight,
                  &fit.tilt_1_rad2, &fit.tilt_2_rad2, &fit.cell_dispersion}) {
    visit(*x);
  }
  PlaneStatistics::visit_numbers(state.statistics, visit);
  PoseEvidence::visit_numbers(state.pose_evidence, visit);
  visit(state.worn_cells);
  visit(state.cells_when_bridged);
  visit(state.scans_since_bridged);
}

}  // namespace

Bytes encode_plane(const PlaneRecord& record) {
  ByteWriter<> writer;
  for (const double x : record.plane.normal()) writer.put(x);
  writer.put(record.plane.d());
  visit_numbers(record, *record.state, [&](auto number) { writer.put(number); });
  writer.put(static_cast<std::uint32_t>(record.merged.size()));
  for (const PlaneId id : record.merged) writer.put(id);
  return packed(writer.bytes());
}

Expected<std::shared_ptr<const PlaneRecord>> decode_plane(PlaneId id, std::span<const std::uint8_t> bytes) {
  const auto raw = unpacked(bytes, kMostBytes);
  if (!raw) return tl::make_unexpected(raw.error());
  ByteReader reader(*raw);
  Eigen::Vector3d normal;
  for (double& x : normal) x = reader.get<double>();
  const auto plane = Plane::from_unit_normal(normal, reader.get<double>());
  if (!plane) return tl::make_unexpected(plane.error());
  auto record = std::make_shared<PlaneRecord>();
  auto state = std::make_shared<PlaneState>();
  record->id = id;
  record->plane = *plane;
  visit_numbers(*record, *state, [&](auto& number) { number = reader.get<std::decay_t<decltype(number)>>(); });
  state->fit.plane = *plane;
  const std::size_t merged = reader.get<std::uint32_t>();
  if (!reader.ok() || merged > kMostMerged || merged * sizeof(PlaneId) != reader.remaining()) {
    return fail("it is cut short, or too long");
  }
  record->merged.reserve(merged);
  for (std::size_t i = 0; i < merged; ++i) record->merged.push_back(reader.get<PlaneId>());
  record->state = std::move(state);
  return std::shared_ptr<const PlaneRecord>(std::move(record));
}

}  // namespace planemap::service
