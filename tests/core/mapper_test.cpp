#include "planemap/mapper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A room of 4 x 3 x 2.5 m, turned against the grid; the camera turns round in its middle.
class Room {
 public:
  Room() {
    const Eigen::Matrix3d R =
        (Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.02, Vector3d::UnitX())).toRotationMatrix();
    const auto wall = [&](const Vector3d& normal, double distance_m) { walls.push_back({R * normal, distance_m}); };
    wall(Vector3d::UnitX(), 2.0);
    wall(-Vector3d::UnitX(), 2.0);
    wall(Vector3d::UnitY(), 1.5);
    wall(-Vector3d::UnitY(), 1.5);
    wall(Vector3d::UnitZ(), 1.2);
    wall(-Vector3d::UnitZ(), 1.3);
  }
  static Isometry3d pose(int step) {
    const double yaw = 0.35 * step;
    return testing::looking({0.1, 0.05, 0.0}, {0.1 + std::cos(yaw), 0.05 + std::sin(yaw), 0.8 * std::sin(0.9 * step)});
  }
  DepthScan scan(int step) const { return testing::render(walls, pose(step), static_cast<std::uint64_t>(step)); }

  std::vector<testing::Wall> walls;
};

Mapper mapped(const Room& room, int scans, Preset which = Preset::kBest) {
  Mapper mapper(preset(which), 7);
  for (int i = 0; i < scans; ++i) mapper.integrate(room.scan(i), Room::pose(i));
  return mapper;
}

TEST(Mapper, ARoomBecomesItsSixPlanes) {
  const Room room;
  Mapper mapper = mapped(room, 40);
  const auto map = mapper.snapshot();
  std::size_t large = 0;
  for (const auto& record : map->planes()) {
    if (record->cell_count < 60) continue;
    ++large;
    const auto is_of = [&](const testing::Wall& wall) {
      return testing::degrees_between(wall.normal, record->plane.normal()) < 0.3 &&
             std::abs(wall.normal.dot(record->centroid_m) + wall.d) < 0.003;
    };
    EXPECT_EQ(std::count_if(room.walls.begin(), room.walls.end(), is_of), 1) << "plane " << record->id;
  }
  EXPECT_EQ(large, 6U);
}

TEST(Mapper, FarLooksBesideNearOnesDoNotShiftAWall) {
  // Near looks lie in one layer of cells, far ones (25 mm of noise) in three.
  const Vector3d normal = Vector3d(-1.0, 0.05, 0.02).normalized();
  for (const double d : {4.01, 4.03, 4.05, 4.07}) {
    Mapper mapper(preset(Preset::kBest), 1);
    for (int i = 0; i < 16; ++i) {
      const double range_m = i % 2 == 0 ? 1.3 : 4.2;
      const Isometry3d T = testing::looking({d - range_m, 0.01 * i, 0.0}, {d, 0.05 * i, 0.0});
      mapper.integrate(testing::render({{normal, d}}, T, static_cast<std::uint64_t>(i)), T);
    }
    const auto map = mapper.snapshot();
    const auto largest = std::max_element(map->planes().begin(), map->planes().end(),
                                          [](const auto& a, const auto& b) { return a->cell_count < b->cell_count; });
    ASSERT_NE(largest, map->planes().end());
    EXPECT_NEAR(normal.dot((*largest)->centroid_m) + d, 0.0, 2e-4) << "wall at " << d;
  }
}

TEST(Mapper, ThePapersReadingFindsTheWallsToo) {
  const Room room;
  Mapper mapper = mapped(room, 40, Preset::kPaper);
  std::size_t found = 0;
  for (const testing::Wall& wall : room.walls) {
    const auto map = mapper.snapshot();
    const auto planes = map->planes();
    found += std::any_of(planes.begin(), planes.end(), [&](const auto& record) {
      return record->cell_count > 100 && testing::degrees_between(wall.normal, record->plane.normal()) < 6.0;
    });
  }
  EXPECT_GE(found, 5U);
}

