#include <gtest/gtest.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "export/cells_ply.hpp"
#include "export/colour.hpp"
#include "export/export_map_of_wire.hpp"
#include "export/exporter.hpp"
#include "export/floor_plan.hpp"
#include "export/formats.hpp"
#include "plane_table.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kCellM = 0.08;

/// A plane over a rectangle with sides a and b from a corner, its normal along a x b.
ExportPlane rectangle(PlaneId id, const Eigen::Vector3d& corner_m, const Eigen::Vector3d& a_m,
                      const Eigen::Vector3d& b_m, PlaneClass plane_class) {
  ExportPlane plane;
  plane.record.id = id;
  plane.record.centroid_m = corner_m + (a_m + b_m) / 2.0;
  plane.record.plane = Plane::through(plane.record.centroid_m, a_m.cross(b_m).normalized());
  plane.record.covariance = Eigen::Vector4d(1e-6, 1e-6, 1e-6, 4e-6).asDiagonal();
  plane.record.cell_count = 100;
  plane.record.point_count = 54321;
  plane.record.quality = 1.0 / 3.0;
  plane.record.first_seen_utime = 1'000'000;
  plane.record.last_seen_utime = 9'007'199'254'740'991;
  std::vector<Eigen::Vector3d> centres_m;
  for (double u = kCellM / 2; u < a_m.norm(); u += kCellM) {
    for (double v = kCellM / 2; v < b_m.norm(); v += kCellM) {
      centres_m.emplace_back(corner_m + u * a_m.normalized() + v * b_m.normalized());
    }
  }
  plane.outline = outline_of(plane.record.plane, plane.record.centroid_m, centres_m, kCellM);
  plane.plane_class = plane_class;
  return plane;
}

/// A room of 4 x 3 m turned by 0.3 rad, with a wall that has a door, a table and a ceiling; one cell has a plane and a
/// normal, one neither.
ExportMap room() {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d x = R.col(0);
  const Eigen::Vector3d y = R.col(1);
  const Eigen::Vector3d z = R.col(2);
  const Eigen::Vector3d corner_m(1.0, -2.0, 0.1);
  ExportMap map;
  map.frame = "house <1> & \"co\"";
  map.epoch = 9'007'199'254'740'991;
  map.revision = 17;
  map.gravity = -Eigen::Vector3d::UnitZ();
  map.planes.push_back(rectangle(1, corner_m, 4.0 * x, 3.0 * y, PlaneClass::kFloor));
  map.planes.push_back(rectangle(2, corner_m + 2.5 * z, 3.0 * y, 4.0 * x, PlaneClass::kCeiling));
  map.planes.push_back(rectangle(3, corner_m, 2.5 * z, 4.0 * x, PlaneClass::kWall));
  map.planes.push_back(rectangle(5, corner_m + x + y + 0.7 * z, 1.2 * x, 0.8 * y, PlaneClass::kTable));
  map.planes.back().coplanar = {2, 9};
  CellView cell{};
  cell.centre_m = {0.1, 1.0 / 3.0, -2.0};
  cell.sigma_m = {0.001, 0.002, 0.003};
  cell.normal = Eigen::Vector3d(0.6, 0.0, 0.8);
  cell.deviation_rad = 0.0174532925199432957;
  cell.count = 12;
  cell.plane_id = 5;
  map.cells.push_back(cell);
  cell.normal.reset();
  cell.plane_id = kNoPlane;
  map.cells.push_back(cell);
  return map;
}

std::string text_of(void (*write)(const ExportMap&, std::ostream&), const ExportMap& map) {
  std::ostringstream out;
  write(map, out);
  return out.str();
}

class ExportFolder : public testing::Test {
 protected:
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  TemporaryFolder folder_;
};

