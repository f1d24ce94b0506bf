// What can be asked over HTTP, against the same asked of the service itself.

#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <planemap/block.hpp>
#include <planemap/query/plane_filter.hpp>
#include <set>

#include "serve/http/live_view.hpp"
#include "test_site.hpp"

namespace planemap::service {
namespace {

using Json = nlohmann::json;

/// Numbers of a body, one after the other.
class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}
  template <class T>
  T take() {
    T value{};
    if (at_ + sizeof value > bytes_.size()) throw std::runtime_error("the body ends too soon");
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

struct WireCell {
  float x, y, z, nx, ny, nz, deviation_rad;
  std::uint32_t plane_id;
};

struct WireCells {
  std::uint64_t epoch = 0;
  std::uint64_t revision = 0;
  bool is_full = false;
  std::map<std::array<int, 3>, std::vector<WireCell>> blocks;
};

WireCells cells_of(const std::string& body) {
  Reader in(body);
  WireCells cells;
  EXPECT_EQ(in.take<std::uint32_t>(), 0x434D4C50u);
  EXPECT_EQ(body.substr(0, 4), "PLMC");
  EXPECT_EQ(in.take<std::uint32_t>(), 1u);
  cells.epoch = in.take<std::uint64_t>();
  cells.revision = in.take<std::uint64_t>();
  cells.is_full = in.take<std::uint32_t>() == 1;
  for (auto blocks = in.take<std::uint32_t>(); blocks > 0; --blocks) {
    const auto x = in.take<std::int32_t>();
    const auto y = in.take<std::int32_t>();
    const auto z = in.take<std::int32_t>();
    auto& block = cells.blocks[{x, y, z}];
    for (auto count = in.take<std::uint32_t>(); count > 0; --count) block.push_back(in.take<WireCell>());
  }
  EXPECT_TRUE(in.at_end());
  return cells;
}

/// The slow, obvious twin: all dense cells of a snapshot by block.
void expect_cells_of(const MapSnapshot& snapshot, const std::map<std::array<int, 3>, std::vector<WireCell>>& blocks) {
  std::map<std::array<int, 3>, std::vector<CellView>> expected;
  snapshot.for_each_cell([&](const CellView& cell) {
    const BlockIndex b = block_of(cell.index);
    expected[{b.x(), b.y(), b.z()}].push_back(cell);
  });
  ASSERT_EQ(blocks.size(), expected.size());
  for (const auto& [index, cells] : expected) {
    const auto found = blocks.find(index);
    ASSERT_NE(found, blocks.end());
    ASSERT_EQ(found->second.size(), cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const WireCell& wire = found->second[i];
      EXPECT_EQ(wire.x, static_cast<float>(cells[i].centre_m.x()));
      EXPECT_EQ(wire.z, static_cast<float>(cells[i].centre_m.z()));
      EXPECT_EQ(wire.plane_id, cells[i].plane_id);
      EXPECT_EQ(std::isnan(wire.deviation_rad), !cells[i].normal);
      const double nz = cells[i].normal ? cells[i].normal->z() : 0.0;
      EXPECT_EQ(wire.nz, static_cast<float>(nz));
    }
  }
}

TEST(HttpApi, TellsThePlanesWithTheirDeviations) {
  TestSite site;
  site.room().look_around();
  const HttpReply reply = site.get("/api/v1/planes");
  ASSERT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("content-type"), "application/json");
  const Json json = Json::parse(reply.body);
  const auto queries = site.service().queries();
  EXPECT_EQ(json.at("frame"), "world");
  EXPECT_EQ(json.at("epoch"), queries->snapshot().epoch());
  EXPECT_EQ(json.at("revision"), queries->snapshot().revision());
  ASSERT_EQ(json.at("planes").size(), queries->planes().size());
  ASSERT_EQ(queries->planes().size(), 3u);
  std::size_t linked = 0;
  for (std::size_t i = 0; i < queries->planes().size(); ++i) {
    const Json& plane = json.at("planes")[i];
    const PlaneRecord& record = *queries->planes()[i].record;
    EXPECT_EQ(plane.at("id"), record.id);
    EXPECT_EQ(plane.at("class"), name_of(queries->planes()[i].plane_class));
    EXPECT_EQ(plane.at("d"), record.plane.d());
    EXPECT_EQ(plane.at("area"), queries->planes()[i].outline->area_m2);
    EXPECT_EQ(plane.at("polygons").size(), queries->planes()[i].outline->polygons.size());
    EXPECT_EQ(plane.at("normalDeviation"), normal_deviation_rad(record));
    const Eigen::Vector4d at(record.centroid_m.x(), record.centroid_m.y(), record.centroid_m.z(), 1.0);
    EXPECT_NEAR(plane.at("offsetDeviation").get<double>(), std::sqrt((at.transpose() * record.covariance * at).value()),
                1e-12);
    const auto details = queries->plane(record.id)->details;
    EXPECT_EQ(plane.at("coplanar").get<std::vector<PlaneId>>(), details->coplanar);
    EXPECT_EQ(plane.contains("coplanarWith"), !details->coplanar.empty());
    linked += plane.contains("coplanarWith") ? 1 : 0;
    const HttpReply one = site.get("/api/v1/plane/" + std::to_string(record.id));
    EXPECT_EQ(Json::parse(one.body), plane);
  }
  EXPECT_EQ(linked, 2u) << "two pieces of one wall";
}

TEST(HttpApi, PlanesAreNotSentTwiceToWhoHasThem) {
  TestSite site;
  site.room().look_around();
  const HttpReply first = site.get("/api/v1/planes");
  const auto snapshot = site.service().snapshot();
  const std::string etag = "\"" + std::to_string(snapshot->epoch()) + "-" + std::to_string(snapshot->revision()) + "\"";
  EXPECT_EQ(first.header("etag"), etag);
  const HttpReply again = site.get("/api/v1/planes", "If-None-Match: " + etag + "\r\n");
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
  site.room().join_walls();
  EXPECT_TRUE(eventually([&] { return site.get("/api/v1/planes", "If-None-Match: " + etag + "\r\n").status == 200; }));
}

TEST(HttpApi, CompressesForWhoTakesIt) {
  TestSite site;
  site.room().look_around();
  const HttpReply plain = site.get("/api/v1/planes");
  EXPECT_EQ(plain.header("content-encoding"), "");
  const HttpReply packed = site.get("/api/v1/planes", "Accept-Encoding: br, gzip;q=0.5\r\n");
  EXPECT_EQ(packed.header("content-encoding"), "gzip");
  EXPECT_LT(packed.body.size(), plain.body.size() / 2);
  EXPECT_EQ(gunzipped(packed.body), plain.body);
  EXPECT_EQ(site.get("/api/v1/planes", "Accept-Encoding: gzip;q=0\r\n").header("content-encoding"), "");
}

TEST(HttpApi, SaysWhatBecameOfAPlane) {
  TestSite site;
  site.room().look_around();
  std::set<PlaneId> before;
  for (const auto& plane : site.service().snapshot()->planes()) before.insert(plane->id);
  site.room().join_walls();
  const auto snapshot = site.service().snapshot();
  ASSERT_FALSE(snapshot->removed().empty());
  const RemovedPlane gone = snapshot->removed().front();
  ASSERT_TRUE(eventually([&] { return site.get("/api/v1/plane/" + std::to_string(gone.id)).status == 404; }));
  const Json merged = Json::parse(site.get("/api/v1/plane/" + std::to_string(gone.id)).body);
  EXPECT_EQ(merged.at("mergedInto"), gone.merged_into);
  EXPECT_EQ(merged.at("error"),
            "plane " + std::to_string(gone.id) + " was merged into plane " + std::to_string(gone.merged_into));
  const HttpReply unknown = site.get("/api/v1/plane/4711");
  EXPECT_EQ(unknown.status, 404);
  EXPECT_EQ(Json::parse(unknown.body).at("error"), "there is no plane 4711 in the map");
  for (const char* id : {"0", "-1", "x", "1/2", "99999999999999999999999"}) {
    const HttpReply wrong = site.get(std::string("/api/v1/plane/") + id);
    EXPECT_EQ(wrong.status, 400) << id;
    EXPECT_EQ(Json::parse(wrong.body).at("error"),
              "'" + std::string(id) + "' is no plane's id: a whole number from 1 on");
  }
}

TEST(HttpApi, TellsTheCellsAndWhatHasChangedSince) {
  TestSite site;
  site.room().look_at_floor();
  WireCells cells = cells_of(site.get("/api/v1/cells").body);
  EXPECT_TRUE(cells.is_full);
  EXPECT_EQ(cells.epoch, 1234u);
  expect_cells_of(*site.service().snapshot(), cells.blocks);
  for (const double y_m : {-1.1, 1.1, 0.0}) {
    site.room().look_at_wall(y_m);
    const auto revision = site.service().snapshot()->revision();
    WireCells more;
    ASSERT_TRUE(eventually([&] {
      more = cells_of(site.get("/api/v1/cells?since=" + std::to_string(cells.revision)).body);
      return more.revision == revision;
    }));
    EXPECT_FALSE(more.is_full);
    EXPECT_GT(more.blocks.size(), 0u);
    EXPECT_LT(more.blocks.size(), site.service().snapshot()->block_count()) << "the floor has not changed";
    for (const auto& [index, block] : more.blocks) {
      cells.blocks[index] = block;
      if (block.empty()) cells.blocks.erase(index);
    }
    cells.revision = more.revision;
    expect_cells_of(*site.service().snapshot(), cells.blocks);
  }
  EXPECT_TRUE(cells_of(site.get("/api/v1/cells?since=" + std::to_string(cells.revision)).body).blocks.empty());
  EXPECT_TRUE(cells_of(site.get("/api/v1/cells?since=4711").body).is_full) << "a revision that is not reached yet";
  EXPECT_TRUE(cells_of(site.get("/api/v1/cells?epoch=1&since=" + std::to_string(cells.revision)).body).is_full);
  const HttpReply wrong = site.get("/api/v1/cells?since=yesterday");
  EXPECT_EQ(wrong.status, 400);
  EXPECT_EQ(Json::parse(wrong.body).at("error"), "since must be a revision, a whole number, or left out");
}

TEST(HttpApi, CellsOfANewMapAreAllOfThem) {
  TestSite site;
  site.room().look_around();
  const WireCells old = cells_of(site.get("/api/v1/cells").body);
  ASSERT_TRUE(site.service().mapping().reset(std::chrono::seconds(30)));
  WireCells fresh;
  ASSERT_TRUE(eventually([&] {
    fresh = cells_of(site.get("/api/v1/cells?since=" + std::to_string(old.revision)).body);
    return fresh.epoch != old.epoch;
  }));
  EXPECT_TRUE(fresh.is_full);
  EXPECT_TRUE(fresh.blocks.empty());
}

TEST(HttpApi, ShowsTheScanToWhoLooks) {
  TestSite site;
  site.room().look_at_floor();
  EXPECT_EQ(site.get("/api/v1/scan").status, 204) << "nobody looked when it was mapped";
  site.room().look_at_wall(0.0);
  const HttpReply reply = site.get("/api/v1/scan");
  ASSERT_EQ(reply.status, 200);
  Reader in(reply.body);
  EXPECT_EQ(in.take<std::uint32_t>(), 0x534D4C50u);
  EXPECT_EQ(reply.body.substr(0, 4), "PLMS");
  EXPECT_EQ(in.take<std::uint32_t>(), 1u);
  EXPECT_EQ(in.take<std::int64_t>(), site.service().snapshot()->utime());
  const auto points = in.take<std::uint32_t>();
  EXPECT_EQ(points, 80u * 60u);
  in.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < points; ++i) {
    EXPECT_NEAR(in.take<float>(), 1.0F, 1e-5) << "on the wall x = 1";
    EXPECT_LT(std::abs(in.take<float>()), 0.6F);
    EXPECT_NEAR(in.take<float>(), 1.0F, 0.41);
  }
  EXPECT_TRUE(in.at_end());
}