TEST(Mapper, EveryRecordIsSoundAlsoThatOfASingleCell) {
  for (const Preset which : {Preset::kBest, Preset::kPaper}) {
    for (const double sigma_m : {0.0, 0.002}) {
      MapperConfig config = preset(which);
      config.pose_error.sigma_m = sigma_m;
      config.pose_error.sigma_rad = 0.5 * sigma_m;
      config.planes.min_cells = 1;
      Mapper mapper(config, 1);
      const Room room;
      for (int i = 0; i < 10; ++i) {
        const Isometry3d T = testing::looking({0.0, 0.0, 0.1}, {std::cos(0.6 * i), std::sin(0.6 * i), 0.2});
        mapper.integrate(testing::render(room.walls, T, static_cast<std::uint64_t>(i)), T);
      }
      const auto map = mapper.snapshot();
      std::size_t single = 0;
      for (const auto& record : map->planes()) {
        EXPECT_TRUE(record->covariance.allFinite()) << record->id << " of " << record->cell_count << " cells";
        EXPECT_GT(record->covariance.diagonal().minCoeff(), 0.0);
        EXPECT_NEAR(record->plane.normal().norm(), 1.0, 1e-9);
        single += record->cell_count == 1;
      }
      if (which == Preset::kPaper) {
        EXPECT_GT(single, 0U) << "no plane of a single cell: nothing was shown";
      }
    }
  }
}

TEST(Mapper, AStatedCovarianceCountsLikeTheConfiguredOne) {
  const Room room;
  MapperConfig exact = preset(Preset::kBest);
  exact.pose_error.correlation_s = 1.0;
  MapperConfig configured = exact;
  configured.pose_error.sigma_m = 0.004;
  configured.pose_error.sigma_rad = 0.002;
  const auto map_of = [&](const MapperConfig& config, const std::optional<PoseCovariance>& stated) {
    Mapper mapper(config, 7);
    for (int i = 0; i < 15; ++i) mapper.integrate(room.scan(i), Room::pose(i), nullptr, stated);
    return mapper.snapshot();
  };
  const auto without = map_of(exact, std::nullopt);
  const auto by_config = map_of(configured, std::nullopt);
  const auto by_scan = map_of(exact, configured_covariance(configured.pose_error));
  ASSERT_EQ(by_scan->planes().size(), by_config->planes().size());
  ASSERT_GT(by_scan->planes().size(), 3U);
  for (std::size_t i = 0; i < by_scan->planes().size(); ++i) {
    const PlaneRecord& record = *by_scan->planes()[i];
    EXPECT_EQ(record.id, by_config->planes()[i]->id);
    EXPECT_TRUE(record.covariance.isApprox(by_config->planes()[i]->covariance, 1e-9)) << record.id;
  }
  for (const auto& record : without->planes()) {
    const auto* other = by_scan->find(record->id);
    if (record->cell_count < 60 || other == nullptr) continue;
    EXPECT_GT(other->covariance(3, 3), 2.0 * record->covariance(3, 3)) << record->id;
  }
}

TEST(Mapper, EveryCellOfAPlaneIsCountedInItsRecord) {
  Mapper mapper = mapped(Room(), 25);
  const auto map = mapper.snapshot();
  std::map<PlaneId, std::uint32_t> cells;
  std::map<PlaneId, std::uint64_t> points;
  map->for_each_cell([&](const CellView& cell) {
    if (cell.plane_id == kNoPlane) return;
    ++cells[cell.plane_id];
    points[cell.plane_id] += cell.count;
  });
  ASSERT_GE(map->planes().size(), 5U);
  EXPECT_EQ(cells.size(), map->planes().size());
  for (const auto& record : map->planes()) {
    EXPECT_EQ(cells[record->id], record->cell_count);
    EXPECT_EQ(points[record->id], record->point_count);
    EXPECT_GT(record->quality, 0.5);
    EXPECT_LE(record->quality, 1.0);
  }
}

TEST(Mapper, TheSameScansGiveTheSameBytes) {
  const Room room;
  Mapper a = mapped(room, 15);
  Mapper b = mapped(room, 15);
  const auto map_a = a.snapshot();
  const auto map_b = b.snapshot();
  ASSERT_EQ(map_a->planes().size(), map_b->planes().size());
  EXPECT_EQ(map_a->revision(), map_b->revision());
  for (std::size_t i = 0; i < map_a->planes().size(); ++i) {
    const PlaneRecord& x = *map_a->planes()[i];
    const PlaneRecord& y = *map_b->planes()[i];
    EXPECT_EQ(x.id, y.id);
    EXPECT_EQ(x.plane.normal(), y.plane.normal());
    EXPECT_EQ(x.plane.d(), y.plane.d());
    EXPECT_EQ(x.covariance, y.covariance);
  }
}

