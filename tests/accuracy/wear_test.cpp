// Wear in rendered apartments: what stands still stays, what was carried away goes.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <planemap/mapper.hpp>
#include <planemap/simulation/kinect_sensor.hpp>
#include <planemap/simulation/renderer.hpp>
#include <planemap/simulation/simulated_source.hpp>
#include <set>
#include <vector>

#include "scoring.hpp"
#include "seen_surfaces.hpp"

namespace planemap::accuracy {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Place = std::array<int, 3>;

/// Where the dense cells of a map are that lie in a box; all of them without one.
std::set<Place> places_of(const MapSnapshot& map, const std::optional<Eigen::AlignedBox3d>& box_m = std::nullopt,
                          const Isometry3d& T_box_world = Isometry3d::Identity()) {
  std::set<Place> places;
  map.for_each_cell([&](const CellView& cell) {
    if (box_m && !box_m->contains(T_box_world * cell.centre_m)) return;
    const Eigen::Array3i i = (cell.centre_m.array() / map.cell_size_m()).floor().cast<int>();
    places.insert({i.x(), i.y(), i.z()});
  });
  return places;
}

/// Share of the places in `all` that are in `kept`, too.
double share_kept(const std::set<Place>& all, const std::set<Place>& kept) {
  const auto both = std::count_if(all.begin(), all.end(), [&](const Place& place) { return kept.contains(place); });
  return static_cast<double>(both) / static_cast<double>(all.size());
}

MapperConfig without_wear() {
  MapperConfig config = preset(Preset::kBest);
  config.wear.enabled = false;
  return config;
}

/// A tour in 150 frames shows each place for half a second or so: here a tenth of a second is enough to go.
TEST(Wear, AnApartmentInWhichNothingMovesKeepsItsCells) {
  simulation::SimulationConfig scene;
  scene.seed = 1001;
  scene.frames = 150;
  simulation::SimulatedSource source(scene);
  MapperConfig config = preset(Preset::kBest);
  config.wear.after_s = 0.1;
  SeenSurfaces seen(source.truth(), config.sensor.max_range_m);
  Mapper wearing(config, 1);
  Mapper lasting(without_wear(), 1);
  while (auto frame = source.next()) {
    seen.add(source, frame->scan);
    const Scan scan = std::move(frame->scan);
    wearing.integrate(scan, frame->T_world_sensor);
    lasting.integrate(scan, frame->T_world_sensor);
  }
  const auto worn = wearing.snapshot();
  const auto whole = lasting.snapshot();
  const std::set<Place> all = places_of(*whole);
  ASSERT_GE(all.size(), 5000U);
  EXPECT_GE(share_kept(all, places_of(*worn)), 0.99);
  EXPECT_EQ(score(*worn, seen).count(Verdict::kCorrect), score(*whole, seen).count(Verdict::kCorrect));
}

/// A box of 50 x 50 x 80 cm that stands on the floor before the sensor, looking at it.
class CarriedBox {
 public:
  static constexpr double kHalfWidth_m = 0.25;
  static constexpr double kHeight_m = 0.8;
  static constexpr double kDistance_m = 2.4;  ///< of its front from the sensor

  CarriedBox(const Isometry3d& T_world_sensor, const Plane& floor) {
    const Vector3d up = floor.normal();
    const Vector3d ahead = (T_world_sensor.linear().col(2) - up * up.dot(T_world_sensor.linear().col(2))).normalized();
    const Vector3d eye = T_world_sensor.translation();
    T_world_box.linear() << ahead, up.cross(ahead), up;
    T_world_box.translation() = eye - floor.signed_distance_m(eye) * up + kDistance_m * ahead;
  }
  /// x from the front, y from the middle, z from the floor.
  Vector3d corner(double x, double y, double z) const { return T_world_box * Vector3d(x, y, z); }
  void add_to(std::vector<simulation::Surface>& surfaces) const {
    constexpr double w = kHalfWidth_m;
    constexpr double h = kHeight_m;
    const auto add = [&](const Vector3d& normal, const std::array<Vector3d, 4>& corners) {
      simulation::Surface surface;
      surface.id = static_cast<simulation::SurfaceId>(surfaces.size() + 1);
      surface.plane = Plane::through(corners[0], T_world_box.linear() * normal);
      surface.pieces_m = {{corners.begin(), corners.end()}};
      surfaces.push_back(surface);
    };
    add(-Vector3d::UnitX(), {corner(0, w, 0), corner(0, -w, 0), corner(0, -w, h), corner(0, w, h)});
    add(Vector3d::UnitZ(), {corner(0, -w, h), corner(2 * w, -w, h), corner(2 * w, w, h), corner(0, w, h)});
  }
  /// Whether the sensor sees all of where the box is to stand, and through it as far as half a metre behind.
  bool has_room(const simulation::RenderedImage& image, const PinholeIntrinsics& k,
                const Isometry3d& T_world_sensor) const {
    const Isometry3d T_sensor_world = T_world_sensor.inverse();
    for (double y = -0.4; y <= 0.4; y += 0.02) {
      for (double z = -0.1; z <= 1.0; z += 0.02) {
        const Vector3d p = T_sensor_world * corner(0.0, y, z);
        const auto u = static_cast<int>(std::lround(k.fx * p.x() / p.z() + k.cx));
        const auto v = static_cast<int>(std::lround(k.fy * p.y() / p.z() + k.cy));
        if (u < 0 || v < 0 || u >= k.width || v >= k.height) return false;
        const auto pixel = static_cast<std::size_t>(v * k.width + u);
        const auto depth_m = static_cast<double>(image.depth_m[pixel]);
        const double behind_m = (T_sensor_world * corner(1.0, y, z)).z();
        // Something must be seen behind it, too: where nothing comes back from, a cell is not seen through.
        if (depth_m > 5.0 || image.cos_incidence[pixel] < 0.3F) return false;
        if (z > 0.4 ? depth_m < behind_m : z > 0.05 && depth_m < p.z()) return false;
      }
    }
    return true;
  }

