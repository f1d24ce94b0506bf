#include "map_addition.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <planemap/block.hpp>
#include <planemap/mapper.hpp>

#include "rooms.hpp"

namespace planemap {
namespace {

using testing::degrees_between;
using testing::looking;
using testing::render;
using Snapshot = std::shared_ptr<const MapSnapshot>;

constexpr int kScans = 24;

/// Scan number `step` of a camera that turns from the left wall to the right one.
void look(Mapper& mapper, int step, const Eigen::Isometry3d& T_map_room = Eigen::Isometry3d::Identity()) {
  const double y = -1.8 + 3.6 * step / (kScans - 1);
  const auto T = looking({-1.0, 0.0, 1.2}, {1.0, y, 0.6});
  mapper.integrate(render(testing::small_room(), T, static_cast<std::uint64_t>(step), 1.0, 160, 120), T_map_room * T);
}

Mapper mapped(int first, int last, std::uint64_t epoch,
              const Eigen::Isometry3d& T_map_room = Eigen::Isometry3d::Identity()) {
  Mapper mapper(preset(Preset::kBest), epoch);
  for (int i = first; i < last; ++i) look(mapper, i, T_map_room);
  return mapper;
}

Mapper sum_of(Mapper a, const Snapshot& b) {
  const auto report = a.add(*b);
  EXPECT_TRUE(report.has_value()) << report.error().message;
  return a;
}

struct PlaceSums {
  double count = 0.0;
  Eigen::Vector3d first_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d square_m2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d error_m2 = Eigen::Vector3d::Zero();
  void add(const CellSums& sums) {
    count += sums.count;
    first_m += sums.first_m;
    square_m2 += sums.square_m2.cast<double>();
    error_m2 += sums.error_m2.cast<double>();
  }
};
using Places = std::map<std::array<int, 3>, PlaceSums>;

/// By place: two cells at one place count together.
void add_places(const MapSnapshot& map, Places& places) {
  for (const auto& block : map.blocks()) {
    for (std::size_t i = 0; i < block->size(); ++i) {
      const CellIndex index = block->cell_index(i);
      places[{index.x(), index.y(), index.z()}].add(block->cell(i).sums);
    }
  }
}
Places places_of(const MapSnapshot& map) {
  Places places;
  add_places(map, places);
  return places;
}

void expect_equal_sums(const Places& a, const Places& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [index, sums] : a) {
    const auto other = b.find(index);
    ASSERT_TRUE(other != b.end());
    ASSERT_EQ(sums.count, other->second.count);
    const double scale = 1e-12 + sums.count;
    ASSERT_LE((sums.first_m - other->second.first_m).norm(), 1e-12 * scale);
    ASSERT_LE((sums.square_m2 - other->second.square_m2).norm(), 1e-6 * (sums.square_m2.norm() + 1e-12));
    ASSERT_LE((sums.error_m2 - other->second.error_m2).norm(), 1e-6 * (sums.error_m2.norm() + 1e-12));
  }
}

/// Share of the cells with a plane in `a` whose plane in `b` is the counterpart of theirs.
double overlap(const MapSnapshot& a, const MapSnapshot& b, const std::map<PlaneId, PlaneId>& counterparts) {
  std::map<std::array<int, 3>, PlaneId> labels;
  b.for_each_cell([&](const CellView& cell) {
    labels[{cell.index.x(), cell.index.y(), cell.index.z()}] = cell.plane_id;
  });
  double all = 0.0;
  double same = 0.0;
  a.for_each_cell([&](const CellView& cell) {
    if (cell.plane_id == kNoPlane) return;
    ++all;
    const auto found = labels.find({cell.index.x(), cell.index.y(), cell.index.z()});
    if (found != labels.end() && found->second == counterparts.at(cell.plane_id)) ++same;
  });
  return same / all;
}

/// Planes of `b` for those of `a`, by normal and offset.
std::map<PlaneId, PlaneId> counterparts(const MapSnapshot& a, const MapSnapshot& b, double deg, double offset_m) {
  std::map<PlaneId, PlaneId> pairs;
  for (const auto& p : a.planes()) {
    for (const auto& q : b.planes()) {
      if (degrees_between(p->plane.normal(), q->plane.normal()) > deg) continue;
      if (std::abs(p->plane.signed_distance_m(q->centroid_m)) > offset_m) continue;
      EXPECT_FALSE(pairs.contains(p->id)) << "two planes stand for one";
      pairs[p->id] = q->id;
    }
    EXPECT_TRUE(pairs.contains(p->id)) << "no plane stands for " << p->id;
  }
  return pairs;
}

TEST(MapAddition, SumsOfEachPlaceAdd) {
  Mapper a = mapped(0, 12, 1);
  Mapper b = mapped(12, kScans, 2);
  Places expected = places_of(*a.snapshot());
  add_places(*b.snapshot(), expected);
  const auto before = a.snapshot();
  const auto report = a.add(*b.snapshot());
  ASSERT_TRUE(report);
  EXPECT_EQ(report->added_cells, b.snapshot()->cell_count());
  const auto after = a.snapshot();
  expect_equal_sums(expected, places_of(*after));
  EXPECT_EQ(after->epoch(), 1u);
  EXPECT_EQ(after->revision(), before->revision() + 1);
  EXPECT_EQ(after->utime(), b.snapshot()->utime());
}

TEST(MapAddition, IsAssociative) {
  const Snapshot b = mapped(8, 16, 2).snapshot();
  const Snapshot c = mapped(16, kScans, 3).snapshot();
  const Snapshot left = sum_of(sum_of(mapped(0, 8, 1), b), c).snapshot();
  const Snapshot right = sum_of(mapped(0, 8, 1), sum_of(mapped(8, 16, 2), c).snapshot()).snapshot();
  expect_equal_sums(places_of(*left), places_of(*right));
  counterparts(*left, *right, 0.1, 0.002);
}

TEST(MapAddition, PlanesComeOutAsIfMapped) {
  const Snapshot whole = mapped(0, kScans, 1).snapshot();
  const Snapshot sum = sum_of(mapped(0, 12, 1), mapped(12, kScans, 2).snapshot()).snapshot();
  ASSERT_EQ(whole->planes().size(), 4u);
  ASSERT_EQ(sum->planes().size(), 4u);
  const auto pairs = counterparts(*whole, *sum, 0.1, 0.002);
  EXPECT_GE(overlap(*whole, *sum, pairs), 0.95);
  for (const auto& [of_whole, of_sum] : pairs) {
    const double ratio = sum->find(of_sum)->covariance.trace() / whole->find(of_whole)->covariance.trace();
    EXPECT_GT(ratio, 0.7);
    EXPECT_LT(ratio, 1.4);
  }
}

TEST(MapAddition, OurPlanesKeepTheirIdsAndKnowWhenTheyWereSeenFirst) {
  Mapper later = mapped(12, kScans, 1);
  const Snapshot before = later.snapshot();
  const Snapshot earlier = mapped(0, 12, 2).snapshot();
  const Snapshot sum = sum_of(std::move(later), earlier).snapshot();
  for (const auto& plane : before->planes()) {
    const PlaneRecord* now = sum->find(plane->id);
    ASSERT_NE(now, nullptr);
    EXPECT_LE(now->first_seen_utime, plane->first_seen_utime);
    EXPECT_EQ(now->last_seen_utime, plane->last_seen_utime);
  }
  // The floor was seen first by the other map's first scan.
  const auto floor = [](const Snapshot& map) {
    const auto planes = map->planes();
    return *std::find_if(planes.begin(), planes.end(), [](const auto& p) { return p->plane.normal().z() > 0.9; });
  };
  EXPECT_LT(floor(earlier)->first_seen_utime, floor(before)->first_seen_utime);
  EXPECT_EQ(floor(sum)->first_seen_utime, floor(earlier)->first_seen_utime);
}

TEST(MapAddition, AMapOfNothingTakesAllOfTheOther) {
  const Snapshot b = mapped(0, kScans, 2).snapshot();
  const Snapshot sum = sum_of(Mapper(preset(Preset::kBest), 1), b).snapshot();
  expect_equal_sums(places_of(*b), places_of(*sum));
  EXPECT_GE(overlap(*b, *sum, counterparts(*b, *sum, 0.1, 0.002)), 0.9);
}

TEST(MapAddition, AMapOfAnotherFrameIsMoved) {
  Eigen::Isometry3d T_theirs_room = Eigen::Isometry3d::Identity();
  T_theirs_room.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()));
  T_theirs_room.pretranslate(Eigen::Vector3d(3.0, -2.0, 0.5));
  const Snapshot whole = mapped(0, kScans, 1).snapshot();
  Mapper ours = mapped(0, 12, 1);
  const Snapshot theirs = mapped(12, kScans, 2, T_theirs_room).snapshot();
  const auto report = ours.add(*theirs, T_theirs_room.inverse());
  ASSERT_TRUE(report) << report.error().message;
  const Snapshot sum = ours.snapshot();
  ASSERT_EQ(sum->planes().size(), 4u);
  counterparts(*whole, *sum, 0.3, 0.003);
  double points = 0.0;
  for (const auto& [index, sums] : places_of(*sum)) points += sums.count;
  double expected = 0.0;
  for (const auto& [index, sums] : places_of(*whole)) expected += sums.count;
  EXPECT_NEAR(points, expected, 0.5);
}