TEST(Mapper, SnapshotsAreNotChangedByLaterScans) {
  const Room room;
  Mapper mapper = mapped(room, 5);
  const auto before = mapper.snapshot();
  std::vector<double> centres;
  before->for_each_cell([&](const CellView& cell) { centres.push_back(cell.centre_m.sum()); });
  const std::size_t planes = before->planes().size();
  for (int i = 5; i < 10; ++i) mapper.integrate(room.scan(i), Room::pose(i));
  std::vector<double> again;
  before->for_each_cell([&](const CellView& cell) { again.push_back(cell.centre_m.sum()); });
  EXPECT_EQ(centres, again);
  EXPECT_EQ(before->planes().size(), planes);
  EXPECT_GT(mapper.snapshot()->cell_count(), before->cell_count());
}

TEST(Mapper, DeltasLeadFromOneSnapshotToTheNext) {
  const Room room;
  Mapper mapper(preset(Preset::kBest), 7);
  std::map<PlaneId, std::shared_ptr<const PlaneRecord>> follower;
  std::uint64_t revision = 0;
  std::size_t removals = 0;
  for (int i = 0; i < 30; ++i) {
    mapper.integrate(room.scan(i), Room::pose(i));
    if (i % 3 != 2) continue;
    const auto map = mapper.snapshot();
    const auto delta = map->delta_since(revision);
    ASSERT_TRUE(delta.has_value());
    for (const RemovedPlane& gone : delta->removed) {
      follower.erase(gone.id);
      ++removals;
    }
    for (const auto& record : delta->changed) follower[record->id] = record;
    revision = delta->revision;
    ASSERT_EQ(follower.size(), map->planes().size());
    for (const auto& record : map->planes()) EXPECT_EQ(follower.at(record->id), record);
  }
  EXPECT_GT(revision, 0U);
}

TEST(Mapper, ADeltaFromTheFutureIsRefused) {
  Mapper mapper = mapped(Room(), 3);
  const auto map = mapper.snapshot();
  EXPECT_FALSE(map->delta_since(map->revision() + 1).has_value());
  ASSERT_TRUE(map->delta_since(map->revision()).has_value());
  EXPECT_TRUE(map->delta_since(map->revision())->changed.empty());
}

TEST(Mapper, AnEmptyScanChangesNothing) {
  Mapper mapper = mapped(Room(), 3);
  const auto before = mapper.snapshot();
  DepthScan nothing;
  nothing.utime = 99'000'000;
  nothing.intrinsics = {4, 4, 5.0, 5.0, 2.0, 2.0};
  nothing.depth.assign(16, kNoReturn);
  const ScanReport report = mapper.integrate(nothing, Isometry3d::Identity());
  EXPECT_EQ(report.points.mapped, 0U);
  EXPECT_FALSE(report.planes_changed);
  EXPECT_EQ(mapper.snapshot()->revision(), before->revision());
  EXPECT_EQ(mapper.snapshot()->cell_count(), before->cell_count());
}

bool near_side(const Vector3d& p) {
  return p.y() < -0.4;
}
bool far_side(const Vector3d& p) {
  return p.y() > 0.4;
}

/// Two looks at a wall that has a gap of 0.8 m, a door's width: each sees one piece only.
std::size_t planes_across_a_gap(double bridge_gap_m, double step_m) {
  MapperConfig config = preset(Preset::kBest);
  config.planes.bridge_gap_m = bridge_gap_m;
  Mapper mapper(config, 1);
  const std::vector<testing::Wall> wall = {{-Vector3d::UnitX(), 2.5, near_side},
                                           {-Vector3d::UnitX(), 2.5 + step_m, far_side}};
  for (int i = 0; i < 6; ++i) {
    const double y = i % 2 == 0 ? -1.7 : 1.7;
    const Isometry3d T = testing::looking({0.0, y, 0.1}, {2.5, y, 0.1});
    mapper.integrate(testing::render(wall, T, static_cast<std::uint64_t>(i)), T);
  }
  const auto map = mapper.snapshot();
  return static_cast<std::size_t>(
      std::count_if(map->planes().begin(), map->planes().end(), [](const auto& r) { return r->cell_count > 60; }));
}

TEST(Mapper, PiecesOfAWallAcrossADoorAreOnePlane) {
  EXPECT_EQ(planes_across_a_gap(1.0, 0.0), 1U);
}