  Isometry3d T_world_box = Isometry3d::Identity();
};

const simulation::Surface& floor_of(const std::vector<simulation::Surface>& surfaces) {
  return *std::find_if(surfaces.begin(), surfaces.end(),
                       [](const auto& surface) { return surface.plane_class == PlaneClass::kFloor; });
}

/// The robot stops, someone puts a box before it for a second and carries it away: three seconds later the map is as
/// if there had been none.
TEST(Wear, ABoxThatStoodInAnApartmentLeavesTheMap) {
  simulation::SimulationConfig scene;
  scene.seed = 1002;
  scene.frames = 300;
  simulation::SimulatedSource source(scene);
  const simulation::KinectSensor sensor(scene.depth_noise, scene.intrinsics);
  simulation::Renderer empty(source.truth(), scene.intrinsics);
  Mapper with_box(preset(Preset::kBest), 1);
  Mapper without_box(preset(Preset::kBest), 1);

  std::optional<CarriedBox> box;
  Isometry3d T_world_sensor = Isometry3d::Identity();
  std::int64_t utime = 0;
  while (auto frame = source.next()) {
    const Scan scan = std::move(frame->scan);
    utime = utime_of(scan);
    T_world_sensor = frame->T_world_sensor;
    with_box.integrate(scan, T_world_sensor);
    without_box.integrate(scan, T_world_sensor);
    const CarriedBox here(T_world_sensor, floor_of(source.truth()).plane);
    if (!here.has_room(empty.render(T_world_sensor), scene.intrinsics, T_world_sensor)) continue;
    box = here;
    break;
  }
  ASSERT_TRUE(box.has_value()) << "no room for a box anywhere";

  std::vector<simulation::Surface> surfaces = source.truth();
  box->add_to(surfaces);
  simulation::Renderer furnished(surfaces, scene.intrinsics);
  const auto look = [&](Mapper& mapper, simulation::Renderer& room, int i) {
    const Isometry3d T = T_world_sensor * Eigen::AngleAxisd(0.05 * std::sin(0.2 * i), Vector3d::UnitY());
    DepthScan scan;
    scan.utime = utime + 33'333 * (i + 1);
    scan.intrinsics = scene.intrinsics;
    scan.depth = sensor.measure(room.render(T), static_cast<std::uint64_t>(i));
    mapper.integrate(scan, T);
  };
  for (int i = 0; i < 30; ++i) {
    look(with_box, furnished, i);
    look(without_box, empty, i);
  }
  const Isometry3d T_box_world = box->T_world_box.inverse();
  // The cells at the floor hold some of it, or are too near to be told from it.
  const Eigen::AlignedBox3d about(Vector3d(-0.1, -0.35, 0.2), Vector3d(0.6, 0.35, 0.9));
  const std::size_t cells_of_box = places_of(*with_box.snapshot(), about, T_box_world).size();
  ASSERT_GE(cells_of_box, 60U);
  for (int i = 30; i < 120; ++i) {
    look(with_box, empty, i);
    look(without_box, empty, i);
  }
  const auto after = with_box.snapshot();
  const auto twin = without_box.snapshot();
  EXPECT_EQ(places_of(*after, about, T_box_world), places_of(*twin, about, T_box_world));
  for (const auto& record : after->planes()) {
    EXPECT_FALSE(about.contains(T_box_world * record->centroid_m)) << "plane " << record->id;
  }
  EXPECT_GE(share_kept(places_of(*twin), places_of(*after)), 0.99);
  EXPECT_GE(share_kept(places_of(*after), places_of(*twin)), 0.99);
}

}  // namespace
}  // namespace planemap::accuracy