TEST(MapAddition, AMovedCellHasTheMomentsOfTheMovedPoints) {
  // Two points, at (1, 2, 3) and (3, 2, 5) cm from the centre, turned by a right angle about z: x to y, y to -x.
  Cell cell;
  ScanSums scan;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.01, 0.02, 0.03), Eigen::Vector3d(0.03, 0.02, 0.05)}) {
    scan.points.add({1.0, p, Symmetric3::outer(p)});
  }
  scan.error_m2 = {1e-6, 4e-6, 9e-6};
  scan.view = {2.0F, 0.0F, 0.0F};
  cell.add(scan, Eigen::Vector3d::UnitX());
  cell.normal = {1.0F, 0.0F, 0.0F};
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  T.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  const Cell out = moved(cell, {0.04, 0.04, 0.04}, T, {0.92, 0.04, 0.04});
  // The points are at (0.05, 0.06, .) and (0.07, 0.06, .) in x, y: moved to (0.94, 0.05) and (0.94, 0.07).
  EXPECT_EQ(out.sums.count, 2.0);
  EXPECT_LE((out.sums.first_m - Eigen::Vector3d(0.04, 0.04, 0.08)).norm(), 1e-9);
  EXPECT_NEAR(out.sums.square_m2.x(), 0.0008, 1e-8);
  EXPECT_NEAR(out.sums.square_m2.y(), 0.0010, 1e-8);
  EXPECT_NEAR(out.sums.square_m2.z(), 0.0034, 1e-8);
  EXPECT_LE((out.sums.error_m2 - Eigen::Vector3f(4e-6F, 1e-6F, 9e-6F)).norm(), 1e-12F);
  EXPECT_LE((out.sums.view - Eigen::Vector3f(0.0F, 2.0F, 0.0F)).norm(), 1e-6F);
  EXPECT_LE((out.normal - Eigen::Vector3f(0.0F, 1.0F, 0.0F)).norm(), 1e-6F);
  EXPECT_LE((out.evidence.unpacked().mean() - Eigen::Vector3d(0.02, 0.02, 0.04)).norm(), 1e-7);
}

TEST(MapAddition, MapsWithCellsOfAnotherSizeAreRefused) {
  MapperConfig config = preset(Preset::kBest);
  config.grid.cell_size_m = 0.1;
  Mapper mapper(config, 1);
  const auto report = mapper.add(*mapped(0, 2, 2).snapshot());
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("0.08"), std::string::npos) << report.error().message;
  EXPECT_EQ(mapper.snapshot()->cell_count(), 0u);
}

}  // namespace
}  // namespace planemap
