// Floor plans of random flats beside a slow twin: whether a place is wall, floor or free, asked of each thing alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <planemap/block.hpp>
#include <planemap/query/snapshot_queries.hpp>
#include <set>
#include <utility>
#include <vector>

#include "query/random_map.hpp"

namespace planemap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCellM = 0.1;

struct Rectangle {
  Vector2d low_m;
  Vector2d high_m;

  bool holds(const Vector2d& p_m) const {
    return (p_m.array() >= low_m.array()).all() && (p_m.array() <= high_m.array()).all();
  }
  bool touches(const Rectangle& other, double margin_m) const {
    return (low_m.array() <= other.high_m.array() + margin_m).all() &&
           (other.low_m.array() <= high_m.array() + margin_m).all();
  }
  Ring ring() const { return {low_m, {high_m.x(), low_m.y()}, high_m, {low_m.x(), high_m.y()}}; }
};

/// A surface of a flat: a rectangle less openings, in axes of its own.
struct Piece {
  Vector3d origin_m;
  Vector3d axis_x;  ///< of walls: level
  Vector3d axis_y;  ///< of walls: up
  Vector3d normal;  ///< axis_x x axis_y
  Rectangle surface;
  std::vector<Rectangle> openings;  ///< that touch neither each other nor the border, but for doors: the lower one
};

struct Flat {
  Vector3d up;
  std::vector<Piece> floors;
  std::vector<Piece> walls;
  std::vector<Vector3d> cells_m;  ///< centres
};

/// The corners of a wall with doors, which are cut out of its lower border, and windows.
DescribedPlane described_piece(const Piece& piece, PlaneId id, PlaneClass plane_class) {
  const Vector2d middle = 0.5 * (piece.surface.low_m + piece.surface.high_m);
  const auto world = [&](const Vector2d& p) { return piece.origin_m + p.x() * piece.axis_x + p.y() * piece.axis_y; };
  const PlaneRecord record = testing::record_of(id, world(middle), piece.normal, 0.001, 0.001);
  Outline outline;
  outline.basis = basis_of(record.plane, record.centroid_m);
  const auto to_basis = [&](const Ring& ring) {
    Ring turned;
    for (const Vector2d& p : ring) turned.push_back(outline.basis.to_plane(world(p)));
    return turned;
  };
  Ring outer = {piece.surface.low_m};
  std::vector<Rectangle> openings = piece.openings;
  std::sort(openings.begin(), openings.end(),
            [](const Rectangle& a, const Rectangle& b) { return a.low_m.x() < b.low_m.x(); });
  Polygon polygon;
  for (const Rectangle& opening : openings) {
    if (opening.low_m.y() > piece.surface.low_m.y()) {
      Ring hole = to_basis(opening.ring());
      std::reverse(hole.begin(), hole.end());
      polygon.holes.push_back(std::move(hole));
      continue;
    }
    for (const Vector2d& p : {opening.low_m, Vector2d(opening.low_m.x(), opening.high_m.y()), opening.high_m,
                              Vector2d(opening.high_m.x(), opening.low_m.y())}) {
      outer.push_back(p);
    }
  }
  outer.emplace_back(piece.surface.high_m.x(), piece.surface.low_m.y());
  outer.push_back(piece.surface.high_m);
  outer.emplace_back(piece.surface.low_m.x(), piece.surface.high_m.y());
  polygon.outer = to_basis(outer);
  outline.polygons.push_back(std::move(polygon));
  outline.area_m2 = area_m2(outline.polygons);
  return testing::described(record, outline, plane_class);
}

void add_openings(testing::Random& random, Piece& piece, int count, bool with_doors) {
  const Vector2d size_m = piece.surface.high_m - piece.surface.low_m;
  for (int i = 0; i < count; ++i) {
    Rectangle opening;
    opening.low_m =
        piece.surface.low_m + Vector2d(random.uniform(0.1, 0.7) * size_m.x(), random.uniform(0.1, 0.7) * size_m.y());
    opening.high_m = opening.low_m + Vector2d(random.uniform(0.2, 0.9), random.uniform(0.2, 1.2));
    if (with_doors && random.one_in(2)) opening.low_m.y() = piece.surface.low_m.y();
    const bool fits = (opening.high_m.array() < piece.surface.high_m.array() - 0.05).all();
    const bool is_apart = std::none_of(piece.openings.begin(), piece.openings.end(),
                                       [&](const Rectangle& other) { return opening.touches(other, 0.3); });
    if (fits && is_apart) piece.openings.push_back(opening);
  }
}

