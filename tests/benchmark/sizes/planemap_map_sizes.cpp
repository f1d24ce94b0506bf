// The size of a map on the wire beside its peers' maps of the same scans.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <planemap/mapper.hpp>
#include <planemap_lcm/request_t.hpp>
#include <stdexcept>
#include <support/program.hpp>

#include "bench_frames.hpp"
#include "frame_source.hpp"
#include "serve/lcm/request_answerer.hpp"
#include "sizes/peer_maps.hpp"

namespace planemap::benchmark {
namespace {

struct Arguments {
  FrameOptions from;
  std::size_t frames = 300;
  std::optional<double> resolution_m;
  bool json = false;
};

/// A reply over LCM: bytes and pages.
struct WireSize {
  std::size_t bytes = 0;
  std::size_t pages = 0;
};
WireSize wire_size(std::int16_t operation, const std::shared_ptr<const MapSnapshot>& snapshot,
                   const service::ServiceConfig& config) {
  service::PlaneBook book(config.map);
  service::RequestAnswerer answerer(config, book);
  service::Request request;
  request.request_id = 1;
  request.reply_channel = "PLANEMAP_REPLY_SIZES";
  request.operation = operation;
  const auto reply = answerer.answer(
      request, snapshot, [] { return planemap_lcm::status_t{}; }, snapshot->utime());
  if (!reply.error.empty()) throw std::runtime_error(reply.error);
  WireSize size;
  for (std::size_t i = reply.begin; i < reply.end; ++i) size.bytes += (*reply.pages)[i].size();
  size.pages = reply.end - reply.begin;
  return size;
}

void measure(const Arguments& arguments) {
  service::ServiceConfig config;
  config.mapper = preset(Preset::kBest);
  const auto source = open_frames(arguments.from, arguments.frames);
  if (const auto g = source->gravity_direction()) config.map.gravity = {g->x(), g->y(), g->z()};
  const double cell_m = config.mapper.grid.cell_size_m;
  Mapper mapper(config.mapper, /*epoch=*/1);
  const double resolution_m = arguments.resolution_m.value_or(cell_m);
  PeerMaps peers(resolution_m);
  std::size_t frames = 0;
  while (frames < arguments.frames) {
    const auto next = read_frames(*source, 1, config.mapper.sensor);
    if (next.empty()) break;
    mapper.integrate(next[0].scan, next[0].T_world_sensor);
    peers.add(next[0]);
    ++frames;
  }
  if (frames == 0) throw std::runtime_error("there is no frame to measure with");
  const auto snapshot = mapper.snapshot();
  const WireSize planes = wire_size(planemap_lcm::request_t::OPERATION_SNAPSHOT, snapshot, config);
  const WireSize cells = wire_size(planemap_lcm::request_t::OPERATION_CELLS, snapshot, config);
  const PeerSizes peer = peers.sizes();
  const std::size_t voxel_bytes = 12 * peer.voxel_points;
  if (arguments.json) {
    const nlohmann::ordered_json json = {{"frames", frames},
                                         {"cellSizeM", cell_m},
                                         {"peersResolutionM", resolution_m},
                                         {"planes", snapshot->planes().size()},
                                         {"planesLcmBytes", planes.bytes},
                                         {"planesLcmPages", planes.pages},
                                         {"cellsLcmBytes", cells.bytes},
                                         {"octomapBtBytes", peer.octomap_bt_bytes},
                                         {"octomapOtBytes", peer.octomap_ot_bytes},
                                         {"octomapEndpointsBtBytes", peer.octomap_endpoints_bt_bytes},
                                         {"voxelPoints", peer.voxel_points},
                                         {"voxelCloudBytes", voxel_bytes}};
    std::printf("%s\n", json.dump(2).c_str());
    return;
  }
  std::string text = fmt::format("{} frames, cells of {} m, the peers' voxels of {} m\n", frames, cell_m, resolution_m);
  const auto line = [&text, &planes](const std::string& what, std::size_t bytes) {
    text += fmt::format("{:<68} {:>10} bytes {:>7.1f}\n", what, bytes,
                        static_cast<double>(bytes) / static_cast<double>(planes.bytes));
  };
  line(fmt::format("planemap over LCM, {} planes with covariances and boundaries", snapshot->planes().size()),
       planes.bytes);
  line("planemap over LCM, all dense cells with their normals and errors", cells.bytes);
  line("OctoMap .bt, occupied and free", peer.octomap_bt_bytes);
  line("OctoMap .ot, with probabilities", peer.octomap_ot_bytes);
  line("OctoMap .bt of the end points alone", peer.octomap_endpoints_bt_bytes);
  line(fmt::format("voxel cloud, {} points of three floats", peer.voxel_points), voxel_bytes);
  std::fputs(text.c_str(), stdout);
}

void define_options(CLI::App& app, Arguments& arguments) {
  define_frame_options(app, arguments.from);
  app.add_option("--frames", arguments.frames, "how many, at most")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--resolution", arguments.resolution_m, "of OctoMap and the voxel cloud, metres (default: planemap's)")
      ->check(CLI::Range(0.005, 1.0));
  app.add_flag("--json", arguments.json, "one object instead of the table");
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong use.");
}

}  // namespace
}  // namespace planemap::benchmark

int main(int argc, char** argv) {
  using namespace planemap::benchmark;
  CLI::App app(
      "planemap-map-sizes: bytes of a map over LCM, beside OctoMap's files and a voxel cloud of the same scans",
      "planemap-map-sizes");
  Arguments arguments;
  define_options(app, arguments);
  return planemap::run_program(app, argc, argv, [&] { measure(arguments); });
}
