// fuzz_seeds FOLDER: writes good inputs of every target into FOLDER/<target>/. From these the kept corpus grew
// (tests/fuzz/README.md); to be run again where a format changes.
#include <planemap/v1/map.pb.h>
#include <planemap/v1/queries.pb.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <planemap/block.hpp>
#include <planemap/mapper.hpp>
#include <planemap_lcm/status_t.hpp>

#include "codec/page_codec.hpp"
#include "codec/proto_codec.hpp"
#include "core/rooms.hpp"
#include "formats/field_formats.hpp"
#include "fuzz_input.hpp"
#include "serve/lcm/delta_maker.hpp"
#include "serve/lcm/map_answers.hpp"
#include "small_map.hpp"
#include "store/block_codec.hpp"
#include "store/map_file.hpp"
#include "store/plane_row_codec.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::fuzz {
namespace {

class Seeds {
 public:
  explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void add(const std::string& target, Input bytes) {
    const auto path = folder_ / target / ("seed-" + std::to_string(count_++));
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) throw std::runtime_error(path.string() + " can't be written");
  }
  /// Behind the byte that chooses.
  void add(const std::string& target, std::uint8_t choice, Input bytes) {
    Bytes input{choice};
    input.insert(input.end(), bytes.begin(), bytes.end());
    add(target, input);
  }
  void add(const std::string& target, std::uint8_t choice, const std::string& text) {
    add(target, choice, Input(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
  /// A message without its fingerprint, which the choice stands for.
  template <class Message>
  void add_lcm(const std::string& target, std::uint8_t choice, const Message& message) {
    const Bytes bytes = encoded(message);
    add(target, choice, Input(bytes).subspan(8));
  }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
};

constexpr TestCamera kTinyCamera{8, 6, 7.5};

DepthScan tiny_scan() {
  DepthScan scan;
  scan.utime = 5;
  scan.intrinsics = {8, 6, 7.5, 7.5, 4.0, 3.0};
  scan.depth.assign(48, 1000);
  return scan;
}

void add_scans(Seeds& seeds) {
  namespace bridge = kinect_bridge;
  const auto depth = depth_message(5, 1, kTinyCamera, [](int u, int v) { return std::uint16_t(900 + 10 * u + v); });
  seeds.add_lcm("own_scans", 0, depth);
  seeds.add_lcm("own_scans", 0, zipped(depth));
  seeds.add_lcm("own_scans", 1, three_points_message(5, 1));
  const DepthScan scan = tiny_scan();
  for (const auto encoding : {bridge::Encoding::kRaw, bridge::Encoding::kZlib}) {
    seeds.add_lcm("kinect_frames", 0, bridge::to_kinect_frame(scan, encoding));
    seeds.add_lcm("kinect_frames", 0, bridge::to_kinect_disparity(scan, encoding));
    seeds.add_lcm("bot_core_images", 0, bridge::to_images(scan, encoding));
    for (const auto pixels : {bridge::DrakePixels::kUint16, bridge::DrakePixels::kFloat32}) {
      seeds.add_lcm("drake_images", 0, bridge::to_image_array(scan, pixels, encoding));
    }
  }
  const auto png = bridge::to_image_array(scan, bridge::DrakePixels::kUint16, bridge::Encoding::kPng);
  seeds.add_lcm("drake_images", 0, png);
  for (const auto& image : png.images) {
    if (image.data.size() < 8) continue;
    seeds.add("png_images", 0, image.data);
    seeds.add("png_images", 1, image.data);
  }
  auto packed = bridge::to_kinect_disparity(scan, bridge::Encoding::kRaw);
  packed.depth.depth_data_format = kinect::depth_msg_t::DEPTH_11BIT_PACKED;
  packed.depth.depth_data.resize(48 * 11 / 8);
  packed.depth.depth_data_nbytes = static_cast<std::int32_t>(packed.depth.depth_data.size());
  seeds.add_lcm("kinect_frames", 0, packed);
  seeds.add_lcm("bot_core_images", 1, bridge::to_image(scan));
  seeds.add_lcm("point_clouds", 0, bridge::to_pointcloud2(scan));
  seeds.add_lcm("point_clouds", 1, bridge::to_point_cloud(scan));
  seeds.add_lcm("poses", 0, pose_message(5));
  seeds.add_lcm("poses", 1, bridge::to_rigid_transform(Eigen::Isometry3d::Identity(), 5));
  seeds.add_lcm("poses", 2, pose_cov_message(5, 1.0, 0.01, 0.002));
}

/// Requests of every kind, as messages and as what they are answered with.
void add_requests(Seeds& seeds) {
  using planemap_lcm::request_t;
  std::vector<request_t> requests;
  auto nearest = request_message(request_t::OPERATION_NEAREST);
  nearest.nearest.resize(1);
  nearest.nearest[0].points.resize(1);
  nearest.nearest[0].n_points = 1;
  nearest.nearest[0].count = 2;
  requests.push_back(nearest);
  auto rays = request_message(request_t::OPERATION_RAYS);
  rays.rays.resize(1);
  rays.rays[0].rays.resize(1);
  rays.rays[0].rays[0].direction[0] = 1.0;
  rays.rays[0].n_rays = 1;
  rays.rays[0].planes = rays.rays[0].cells = 1;
  requests.push_back(rays);
  auto region = request_message(request_t::OPERATION_REGION);
  region.region.resize(1);
  region.region[0].shape = planemap_lcm::region_query_t::SHAPE_SPHERE;
  region.region[0].from_m[0] = 2.5;
  region.region[0].from_m[2] = 0.5;
  region.region[0].radius_m = 0.3;
  region.region[0].polygons = region.region[0].cells = 1;
  requests.push_back(region);
  auto plane = request_message(request_t::OPERATION_PLANE);
  plane.plane.resize(1);
  plane.plane[0].id = 1;
  requests.push_back(plane);
  auto floorplan = request_message(request_t::OPERATION_FLOORPLAN);
  floorplan.floorplan.resize(1);
  auto& heights = floorplan.floorplan[0];
  heights.cut_low_m = 0.3;
  heights.cut_high_m = 1.5;
  heights.wall_thickness_m = heights.clear_low_m = 0.1;
  heights.clear_high_m = 1.8;
  requests.push_back(floorplan);
  requests.push_back(request_message(request_t::OPERATION_SNAPSHOT));
  for (auto& request : requests) {
    request.n_nearest = static_cast<std::int32_t>(request.nearest.size());
    request.n_rays = static_cast<std::int32_t>(request.rays.size());
    request.n_region = static_cast<std::int32_t>(request.region.size());
    request.n_plane = static_cast<std::int32_t>(request.plane.size());
    request.n_floorplan = static_cast<std::int32_t>(request.floorplan.size());
    request.filter.classes = {"wall"};
    request.filter.n_classes = 1;
    seeds.add_lcm("requests", 0, request);
    request.filter.classes.clear();
    request.filter.n_classes = 0;
    const auto decoded = service::decode_request(encoded(request));
    if (!decoded) throw std::runtime_error("a seed is no request: " + decoded.error().message);
    planemap_lcm::reply_t answer{};
    auto refusal = service::check_arguments(*decoded);
    if (!refusal) refusal = service::answer_from(small_map(), *decoded, answer);
    if (refusal) throw std::runtime_error("a seed is refused: " + refusal->message);
    answer.request_id = 7;
    answer.epoch = 77;
    answer.revision = 3;
    const auto pages = service::encode_pages(std::move(answer), /*page_bytes=*/60000, 0.08);
    if (!pages) throw std::runtime_error(pages.error().message);
    for (const auto& page : *pages) seeds.add("replies", 0, Input(page).subspan(8));
  }
}

void add_messages_of_the_service(Seeds& seeds, const std::shared_ptr<const MapSnapshot>& map) {
  const service::ServiceConfig config;
  service::PlaneBook book(config.map);
  service::DeltaMaker deltas(config, book);
  for (const auto& page : deltas.make(map)) seeds.add("replies", 1, Input(page).subspan(8));
  planemap_lcm::status_t status{};
  status.version = "0.1.0";
  status.idle_reason = "no scan has come";
  status.counters = {planemap_lcm::counter_t{"scans.mapped", 3}};
  status.n_counters = 1;
  seeds.add_lcm("replies", 2, status);
}

void add_protos(Seeds& seeds) {
  v1::NearestPlanesRequest nearest;
  nearest.add_points()->mutable_point_m()->set_x(1.0);
  nearest.mutable_points(0)->set_sigma_m(0.1);
  nearest.set_count(2);
  seeds.add("proto_messages", 0, nearest.SerializeAsString());
  v1::CastRaysRequest rays;
  auto* ray = rays.add_rays();
  ray->mutable_origin_m()->set_z(1.0);
  ray->mutable_direction()->set_x(1.0);
  seeds.add("proto_messages", 1, rays.SerializeAsString());
  v1::QueryRegionRequest region;
  region.mutable_sphere()->mutable_centre_m()->set_x(1.0);
  region.mutable_sphere()->set_radius_m(2.0);
  region.set_polygons(true);
  region.set_cells(true);
  seeds.add("proto_messages", 2, region.SerializeAsString());
  v1::GetFloorPlanRequest floorplan;
  floorplan.mutable_filter()->set_min_area_m2(0.5);
  seeds.add("proto_messages", 3, floorplan.SerializeAsString());
  service::ShapedMap map;
  map.frame = "world";
  for (const auto& plane : small_map().planes())
    map.planes.push_back({*plane.record, plane.plane_class, *plane.outline});
  seeds.add("proto_messages", 4, service::to_proto(map).SerializeAsString());
}

void add_map_files(Seeds& seeds, const std::shared_ptr<const MapSnapshot>& map) {
  for (std::size_t i = 0; i < map->blocks().size(); i += 5) {
    seeds.add("map_rows", 0, service::encode_block(*map->blocks()[i]));
  }
  for (const auto& plane : map->planes()) seeds.add("map_rows", 1, service::encode_plane(*plane));
  const TemporaryFolder folder;
  const auto path = folder / "m.planemap";
  auto file = service::MapFile::create(path, {"hall", "0 0 -1", "config", ""});
  if (!file) throw std::runtime_error(file.error().message);
  if (const auto closed = file->close(map); !closed) throw std::runtime_error(closed.error().message);
  const std::string bytes = read_file(path);
  seeds.add("map_file", Input(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
}

void add_lcm_log(Seeds& seeds) {
  Bytes log;
  const auto put = [&](std::uint64_t value, int bytes) {
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) log.push_back(static_cast<std::uint8_t>(value >> shift));
  };
  for (std::uint64_t number = 0; number < 3; ++number) {
    const std::string channel = "POSE";
    const Bytes data = encoded(pose_message(static_cast<std::int64_t>(number)));
    put(0xEDA1DA01, 4);
    put(number, 8);
    put(1'000'000 + number, 8);
    put(channel.size(), 4);
    put(data.size(), 4);
    log.insert(log.end(), channel.begin(), channel.end());
    log.insert(log.end(), data.begin(), data.end());
    if (number == 1) log.insert(log.end(), {0xED, 0xA1, 0xDA, 0x01, 0x00});  // cut short
  }
  seeds.add("lcm_log", log);
}

void add_texts(Seeds& seeds) {
  seeds.add("pose_files", 0, "1 0 0 0.5\n0 1 0 -2\n0 0 1 1.5e-1\n0 0 0 1\n");
  seeds.add("pose_files", 1,
            "# timestamp tx ty tz qx qy qz qw\n1305031098.6659 1.34 0.62 1.66 0.65 0.61 -0.29 -0.32\n");
  seeds.add("pose_files", 2, "585,585,320,240");
  seeds.add("yaml_config", 0,
            "grid:\n  cell_size_m: 0.08\ninputs:\n  - {channel: SCAN, family: auto}\npose:\n  sigma_m: 0.005\n");
  seeds.add("yaml_config", 1, "inputs.0.channel=SCAN");
  seeds.add("yaml_config", 1, "sensor.max_range_m=4.5");
}

/// Few cells: fuzzers like small files.
std::shared_ptr<const MapSnapshot> tiny_map() {
  const std::vector<testing::Wall> room = {{{0, 0, 1}, 0.0}, {{-1, 0, 0}, 1.0}};
  Mapper mapper(preset(Preset::kBest), /*epoch=*/77);
  const auto T = testing::looking({0.2, 0.0, 0.6}, {1.0, 0.0, 0.2});
  mapper.integrate(testing::render(room, T, 1, 1.0, 64, 48), T);
  return mapper.snapshot();
}

}  // namespace
}  // namespace planemap::fuzz

int main(int argc, char** argv) {
  using namespace planemap::fuzz;
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  try {
    Seeds seeds(argv[1]);
    const auto map = tiny_map();
    add_scans(seeds);
    add_requests(seeds);
    add_messages_of_the_service(seeds, map);
    add_protos(seeds);
    add_map_files(seeds, map);
    add_lcm_log(seeds);
    add_texts(seeds);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_seeds: %s\n", error.what());
    return 1;
  }
}