TEST(HttpApi, TellsThePathOfTheSensor) {
  TestSite site;
  EXPECT_EQ(Json::parse(site.get("/api/v1/path").body), Json::parse(R"({"poses": []})"));
  site.room().look_around();
  const Json poses = Json::parse(site.get("/api/v1/path").body).at("poses");
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0][0], 11'000'000);
  EXPECT_EQ(poses[2][0], site.service().snapshot()->utime());
  EXPECT_NEAR(poses[2][2].get<double>(), 1.1, 1e-12);
  double norm = 0.0;
  for (int i = 4; i < 8; ++i) norm += std::pow(poses[2][static_cast<std::size_t>(i)].get<double>(), 2);
  EXPECT_NEAR(norm, 1.0, 1e-5);
}

TEST(LiveView, ThinsAPathToItsLimit) {
  LiveView view{SensorConfig{}};
  RegisteredScan scan;
  for (std::int64_t utime = 1; utime <= 10'000; ++utime) {
    scan.scan = PointScan{utime, {}, {}};
    view.on_mapped({scan, 1, {}, 0.0});
  }
  const Json poses = Json::parse(view.path_json()).at("poses");
  EXPECT_GT(poses.size(), LiveView::kPathPoses / 2 - 1);
  EXPECT_LE(poses.size(), LiveView::kPathPoses);
  EXPECT_EQ(poses.front()[0], 1);
  EXPECT_EQ(poses.back()[0], 10'000);
  for (std::size_t i = 2; i + 1 < poses.size(); ++i) {
    EXPECT_EQ(poses[i][0].get<int>() - poses[i - 1][0].get<int>(), poses[1][0].get<int>() - poses[0][0].get<int>());
  }
  scan.scan = PointScan{1, {}, {}};
  view.on_mapped({scan, 2, {}, 0.0});
  EXPECT_EQ(Json::parse(view.path_json()).at("poses").size(), 1u) << "a new map, a new path";
}

TEST(LiveView, ThinsScansOfAnySize) {
  const SensorConfig sensor;
  for (const int width : {1, 63, 640, 1280, 4096}) {
    DepthScan scan;
    scan.intrinsics = {width, 480, 500.0, 500.0, width / 2.0, 240.0};
    scan.depth.assign(static_cast<std::size_t>(width) * 480, 2000);
    const std::string blob = scan_blob_of(scan, Eigen::Isometry3d::Identity(), sensor);
    EXPECT_LE(blob.size(), 24 + 12 * LiveView::kScanPoints) << width;
    EXPECT_GE(blob.size(), 24 + 12 * std::min<std::size_t>(static_cast<std::size_t>(width) * 20, 3000)) << width;
  }
  PointScan points;
  points.xyz_m.assign(3 * 300'000, 1.0F);
  EXPECT_LE(scan_blob_of(points, Eigen::Isometry3d::Identity(), sensor).size(), 24 + 12 * LiveView::kScanPoints);
}

TEST(HttpApi, TellsTheStatusAsTheCommandLineDoes) {
  TestSite site;
  site.room().look_at_floor();
  const Json status = Json::parse(site.get("/api/v1/status").body);
  for (const char* key : {"version", "utime", "epoch", "revision", "planeCount", "cellCount", "blockCount",
                          "scanRateHz", "scanMs", "lastScanUtime", "idleReason", "degraded", "counters"}) {
    EXPECT_TRUE(status.contains(key)) << key;
  }
  EXPECT_EQ(status.at("counters").at("scans.mapped"), 1);
}

TEST(HttpApi, GivesDownloads) {
  TestSite site;
  site.room().look_around();
  const Json planes = Json::parse(site.get("/api/v1/export/planes.json").body);
  EXPECT_EQ(planes.at("planes").size(), 3u);
  const struct {
    const char* name;
    const char* begins;
    const char* has;
  } downloads[] = {{"planes.ply", "ply\nformat binary_little_endian 1.0\n", "property int plane_id"},
                   {"planes.obj", "# planes of map 1234", "_floor\n"},
                   {"planes.svg", "<svg ", "Floor plan"}};
  for (const auto& download : downloads) {
    const HttpReply reply = site.get(std::string("/api/v1/export/") + download.name);
    EXPECT_EQ(reply.status, 200);
    EXPECT_EQ(reply.header("content-disposition"), std::string("attachment; filename=\"") + download.name + "\"");
    EXPECT_TRUE(reply.body.starts_with(download.begins)) << reply.body.substr(0, 100);
    EXPECT_NE(reply.body.find(download.has), std::string::npos) << download.name;
  }
  const HttpReply unknown = site.get("/api/v1/export/planes.dwg");
  EXPECT_EQ(unknown.status, 404);
  EXPECT_EQ(Json::parse(unknown.body).at("error"),
            "'planes.dwg' cannot be exported: there are planes.json, planes.ply, planes.obj and planes.svg");
}

TEST(HttpPage, IsServedWithItsFilesAndTags) {
  TestSite site;
  const HttpReply page = site.get("/");
  ASSERT_EQ(page.status, 200);
  EXPECT_EQ(page.header("content-type"), "text/html; charset=utf-8");
  EXPECT_EQ(page.header("cache-control"), "no-cache");
  EXPECT_NE(page.body.find("<html"), std::string::npos);
  EXPECT_EQ(page.body.find("<style"), std::string::npos) << "the page's own policy forbids it";
  EXPECT_EQ(site.get("/index.html").body, page.body);
  const HttpReply packed = site.get("/", "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(packed.header("content-encoding"), "gzip");
  EXPECT_EQ(gunzipped(packed.body), page.body);
  EXPECT_EQ(site.get("/", "If-None-Match: " + page.header("etag") + "\r\n").status, 304);
  EXPECT_EQ(site.get("/../../etc/passwd").status, 404);
  EXPECT_EQ(site.get("/api/v1/licenses").status, 200);
}

}  // namespace
}  // namespace planemap::service