TEST(PlanesJson, HoldsEveryMemberAndTheSameDoubles) {
  const ExportMap map = room();
  const auto json = nlohmann::json::parse(text_of(write_planes_json, map));
  EXPECT_EQ(json.size(), 4u);
  EXPECT_EQ(json["frame"], map.frame);
  EXPECT_EQ(json["epoch"], map.epoch);
  EXPECT_EQ(json["revision"], 17);
  ASSERT_EQ(json["planes"].size(), 4u);
  const auto& plane = json["planes"][3];
  const PlaneRecord& record = map.planes[3].record;
  EXPECT_EQ(plane.size(), 14u);
  EXPECT_EQ(plane["id"], 5);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(plane["normal"][i].get<double>(), record.plane.normal()[i]);
  EXPECT_EQ(plane["d"].get<double>(), record.plane.d());
  ASSERT_EQ(plane["covariance"].size(), 16u);
  EXPECT_EQ(plane["covariance"][15].get<double>(), 4e-6);
  EXPECT_EQ(plane["covariance"][1].get<double>(), 0.0);
  EXPECT_EQ(plane["centroid"][1].get<double>(), record.centroid_m.y());
  EXPECT_EQ(plane["area"].get<double>(), map.planes[3].outline.area_m2);
  EXPECT_EQ(plane["cellCount"], 100);
  EXPECT_EQ(plane["pointCount"], 54321);
  EXPECT_EQ(plane["class"], "table");
  EXPECT_EQ(plane["quality"].get<double>(), 1.0 / 3.0);
  EXPECT_EQ(plane["firstSeenUtime"], 1'000'000);
  EXPECT_EQ(plane["lastSeenUtime"], 9'007'199'254'740'991);
  EXPECT_EQ(plane["coplanar"], (std::vector<int>{2, 9}));
  EXPECT_EQ(json["planes"][0]["coplanar"], nlohmann::json::array());
  ASSERT_EQ(plane["polygons"].size(), 1u);
  EXPECT_TRUE(plane["polygons"][0]["holes"].empty());
  ASSERT_GE(plane["polygons"][0]["outer"].size(), 4u);
  for (const auto& corner : plane["polygons"][0]["outer"]) {
    const Eigen::Vector3d corner_m(corner[0].get<double>(), corner[1].get<double>(), corner[2].get<double>());
    EXPECT_NEAR(record.plane.signed_distance_m(corner_m), 0.0, 1e-9);
  }
}

TEST(PlanesJson, AnEmptyMapIsValid) {
  const auto json = nlohmann::json::parse(text_of(write_planes_json, ExportMap{}));
  EXPECT_TRUE(json["planes"].empty());
}

TEST(CellsCsv, HasTheHeaderAndARowForEachCell) {
  std::istringstream lines(text_of(write_cells_csv, room()));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "x,y,z,plane_id,count,nx,ny,nz,normal_deviation_deg,sx,sy,sz");
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "0.1,0.3333333333333333,-2,5,12,0.6,0,0.8,1,0.001,0.002,0.003");
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "0.1,0.3333333333333333,-2,0,12,,,,,0.001,0.002,0.003");
  EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(ExportFolder, PclReadsThePlyBack) {
  const ExportMap map = room();
  const fs::path path = folder_ / "cells.ply";
  const auto written = export_to(map, path);
  ASSERT_TRUE(written) << written.error().message;
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud;
  ASSERT_EQ(pcl::io::loadPLYFile(path.string(), cloud), 0);
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_FLOAT_EQ(cloud[0].y, 1.0F / 3.0F);
  EXPECT_FLOAT_EQ(cloud[0].normal_x, 0.6F);
  EXPECT_FLOAT_EQ(cloud[1].normal_x, 0.0F);
  EXPECT_FALSE(cloud[0].r == cloud[0].g && cloud[0].g == cloud[0].b) << "a plane's colour is no grey";
  EXPECT_TRUE(cloud[1].r == cloud[1].g && cloud[1].g == cloud[1].b) << "without a plane: grey";
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(ExportFolder, EveryFormatWritesTheSameBytesTwice) {
  const ExportMap map = room();
  for (const char* extension : {".json", ".csv", ".ply", ".svg"}) {
    const auto bytes_of = [&](const std::string& name) {
      const fs::path path = folder_ / (name + extension);
      EXPECT_TRUE(export_to(map, path));
      std::ifstream file(path, std::ios::binary);
      return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    };
    const std::string first = bytes_of("first");
    EXPECT_FALSE(first.empty());
    EXPECT_EQ(first, bytes_of("second")) << extension;
  }
}

TEST_F(ExportFolder, AFailedExportLeavesTheOldFileAndNoRemains) {
  const fs::path path = folder_ / (std::string(250, 'a') + ".ply");  // a name with no room for what is written first
  std::ofstream(path) << "old";
  EXPECT_FALSE(export_to(room(), path));
  EXPECT_EQ(fs::file_size(path), 3u);
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(ExportFolder, AMapWithoutCellsIsWrittenInEveryFormat) {
  for (const char* name : {"empty.ply", "empty.csv", "empty.json", "empty.svg"}) {
    const auto written = export_to(ExportMap{}, folder_ / name);
    EXPECT_TRUE(written) << written.error().message;
  }
  pcl::PCLPointCloud2 cloud;  // as bytes: PCL's conversion to points takes the address of the first one
  EXPECT_EQ(pcl::io::loadPLYFile((folder_ / "empty.ply").string(), cloud), 0);
  EXPECT_EQ(cloud.width * cloud.height, 0u);
}

TEST_F(ExportFolder, UnusablePathsAreRefusedWithAReason) {
  const auto unknown = check_export_path(folder_ / "map.xyz");
  ASSERT_FALSE(unknown);
  for (const char* known : {".json", ".csv", ".ply", ".svg"}) {
    EXPECT_NE(unknown.error().message.find(known), std::string::npos) << unknown.error().message;
  }
  EXPECT_FALSE(check_export_path(folder_ / "missing" / "map.json"));
  EXPECT_FALSE(check_export_path(folder_ / "noextension"));
  EXPECT_TRUE(check_export_path(folder_ / "map.json"));
}

TEST(FloorPlan, WallsAreLinesAndLevelSurfacesAreasWithoutTheCeiling) {
  const FloorPlan plan = floor_plan_of(room());
  ASSERT_EQ(plan.areas.size(), 2u);
  EXPECT_EQ(plan.areas[0].id, 1u);
  EXPECT_TRUE(plan.areas[0].floor);
  EXPECT_EQ(plan.areas[1].id, 5u);
  EXPECT_FALSE(plan.areas[1].floor);
  ASSERT_EQ(plan.walls.size(), 1u);
  ASSERT_EQ(plan.walls[0].standing.size(), 1u);
  const PlanSegment& line = plan.walls[0].standing[0];
  EXPECT_NEAR((line.to - line.from).norm(), 4.0, kCellM);
  EXPECT_NEAR((line.to - line.from).normalized().cwiseAbs().maxCoeff(), 1.0, 1e-6) << "walls run along the page";
  EXPECT_NEAR(plan.walls[0].normal.dot(line.to - line.from), 0.0, 1e-9);
  EXPECT_NEAR((plan.max_m - plan.min_m).x(), 4.0, 2 * kCellM);
  EXPECT_NEAR((plan.max_m - plan.min_m).y(), 3.0, 2 * kCellM);
}

TEST(FloorPlan, ALintelIsExtentButNotStanding) {
  ExportMap map = room();
  const Eigen::Vector3d x = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d::UnitX();
  map.planes.push_back(
      rectangle(9, {1.0, 1.0, 2.1}, 0.4 * Eigen::Vector3d::UnitZ(), Eigen::Vector3d(1.5 * x), PlaneClass::kWall));
  const FloorPlan plan = floor_plan_of(map);
  ASSERT_EQ(plan.walls.size(), 2u);
  EXPECT_TRUE(plan.walls[1].standing.empty());
  EXPECT_EQ(plan.walls[1].extent.size(), 1u);
}

/// Calls a function for each element of an XML document.
void visit_elements(const boost::property_tree::ptree& tree,
                    const std::function<void(const std::string&, const boost::property_tree::ptree&)>& visit) {
  for (const auto& child : tree) {
    visit(child.first, child.second);
    visit_elements(child.second, visit);
  }
}

TEST(FloorPlanSvg, IsWellFormedAndNamesEveryPlane) {
  const ExportMap map = room();
  std::istringstream svg(text_of(write_floor_plan_svg, map));
  boost::property_tree::ptree tree;
  ASSERT_NO_THROW(boost::property_tree::read_xml(svg, tree));
  std::string texts;
  int paths = 0;
  visit_elements(tree, [&](const std::string& name, const boost::property_tree::ptree& element) {
    if (name == "text") texts += "[" + element.data() + "]";
    if (name == "path") ++paths;
  });
  EXPECT_GT(paths, 10);
  for (const ExportPlane& plane : map.planes) {
    EXPECT_NE(texts.find("[" + std::to_string(plane.record.id) + "]"), std::string::npos) << plane.record.id;
  }
  for (const char* word : {"floor", "ceiling", "wall", "table", "Floor plan", "house <1>", "1 m"}) {
    EXPECT_NE(texts.find(word), std::string::npos) << word;
  }
}

TEST(FloorPlanSvg, AnEmptyMapIsADrawingToo) {
  std::istringstream svg(text_of(write_floor_plan_svg, ExportMap{}));
  boost::property_tree::ptree tree;
  EXPECT_NO_THROW(boost::property_tree::read_xml(svg, tree));
  EXPECT_FALSE(std::regex_search(svg.str(), std::regex("[^a-z](nan|inf)[^a-z]")));
}

TEST(Colour, NeighbouringIdsDiffer) {
  for (PlaneId id = 1; id < 200; ++id) EXPECT_NE(colour_of(id).hex(), colour_of(id + 1).hex());
  EXPECT_EQ(colour_of(7).hex().size(), 7u);
}

TEST(PlaneTable, StandardErrorsComeFromTheCovariance) {
  PlaneRecord record;
  record.centroid_m = {0.0, 2.0, 0.0};
  record.covariance(1, 1) = 1e-6;  // 1 mrad about x: 2 mm at 2 m
  record.covariance(3, 3) = 2.25e-6;
  EXPECT_NEAR(offset_sigma_m(record), std::sqrt(4e-6 + 2.25e-6), 1e-12);
  EXPECT_NEAR(normal_sigma_rad(record), 1e-3, 1e-12);
}

TEST(ExportMapOfAnAnswer, TakesEverythingAndFindsDown) {
  client::Map wire;
  wire.frame = "world";
  wire.epoch = 3;
  wire.revision = 4;
  client::Plane plane;
  plane.id = 11;
  plane.normal = {0, 1, 0};
  plane.d = -2;
  plane.area_m2 = 1.5;
  plane.plane_class = "floor";
  plane.origin_m = {0, 2, 0};
  plane.axis_u = {0, 0, 1};
  plane.axis_v = {1, 0, 0};
  plane.polygons = {{{{0, 0}, {1, 0}, {1, 1}}, {}}};
  wire.planes = {plane};
  client::Cell cell;
  cell.plane_id = 11;
  wire.cells = {cell};
  const auto map = export_map_of(wire);
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_TRUE(map->gravity);
  EXPECT_EQ(*map->gravity, Eigen::Vector3d(0, -1, 0));
  ASSERT_EQ(map->planes.size(), 1u);
  EXPECT_EQ(map->planes[0].record.id, 11u);
  EXPECT_EQ(map->planes[0].plane_class, PlaneClass::kFloor);
  EXPECT_EQ(map->planes[0].outline.polygons[0].outer[2], Eigen::Vector2d(1, 1));
  ASSERT_EQ(map->cells.size(), 1u);
  EXPECT_FALSE(map->cells[0].normal);
}

TEST(ExportMapOfAnAnswer, CoplanarPlanesAreLinked) {
  client::Map wire;
  const auto add = [&](std::int64_t id, double x_m, double height_m, double area_m2) {
    client::Plane plane;
    plane.id = id;
    plane.normal = {0, 0, 1};
    plane.d = -height_m;
    plane.centroid_m = {x_m, 0, height_m};
    plane.area_m2 = area_m2;
    wire.planes.push_back(plane);
  };
  add(2, 0.0, 0.7, 1.0);
  add(3, 0.0, 0.0, 9.0);
  add(5, 4.0, 0.705, 1.0);
  add(8, 5.0, 0.702, 0.1);
  const auto map = export_map_of(wire);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->planes[0].coplanar, std::vector<PlaneId>{5});
  EXPECT_TRUE(map->planes[1].coplanar.empty());
  EXPECT_EQ(map->planes[2].coplanar, std::vector<PlaneId>{2});
  EXPECT_TRUE(map->planes[3].coplanar.empty()) << "too small";
  const std::string table = plane_table(*map);
  EXPECT_TRUE(std::regex_search(table, std::regex("\n +2  [^\n]* 5\n"))) << table;
  EXPECT_TRUE(std::regex_search(table, std::regex("\n +3  [^\n]* -\n"))) << table;
}

TEST(ExportMapOfAnAnswer, APlaneWithoutDirectionFails) {
  client::Map wire;
  wire.planes.resize(1);
  EXPECT_FALSE(export_map_of(wire));
}

}  // namespace
}  // namespace planemap::cli