TEST(Mapper, WithoutBridgingTheyStayTwo) {
  EXPECT_EQ(planes_across_a_gap(0.0, 0.0), 2U);
}

TEST(Mapper, PiecesThatAreNotCoplanarAreNotBridged) {
  EXPECT_EQ(planes_across_a_gap(1.0, 0.05), 2U);
}

bool on_boxes(const Vector3d& p) {
  return std::abs(std::remainder(p.y(), 0.64)) < 0.12 && std::abs(std::remainder(p.z(), 0.64)) < 0.12;
}

TEST(Mapper, AScanOfAHopelessPoseDoesNotWidenTheBandsForGood) {
  // A wall, and boxes of a few cells that stand 7 cm before it; one scan in twenty may be off by 5 m.
  const std::vector<testing::Wall> wall = {{-Vector3d::UnitX(), 2.5}, {-Vector3d::UnitX(), 2.43, on_boxes}};
  const auto cells_of_the_wall = [&](double sigma_m) {
    PoseErrorConfig hopeless;
    hopeless.sigma_m = sigma_m;
    Mapper mapper(preset(Preset::kBest), 1);
    const Isometry3d T = testing::looking({0.0, 0.0, 0.1}, {2.5, 0.0, 0.1});
    for (int i = 0; i < 20; ++i) {
      const PoseCovariance x = i == 3 ? configured_covariance(hopeless) : PoseCovariance(PoseCovariance::Zero());
      mapper.integrate(testing::render(wall, T, static_cast<std::uint64_t>(i)), T, nullptr, x);
    }
    std::uint32_t most = 0;
    const auto map = mapper.snapshot();
    for (const auto& record : map->planes()) most = std::max(most, record->cell_count);
    return most;
  };
  const std::uint32_t expected = cells_of_the_wall(0.0);
  EXPECT_GT(expected, 1000U);
  EXPECT_NEAR(cells_of_the_wall(5.0), expected, 5.0);
}

TEST(Mapper, AMergedPlaneNamesTheOnesItHoldsAndTheOldestIdLivesOn) {
  MapperConfig config = preset(Preset::kBest);
  Mapper mapper(config, 1);
  const std::vector<testing::Wall> wall = {{-Vector3d::UnitX(), 2.5, nullptr}};
  const auto look = [&](double y, std::uint64_t seed) {
    const Isometry3d T = testing::looking({0.0, y, 0.1}, {2.5, y, 0.1});
    mapper.integrate(testing::render(wall, T, seed), T);
  };
  look(-3.0, 1);  // two pieces 1.5 m and more apart ...
  look(3.0, 2);
  ASSERT_EQ(mapper.snapshot()->planes().size(), 2U);
  const std::uint64_t revision = mapper.snapshot()->revision();
  look(0.0, 3);  // ... and what lies between them
  look(-1.5, 4);
  look(1.5, 5);
  const auto map = mapper.snapshot();
  ASSERT_EQ(map->planes().size(), 1U);
  EXPECT_EQ(map->planes()[0]->id, 1U);
  const std::vector<PlaneId>& merged = map->planes()[0]->merged;
  EXPECT_EQ(std::count(merged.begin(), merged.end(), PlaneId{2}), 1);
  EXPECT_EQ(map->find(2), nullptr);
  const auto delta = map->delta_since(revision);
  ASSERT_TRUE(delta.has_value());
  ASSERT_EQ(delta->removed.size(), 1U);  // a plane that came and went in between was never seen
  EXPECT_EQ(delta->removed[0].id, 2U);
  EXPECT_EQ(delta->removed[0].merged_into, 1U);
}

/// Remembers the order in which stages began and ended.
class Recorder final : public StageObserver {
 public:
  void stage_begins(Stage stage) override { log += std::string("<") + name_of(stage); }
  void stage_ends(Stage) override { log += ">"; }
  std::string log;
};

TEST(Mapper, TellsItsStagesInTheOrderOfThePaper) {
  const Room room;
  Mapper mapper(preset(Preset::kBest), 1);
  Recorder recorder;
  mapper.integrate(room.scan(0), Room::pose(0), &recorder);
  mapper.snapshot(&recorder);
  EXPECT_EQ(recorder.log, "<assign><normals><localPlanes><wear><globalPlanes><snapshot>");
}

}  // namespace
}  // namespace planemap