/// Floors at up to three heights, some upon each other, walls along them and across, and things that stand about.
/// Turned in any way, or not at all.
Flat random_flat(testing::Random& random) {
  const Eigen::Matrix3d R = random.one_in(3) ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : random.pose(0.0).linear();
  const Vector3d x = R.col(0);
  const Vector3d y = R.col(1);
  const Vector3d up = R.col(2);
  Flat flat;
  flat.up = up;
  const Vector3d middle_m = random.in_cube(3.0);
  const int floors = 1 + random.below(4);
  for (int i = 0; i < floors; ++i) {
    const Vector2d low_m(random.uniform(-4.0, 1.0), random.uniform(-4.0, 1.0));
    Piece floor{middle_m + random.below(3) * 0.4 * up,
                x,
                y,
                up,
                {low_m, low_m + Vector2d(random.uniform(1.0, 4.0), random.uniform(1.0, 4.0))},
                {}};
    add_openings(random, floor, random.below(3), false);
    flat.floors.push_back(std::move(floor));
  }
  const int walls = random.below(8);
  for (int i = 0; i < walls; ++i) {
    const std::array<Vector3d, 4> directions = {x, y, -x, -y};
    const Vector3d along = random.one_in(5) ? (x + random.uniform(-1.0, 1.0) * y).normalized()
                                            : directions[static_cast<std::size_t>(random.below(4))];
    const Vector3d foot_m = middle_m + random.uniform(-4.0, 4.0) * x + random.uniform(-4.0, 4.0) * y;
    const double length_m = random.uniform(0.8, 6.0);
    const double foot_height_m = random.uniform(-0.2, 1.0);
    Piece wall{foot_m,
               along,
               up,
               along.cross(up),
               {{-0.5 * length_m, foot_height_m}, {0.5 * length_m, foot_height_m + random.uniform(0.3, 2.5)}},
               {}};
    add_openings(random, wall, random.below(5), true);
    flat.walls.push_back(std::move(wall));
  }
  const int cells = random.below(200);
  for (int i = 0; i < cells; ++i) {
    const Vector3d p_m =
        middle_m + random.uniform(-4.0, 4.5) * x + random.uniform(-4.0, 4.5) * y + random.uniform(-0.3, 3.0) * up;
    flat.cells_m.push_back(kCellM * ((p_m / kCellM).array().floor() + 0.5).matrix());
  }
  return flat;
}

testing::RandomMap map_of(const Flat& flat) {
  std::vector<DescribedPlane> planes;
  PlaneId id = 0;
  for (const Piece& floor : flat.floors) planes.push_back(described_piece(floor, ++id, PlaneClass::kFloor));
  for (const Piece& wall : flat.walls) planes.push_back(described_piece(wall, ++id, PlaneClass::kWall));
  MapSnapshot::Parts parts;
  parts.cell_size_m = kCellM;
  parts.density_threshold = 10;
  std::map<std::array<int, 3>, std::shared_ptr<Block>> blocks;
  for (const Vector3d& centre_m : flat.cells_m) {
    const CellIndex index = (centre_m / kCellM).array().floor().matrix().cast<int>();
    const BlockIndex b = block_of(index);
    auto& block = blocks.try_emplace({b.x(), b.y(), b.z()}, nullptr).first->second;
    if (!block) block = std::make_shared<Block>(b);
    block->cell(static_cast<std::size_t>(block->find_or_add(place_of(index)))).sums.count = 20.0;
  }
  for (auto& entry : blocks) parts.blocks.push_back(std::move(entry.second));
  return testing::map_of(std::move(planes), std::move(parts));
}

/// What the plan must show at a place.
struct Twin {
  const Flat& flat;
  const PlanAxes& axes;
  const FloorplanQuery& query;
  double floor_height_m = 0.0;  ///< along up

