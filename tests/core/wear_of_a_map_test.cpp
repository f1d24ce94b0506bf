// Wear in made-up rooms: what is carried away goes, what stands stays.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "planemap/mapper.hpp"
#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kCellM = 0.08;

bool in_box_front(const Vector3d& p) {
  return std::abs(p.y()) < 0.3 && p.z() < 0.0;
}
bool in_box_top(const Vector3d& p) {
  return std::abs(p.y()) < 0.3 && p.x() > 1.5 && p.x() < 2.0;
}

std::vector<testing::Wall> floor_and_wall() {
  return {{-Vector3d::UnitX(), 3.0}, {Vector3d::UnitZ(), 1.0}};
}
/// A box of 50 x 60 x 100 cm on the floor, a metre before the wall.
std::vector<testing::Wall> with_box() {
  auto walls = floor_and_wall();
  walls.push_back({-Vector3d::UnitX(), 1.5, in_box_front});
  walls.push_back({Vector3d::UnitZ(), 0.0, in_box_top});
  return walls;
}
bool is_of_box(const Vector3d& p) {
  return p.x() > 1.4 && p.x() < 2.1 && std::abs(p.y()) < 0.4 && p.z() > -0.88;  // 12 cm above the floor
}

/// A sensor at 1.5 m above the floor that looks about a little.
Isometry3d looking_at_box(int frame) {
  return testing::looking({0.0, 0.1, 0.5}, {2.0, 0.15 * std::sin(0.2 * frame), -0.6});
}

std::size_t dense_cells(Mapper& mapper, bool (*where)(const Vector3d&)) {
  std::size_t count = 0;
  mapper.snapshot()->for_each_cell([&](const CellView& cell) { count += where(cell.centre_m); });
  return count;
}

const PlaneRecord* box_front(const MapSnapshot& map) {
  for (const auto& record : map.planes()) {
    if (std::abs(record->centroid_m.x() - 1.5) < 0.05 && record->plane.normal().x() < -0.9) return record.get();
  }
  return nullptr;
}

struct BoxRun {
  std::size_t box_cells_before = 0;
  std::size_t box_cells_after = 0;
  std::shared_ptr<const MapSnapshot> before;
  std::shared_ptr<const MapSnapshot> after;
  std::size_t worn = 0;
};

/// Two seconds with the box, then three without, at 10 scans a second.
BoxRun run_box(const MapperConfig& config, bool as_cloud = false) {
  Mapper mapper(config, 1);
  BoxRun run;
  for (int i = 0; i < 50; ++i) {
    DepthScan scan = testing::render(i < 20 ? with_box() : floor_and_wall(), looking_at_box(i), 1);
    scan.utime = 1'000'000 + 100'000 * i;
    const ScanReport report = as_cloud ? mapper.integrate(testing::cloud_of(scan), looking_at_box(i))
                                       : mapper.integrate(scan, looking_at_box(i));
    run.worn += report.worn_cells;
    if (i != 19) continue;
    EXPECT_EQ(run.worn, 0U);
    run.box_cells_before = dense_cells(mapper, is_of_box);
    run.before = mapper.snapshot();
  }
  run.box_cells_after = dense_cells(mapper, is_of_box);
  run.after = mapper.snapshot();
  return run;
}

TEST(WearOfAMap, ABoxThatIsCarriedAwayIsGoneInThreeSeconds) {
  const BoxRun run = run_box(preset(Preset::kBest));
  ASSERT_GE(run.box_cells_before, 100U);
  EXPECT_EQ(run.box_cells_after, 0U);
  EXPECT_GE(run.worn, run.box_cells_before);
  const PlaneRecord* front = box_front(*run.before);
  ASSERT_NE(front, nullptr);
  EXPECT_EQ(run.after->find(front->id), nullptr);
  const auto delta = run.after->delta_since(run.before->revision());
  ASSERT_TRUE(delta.has_value());
  std::set<PlaneId> removed;
  for (const RemovedPlane& gone : delta->removed) {
    EXPECT_EQ(gone.merged_into, kNoPlane) << gone.id;
    removed.insert(gone.id);
  }
  EXPECT_TRUE(removed.contains(front->id));
}

TEST(WearOfAMap, TheFloorAndTheWallBehindItAreStillThere) {
  const BoxRun run = run_box(preset(Preset::kBest));
  for (const testing::Wall& wall : floor_and_wall()) {
    const auto is_of = [&](const std::shared_ptr<const PlaneRecord>& record) {
      return testing::degrees_between(wall.normal, record->plane.normal()) < 0.3 &&
             std::abs(wall.normal.dot(record->centroid_m) + wall.d) < 0.003;
    };
    const auto before = run.before->planes();
    const auto found = std::find_if(before.begin(), before.end(), is_of);
    ASSERT_NE(found, before.end());
    const PlaneRecord* after = run.after->find((*found)->id);
    ASSERT_NE(after, nullptr);
    EXPECT_GT(after->cell_count, (*found)->cell_count);  // what the box hid has been seen
  }
  EXPECT_EQ(run.after->planes().size(), 2U);
}

