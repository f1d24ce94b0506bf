// The red kitchen of 7-Scenes: what a person sees there must be planes, and stand as a kitchen stands.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <planemap/mapper.hpp>
#include <planemap/sources/open_folder.hpp>

namespace planemap {
namespace {

using Record = std::shared_ptr<const PlaneRecord>;

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

class RedKitchen : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const char* data = std::getenv("PLANEMAP_TEST_DATA");
    if (data == nullptr) return;
    auto source = sources::open_folder(std::string(data) + "/redkitchen");
    ASSERT_TRUE(source.has_value()) << source.error().message;
    up_ = -(*source)->gravity_direction().value();
    Mapper mapper(preset(Preset::kBest), 1);
    while (auto frame = (*source)->next()) {
      const Scan scan = std::move(frame->scan);
      mapper.integrate(scan, frame->T_world_sensor);
      ++scans_;
    }
    map_ = mapper.snapshot();
  }
  void SetUp() override {
    if (map_ == nullptr) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set: no red kitchen";
  }

  static double height_m(const PlaneRecord& plane) { return up_.dot(plane.centroid_m); }

  /// Planes of at least so many cells whose normal is so far from up, largest first.
  static std::vector<Record> planes(std::uint32_t cells, double from_deg, double to_deg) {
    std::vector<Record> found;
    for (const Record& record : map_->planes()) {
      const double tilt_deg = degrees_between(record->plane.normal(), up_);
      if (record->cell_count >= cells && tilt_deg >= from_deg && tilt_deg <= to_deg) found.push_back(record);
    }
    std::sort(found.begin(), found.end(),
              [](const Record& a, const Record& b) { return a->cell_count > b->cell_count; });
    return found;
  }
  /// The lowest large plane that faces up.
  static Record floor() {
    const std::vector<Record> level = planes(200, 0.0, 10.0);
    return level.empty() ? nullptr
                         : *std::min_element(level.begin(), level.end(), [](const Record& a, const Record& b) {
                             return height_m(*a) < height_m(*b);
                           });
  }
  /// The largest level plane at a table's height.
  static Record table_top() {
    for (const Record& record : planes(200, 0.0, 10.0)) {
      const double above_m = height_m(*record) - height_m(*floor());
      if (above_m > 0.55 && above_m < 0.95) return record;
    }
    return nullptr;
  }

  static inline std::shared_ptr<const MapSnapshot> map_;
  static inline Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
  static inline std::size_t scans_ = 0;
};

TEST_F(RedKitchen, EveryFrameIsMapped) {
  EXPECT_EQ(scans_, 300U);
}

TEST_F(RedKitchen, HasAtLeastTwentyPlanesOfFortyCells) {
  EXPECT_GE(planes(40, 0.0, 180.0).size(), 20U);
}

TEST_F(RedKitchen, FloorAndTableTopAreParallelAndLevel) {
  ASSERT_NE(floor(), nullptr);
  ASSERT_NE(table_top(), nullptr);
  EXPECT_LE(degrees_between(floor()->plane.normal(), table_top()->plane.normal()), 1.5);
  EXPECT_LE(degrees_between(floor()->plane.normal(), up_), 3.0);
  EXPECT_LE(degrees_between(table_top()->plane.normal(), up_), 3.0);
}

TEST_F(RedKitchen, WallAndCabinetFrontsStandUprightOnFloorAndTable) {
  ASSERT_NE(floor(), nullptr);
  ASSERT_NE(table_top(), nullptr);
  // 1.6 m2 and more. A cabinet's side of 640 cells leans by 2.5 degrees.
  const std::vector<Record> upright = planes(650, 80.0, 100.0);
  ASSERT_GE(upright.size(), 2U);
  for (const Record& wall : upright) {
    EXPECT_NEAR(degrees_between(wall->plane.normal(), floor()->plane.normal()), 90.0, 2.0) << "plane " << wall->id;
    EXPECT_NEAR(degrees_between(wall->plane.normal(), table_top()->plane.normal()), 90.0, 2.0) << "plane " << wall->id;
  }
}

}  // namespace
}  // namespace planemap