  /// What of a wall stands between the heights, along it; openings that are shorter than the query's heights are
  /// bridged.
  std::vector<std::pair<double, double>> standing(const Piece& wall) const {
    const double base_m = axes.up.dot(wall.origin_m) - floor_height_m;
    const double low_m = std::max(wall.surface.low_m.y(), query.cut_low_m - base_m);
    const double high_m = std::min(wall.surface.high_m.y(), query.cut_high_m - base_m);
    if (low_m >= high_m) return {};
    std::vector<std::pair<double, double>> gaps;
    for (const Rectangle& opening : wall.openings) {
      const bool is_through = opening.low_m.y() <= low_m && opening.high_m.y() >= high_m;
      if (is_through) gaps.emplace_back(opening.low_m.x(), opening.high_m.x());
    }
    std::sort(gaps.begin(), gaps.end());
    std::vector<std::pair<double, double>> found;
    double from_m = wall.surface.low_m.x();
    for (const auto& [begin_m, end_m] : gaps) {
      found.emplace_back(from_m, begin_m);
      from_m = end_m;
    }
    found.emplace_back(from_m, wall.surface.high_m.x());
    return found;
  }
  bool is_wall(const Vector2d& p) const {
    return std::any_of(flat.walls.begin(), flat.walls.end(), [&](const Piece& wall) {
      const Vector2d from_foot = p - axes.to_plan(wall.origin_m);
      const double along_m = from_foot.dot(axes.to_plan(wall.axis_x));
      const double behind_m = -from_foot.dot(axes.to_plan(wall.normal));
      if (behind_m < 0.0 || behind_m > query.wall_thickness_m) return false;
      const auto pieces = standing(wall);
      return std::any_of(pieces.begin(), pieces.end(),
                         [&](const auto& piece) { return along_m >= piece.first && along_m <= piece.second; });
    });
  }
  bool is_on(const Piece& floor, const Vector2d& p) const {
    const Vector2d from_origin = p - axes.to_plan(floor.origin_m);
    const Vector2d own(from_origin.dot(axes.to_plan(floor.axis_x)), from_origin.dot(axes.to_plan(floor.axis_y)));
    return floor.surface.holds(own) && std::none_of(floor.openings.begin(), floor.openings.end(),
                                                    [&](const Rectangle& opening) { return opening.holds(own); });
  }
  /// Cells stand for squares of their size, about their centres to half a cell.
  bool is_taken(const Piece& floor, const Vector2d& p) const {
    return std::any_of(flat.cells_m.begin(), flat.cells_m.end(), [&](const Vector3d& cell_m) {
      const double height_m = axes.up.dot(cell_m - floor.origin_m);
      if (height_m < query.clear_low_m || height_m > query.clear_high_m) return false;
      const double step_m = 0.5 * kCellM;
      const Vector2d centre = step_m * (axes.to_plan(cell_m) / step_m).array().round().matrix();
      return (p - centre).cwiseAbs().maxCoeff() <= step_m;
    });
  }
  bool is_floor(const Vector2d& p) const {
    return std::any_of(flat.floors.begin(), flat.floors.end(), [&](const Piece& floor) { return is_on(floor, p); });
  }
  bool is_free(const Vector2d& p) const {
    return !is_wall(p) && std::any_of(flat.floors.begin(), flat.floors.end(),
                                      [&](const Piece& floor) { return is_on(floor, p) && !is_taken(floor, p); });
  }
};

bool is_in(const Ring& ring, const Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Vector2d& a = ring[i];
    const Vector2d& b = ring[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

bool is_in(const std::vector<Polygon>& polygons, const Vector2d& p) {
  return std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) {
    return is_in(polygon.outer, p) &&
           std::none_of(polygon.holes.begin(), polygon.holes.end(), [&](const Ring& hole) { return is_in(hole, p); });
  });
}

/// Whether the patch around a place is smaller than a cell, or nearly: such ones are left out of plans.
template <class Holds>
bool is_crumb(const Vector2d& p, const Holds& holds) {
  constexpr double kStepM = 0.005;
  const std::size_t most = static_cast<std::size_t>(1.3 * kCellM * kCellM / (kStepM * kStepM));
  std::set<std::pair<int, int>> seen = {{0, 0}};
  std::deque<std::pair<int, int>> open = {{0, 0}};
  while (!open.empty() && seen.size() < most) {
    const auto [x, y] = open.front();
    open.pop_front();
    for (const auto& next : {std::pair(x + 1, y), std::pair(x - 1, y), std::pair(x, y + 1), std::pair(x, y - 1)}) {
      if (seen.count(next) == 0 && holds(Vector2d(p + kStepM * Vector2d(next.first, next.second)))) {
        seen.insert(next);
        open.push_back(next);
      }
    }
  }
  return seen.size() < most;
}