TEST(WearOfAMap, WithoutItTheBoxStays) {
  MapperConfig config = preset(Preset::kBest);
  config.wear.enabled = false;
  const BoxRun run = run_box(config);
  EXPECT_EQ(run.worn, 0U);
  EXPECT_GE(run.box_cells_after, run.box_cells_before);
  EXPECT_NE(box_front(*run.after), nullptr);
}

TEST(WearOfAMap, ThePaperKnowsNoWear) {
  EXPECT_FALSE(preset(Preset::kPaper).wear.enabled);
  EXPECT_EQ(run_box(preset(Preset::kPaper)).worn, 0U);
}

TEST(WearOfAMap, PointCloudsSeeThroughItToo) {
  const BoxRun run = run_box(preset(Preset::kBest), /*as_cloud=*/true);
  ASSERT_GE(run.box_cells_before, 100U);
  EXPECT_EQ(run.box_cells_after, 0U);
}

TEST(WearOfAMap, PlanesHoldWhatTheirCellsHold) {
  // A box half of whose front goes: its plane must lose exactly what the worn cells had brought.
  const auto half_box = [](const Vector3d& p) { return p.y() > 0.0 && p.y() < 0.3 && p.z() < 0.0; };
  Mapper mapper(preset(Preset::kBest), 1);
  for (int i = 0; i < 40; ++i) {
    auto walls = i < 15 ? with_box() : floor_and_wall();
    if (i >= 15) walls.push_back({-Vector3d::UnitX(), 1.5, half_box});
    DepthScan scan = testing::render(walls, looking_at_box(i), static_cast<std::uint64_t>(i));
    scan.utime = 1'000'000 + 100'000 * i;
    mapper.integrate(scan, looking_at_box(i));
  }
  const auto map = mapper.snapshot();
  std::map<PlaneId, std::uint32_t> cells;
  std::map<PlaneId, std::uint64_t> points;
  map->for_each_cell([&](const CellView& cell) {
    if (cell.plane_id == kNoPlane) return;
    ++cells[cell.plane_id];
    points[cell.plane_id] += cell.count;
  });
  const PlaneRecord* front = box_front(*map);
  ASSERT_NE(front, nullptr);
  EXPECT_GT(front->centroid_m.y(), 0.1);
  EXPECT_LT(testing::degrees_between(front->plane.normal(), -Vector3d::UnitX()), 0.5);
  for (const auto& record : map->planes()) {
    EXPECT_EQ(cells[record->id], record->cell_count);
    EXPECT_EQ(points[record->id], record->point_count);
  }
}

TEST(WearOfAMap, EarlierSnapshotsKeepWhatWasWornAway) {
  const BoxRun run = run_box(preset(Preset::kBest));
  std::size_t cells = 0;
  run.before->for_each_cell([&](const CellView& cell) { cells += is_of_box(cell.centre_m); });
  EXPECT_EQ(cells, run.box_cells_before);
}

double person_y_m = 0.0;  // a wall's shape is a plain function
bool in_person(const Vector3d& p) {
  return std::abs(p.y() - person_y_m) < 0.25 && p.z() < 0.7;
}
bool where_people_walk(const Vector3d& p) {
  return p.x() > 1.2 && p.x() < 2.0 && std::abs(p.y()) < 0.9 && std::abs(p.z()) < 0.6;  // well within the image
}

TEST(WearOfAMap, SomeoneWhoWalksByLeavesNoTrace) {
  Mapper mapper(preset(Preset::kBest), 1);
  std::size_t most = 0;
  const auto look = [&](int i, double at_y_m, bool with_person) {
    auto walls = floor_and_wall();
    if (with_person) walls.push_back({-Vector3d::UnitX(), 1.6, in_person});
    const Isometry3d T = testing::looking({-0.5, 0.0, 0.5}, {2.0, at_y_m, -0.1});
    DepthScan scan = testing::render(walls, T, static_cast<std::uint64_t>(i), 1.0, 160, 120);
    scan.utime = 1'000'000 + 66'667 * i;
    mapper.integrate(scan, T);
  };
  for (int i = 0; i < 60; ++i) {  // at 1 m/s, 15 scans a second
    person_y_m = -2.0 + i / 15.0;
    look(i, 0.0, true);
    most = std::max(most, dense_cells(mapper, where_people_walk));
  }
  ASSERT_GE(most, 100U);
  for (int i = 60; i < 105; ++i) look(i, 0.0, false);
  EXPECT_EQ(dense_cells(mapper, where_people_walk), 0U);
  // What the image's border cut off was not seen through: the sensor turns to it.
  for (int i = 105; i < 135; ++i) look(i, -1.2, false);
  for (int i = 135; i < 165; ++i) look(i, 1.2, false);
  EXPECT_EQ(mapper.snapshot()->planes().size(), 2U);
}