/// What the twin says where it is sure of it: plans are drawn to a millimetre.
template <class Holds>
std::optional<bool> sure(const Vector2d& p, const Holds& holds) {
  constexpr double kBlurM = 0.003;
  const bool here = holds(p);
  for (int i = 0; i < 8; ++i) {
    const double angle_rad = i * M_PI / 4.0;
    if (holds(Vector2d(p + kBlurM * Vector2d(std::cos(angle_rad), std::sin(angle_rad)))) != here) return std::nullopt;
  }
  return here;
}

/// Places at which the plan was compared.
struct Compared {
  int sure = 0;
  int walls = 0;
  int free = 0;
  int taken = 0;  ///< floor that is not free
};

void compare(testing::Random& random, const Flat& flat, const FloorplanQuery& query, Compared& compared) {
  const auto map = map_of(flat);
  const SnapshotQueries queries(map.snapshot, map.planes, -1.5 * flat.up);
  const auto plan = queries.floorplan(query);
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  ASSERT_TRUE(plan->axes.up.isApprox(flat.up, 1e-9));
  Twin twin{flat, plan->axes, query};
  twin.floor_height_m = std::numeric_limits<double>::infinity();
  for (const Piece& floor : flat.floors) {
    twin.floor_height_m = std::min(twin.floor_height_m, flat.up.dot(floor.origin_m));
  }
  EXPECT_NEAR(plan->floor_height_m, twin.floor_height_m, 1e-9);
  const Vector2d middle = plan->axes.to_plan(flat.floors[0].origin_m);
  for (int i = 0; i < 1000; ++i) {
    const Vector2d p = middle + Vector2d(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    const auto is_wall = [&](const Vector2d& q) { return twin.is_wall(q); };
    const auto is_floor = [&](const Vector2d& q) { return twin.is_floor(q); };
    const auto is_free = [&](const Vector2d& q) { return twin.is_free(q); };
    const auto wall = sure(p, is_wall);
    const auto floor = sure(p, is_floor);
    const auto free = sure(p, is_free);
    ASSERT_TRUE(!wall || is_in(plan->walls, p) == *wall) << p.transpose();
    ASSERT_TRUE(!floor || is_in(plan->floor, p) == *floor || (*floor && is_crumb(p, is_floor))) << p.transpose();
    ASSERT_TRUE(!free || is_in(plan->free_floor, p) == *free || (*free && is_crumb(p, is_free))) << p.transpose();
    compared.sure += wall && floor && free ? 1 : 0;
    compared.walls += wall.value_or(false) ? 1 : 0;
    compared.free += free.value_or(false) ? 1 : 0;
    compared.taken += floor.value_or(false) && !free.value_or(true) ? 1 : 0;
  }
}

TEST(FloorplanTwin, AgreesOnRandomFlats) {
  testing::Random random(71);
  Compared compared;
  for (int round = 0; round < 500; ++round) {
    const Flat flat = random_flat(random);
    FloorplanQuery query;
    if (round % 3 == 1) {
      query.cut_low_m = random.uniform(0.0, 1.5);
      query.cut_high_m = query.cut_low_m + random.uniform(0.05, 1.0);
      query.wall_thickness_m = random.uniform(0.02, 0.4);
      query.clear_low_m = random.uniform(0.0, 0.5);
      query.clear_high_m = query.clear_low_m + random.uniform(0.1, 2.0);
    }
    ASSERT_NO_FATAL_FAILURE(compare(random, flat, query, compared)) << "flat " << round;
  }
  EXPECT_GT(compared.sure, 400'000);
  EXPECT_GT(compared.walls, 2'000);
  EXPECT_GT(compared.free, 30'000);
  EXPECT_GT(compared.taken, 1'000);
}

}  // namespace
}  // namespace planemap