// What does not move must not wear.

using Place = std::tuple<int, int, int>;

/// Where the dense cells of a map are.
std::set<Place> places_of(Mapper& mapper) {
  std::set<Place> places;
  mapper.snapshot()->for_each_cell([&](const CellView& cell) {
    const Eigen::Array3i i = (cell.centre_m.array() / kCellM).floor().cast<int>();
    places.insert({i.x(), i.y(), i.z()});
  });
  return places;
}

/// Share of the cells of a map made without wear that are in the one with wear, too. Three looks are enough to go here.
template <class Pose>
double share_kept(const std::vector<testing::Wall>& walls, int scans, int width, Pose&& pose,
                  double pose_sigma_m = 0.0) {
  MapperConfig config = preset(Preset::kBest);
  config.wear.after_s = 0.3;
  Mapper wearing(config, 1);
  config.wear.enabled = false;
  Mapper lasting(config, 1);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Vector3d error_m = Vector3d::Zero();
  const double memory = std::exp(-0.1 / 2.0);  // the error wanders within two seconds
  for (int i = 0; i < scans; ++i) {
    const Isometry3d T = pose(i);
    DepthScan scan = testing::render(walls, T, static_cast<std::uint64_t>(i), 1.0, width, 3 * width / 4);
    scan.utime = 1'000'000 + 100'000 * i;
    const Vector3d kick(normal(random), normal(random), normal(random));
    error_m = memory * error_m + pose_sigma_m * std::sqrt(1.0 - memory * memory) * kick;
    Isometry3d told = T;
    told.translation() += error_m;
    wearing.integrate(scan, told);
    lasting.integrate(scan, told);
  }
  const std::set<Place> all = places_of(lasting);
  const std::set<Place> kept = places_of(wearing);
  EXPECT_GE(all.size(), 500U);
  const auto both = std::count_if(all.begin(), all.end(), [&](const Place& place) { return kept.contains(place); });
  return static_cast<double>(both) / static_cast<double>(all.size());
}

/// A room of 4 x 3 x 2.5 m, turned against the grid, with a table top and a pillar.
bool on_table(const Vector3d& p) {
  return p.x() > 0.8 && p.x() < 1.6 && std::abs(p.y()) < 0.5;
}
bool on_pillar(const Vector3d& p) {
  return std::abs(p.y() + 0.8) < 0.1;
}
std::vector<testing::Wall> furnished_room() {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.02, Vector3d(0.3, 0.2, 1.0).normalized()).toRotationMatrix();
  std::vector<testing::Wall> walls = {{R * Vector3d::UnitX(), 2.0},       {-R * Vector3d::UnitX(), 2.0},
                                      {R * Vector3d::UnitY(), 1.5},       {-R * Vector3d::UnitY(), 1.5},
                                      {R * Vector3d::UnitZ(), 1.2},       {-R * Vector3d::UnitZ(), 1.3},
                                      {Vector3d::UnitZ(), 0.4, on_table}, {-R * Vector3d::UnitX(), 1.3, on_pillar}};
  return walls;
}
Isometry3d turning_about(int i) {
  const double yaw = 0.09 * i;
  const Vector3d from(-0.6 + 0.3 * std::sin(0.05 * i), 0.05, 0.2 * std::sin(0.11 * i));
  return testing::looking(from, from + Vector3d(std::cos(yaw), std::sin(yaw), 0.5 * std::sin(0.23 * i)));
}

TEST(WearOfAMap, AWallDoesNotWearAtGrazingRays) {
  // Along a corridor of 1 m: to the left, right, above and below rays graze at 5 degrees and less.
  const std::vector<testing::Wall> corridor = {{Vector3d::UnitY(), 0.5},
                                               {-Vector3d::UnitY(), 0.5},
                                               {Vector3d::UnitZ(), 1.2},
                                               {-Vector3d::UnitZ(), 1.3},
                                               {-Vector3d::UnitX(), 7.0}};
  const auto walk = [](int i) {
    const Vector3d from(0.03 * i, 0.2 * std::sin(0.3 * i), 0.0);
    return testing::looking(from, from + Vector3d(1.0, 0.1 * std::sin(0.17 * i), -0.05));
  };
  EXPECT_GE(share_kept(corridor, 100, 160, walk), 0.99);
  EXPECT_GE(share_kept(corridor, 100, 160, walk, /*pose_sigma_m=*/0.005), 0.99);
}

TEST(WearOfAMap, ARoomInWhichNothingMovesKeepsItsCells) {
  EXPECT_GE(share_kept(furnished_room(), 100, 320, turning_about), 0.99);
}

TEST(WearOfAMap, NorDoPosesThatWanderWearIt) {
  EXPECT_GE(share_kept(furnished_room(), 100, 320, turning_about, /*pose_sigma_m=*/0.005), 0.99);
}

}  // namespace
}  // namespace planemap
