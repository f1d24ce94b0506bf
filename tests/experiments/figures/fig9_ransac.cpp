#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "figures/figures.hpp"
#include "figures/map_faces.hpp"
#include "picture/camera.hpp"
#include "plot/svg_page.hpp"
#include "real/plane_comparison.hpp"
#include "real/ransac_planes.hpp"

namespace planemap::experiments {

using namespace plot;

namespace {

constexpr double kElevationRad = 0.62;
constexpr double kPaperMeanDeg = 5.96;

/// Our planes in the colours of the RANSAC planes that they are matched with; the others grey.
void colour_as_matched(MapFaces& map, const PlaneComparison& comparison) {
  for (std::size_t face = 0; face < map.ids.size(); ++face) {
    map.faces[face].colour = {168, 172, 180};
    for (std::size_t rank = comparison.pairs.size(); rank-- > 0;) {
      const PlanePair& pair = comparison.pairs[rank];
      if (pair.matched() && pair.plane == map.ids[face]) map.faces[face].colour = colour_of_rank(rank);
    }
  }
}

/// The inliers of RANSAC that our map left out because the normals there are too uncertain.
void draw_left_out(SvgPage& page, const PageFit& place, const std::vector<RansacPlane>& ransac,
                   const std::vector<PointLabel>& labels, const std::vector<Eigen::Vector3f>& cloud_m) {
  std::string path = "<path class=\"s1\" stroke-width=\"2.6\" d=\"";
  for (const RansacPlane& plane : ransac) {
    for (const std::uint32_t i : plane.inliers) {
      if (!labels[i].uncertain) continue;
      const Pixel p = place(cloud_m[i].cast<double>());
      path += fmt::format("M{:.0f} {:.0f}h0", p.x(), p.y());
    }
  }
  page.raw(path + "\"/>\n");
}

nlohmann::ordered_json json_of(const PlaneComparison& comparison) {
  nlohmann::ordered_json json = {{"matched", comparison.matched()},
                                 {"unmatched", comparison.pairs.size() - comparison.matched()},
                                 {"meanNormalDeg", comparison.mean_normal_deg()},
                                 {"maxNormalDeg", comparison.max_normal_deg()}};
  for (const PlanePair& pair : comparison.pairs) {
    json["pairs"].push_back({{"inliers", pair.inliers},
                             {"plane", pair.plane},
                             {"share", pair.share},
                             {"matched", pair.matched()},
                             {"normalDeg", pair.normal_deg},
                             {"offsetM", pair.offset_m},
                             {"inNoPlane", pair.no_plane_share},
                             {"leftOutForItsNormals", pair.uncertain_share}});
  }
  return json;
}

void describe(const std::string& name, const SceneRun& scene, const PlaneComparison& comparison,
              const std::vector<RansacPlane>& ransac, std::vector<std::string>& lines) {
  lines.push_back(fmt::format(
      "{}: {} of {} RANSAC planes matched; normals differ by {:.2f} deg in the mean, {:.2f} deg at most", name,
      comparison.matched(), comparison.pairs.size(), comparison.mean_normal_deg(), comparison.max_normal_deg()));
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const PlanePair& pair = comparison.pairs[i];
    const double upright = std::abs(ransac[i].plane.normal().dot(scene.up));
    lines.push_back(fmt::format(
        "  {:6} inliers, {:4.1f} deg from level; plane {:4} shares {:3.0f} %: {}; no plane {:3.0f} %, {:.0f} % for its "
        "normals",
        pair.inliers, std::acos(std::min(upright, 1.0)) * 180.0 / std::numbers::pi, pair.plane, 100.0 * pair.share,
        pair.matched() ? fmt::format("{:5.2f} deg, {:5.1f} mm", pair.normal_deg, 1e3 * pair.offset_m)
                       : "unmatched          ",
        100.0 * pair.no_plane_share, 100.0 * pair.uncertain_share));
  }
}

/// Who is more square: our matched planes, and the largest RANSAC plane of each.
void compare_skew(const PresetRun& run, const PlaneComparison& comparison, const std::vector<RansacPlane>& ransac,
                  nlohmann::ordered_json& json, std::vector<std::string>& lines) {
  std::set<PlaneId> seen;
  std::vector<Plane> ours;
  std::vector<Plane> theirs;
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const PlanePair& pair = comparison.pairs[i];
    if (!pair.matched() || !seen.insert(pair.plane).second) continue;
    ours.push_back(run.map->find(pair.plane)->plane);
    theirs.push_back(ransac[i].plane);
  }
  json["skewDeg"] = {{"planes", ours.size()}, {"ours", mean_skew_deg(ours)}, {"ransac", mean_skew_deg(theirs)}};
  lines.push_back(
      fmt::format("  angles between the {} matched planes miss 0 or 90 deg by {:.2f} deg (ours), {:.2f} deg (RANSAC's)",
                  ours.size(), mean_skew_deg(ours), mean_skew_deg(theirs)));
}

/// What one preset's map comes to beside RANSAC.
PlaneComparison compare(const SceneRun& scene, const PresetRun& run, const std::vector<PointLabel>& labels,
                        const std::vector<RansacPlane>& ransac, const RansacConfig& config, FigureResult& result) {
  const PlaneComparison comparison = compare_planes(*run.map, labels, scene.cloud_m, ransac);
  const std::string peer = config.connected_within_m > 0.0 ? "connected" : "plain";
  describe(run.name + ", RANSAC " + peer, scene, comparison, ransac, result.lines);
  nlohmann::ordered_json& json = result.numbers[run.name][peer];
  json = json_of(comparison);
  compare_skew(run, comparison, ransac, json, result.lines);
  double ours_deg = 0.0;
  double ransac_deg = 0.0;
  const auto errors = errors_of_pairs(*run.map, comparison, scene.cloud_m, ransac, scene.truth);
  for (const KnownError& error : errors) {
    ours_deg += error.ours_deg / static_cast<double>(errors.size());
    ransac_deg += error.ransac_deg / static_cast<double>(errors.size());
  }
  if (errors.empty()) return comparison;
  json["errorToTruthDeg"] = {{"ours", ours_deg}, {"ransac", ransac_deg}};
  result.lines.push_back(
      fmt::format("  matched pairs beside the true planes: ours wrong by {:.2f} deg in the mean, RANSAC by {:.2f} deg",
                  ours_deg, ransac_deg));
  return comparison;
}

void compare_on_own_surfaces(const SceneRun& scene, const PresetRun& run, const std::vector<PointLabel>& labels,
                             FigureResult& result) {
  const auto surfaces = ransac_on_own_surfaces(*run.map, labels, scene.cloud_m, RansacConfig().planes, {});
  double ransac_deg = 0.0;
  double fit_deg = 0.0;
  std::vector<std::string> rows;
  nlohmann::ordered_json& json = result.numbers[run.name]["onOwnSurfaces"];
  for (const OwnSurface& surface : surfaces) {
    ransac_deg += surface.normal_deg / static_cast<double>(surfaces.size());
    fit_deg += surface.fit_deg / static_cast<double>(surfaces.size());
    rows.push_back(
        fmt::format("  plane {:4}, {:6} points, {:3.0f} mm thick: RANSAC {:5.2f} deg with {:3.0f} % of them, least "
                    "squares {:5.2f} deg",
                    surface.plane, surface.points, 1e3 * surface.thickness_m, surface.normal_deg,
                    100.0 * surface.inlier_share, surface.fit_deg));
    json["planes"].push_back({{"plane", surface.plane},
                              {"points", surface.points},
                              {"thicknessM", surface.thickness_m},
                              {"inlierShare", surface.inlier_share},
                              {"ransacDeg", surface.normal_deg},
                              {"leastSquaresDeg", surface.fit_deg}});
  }
  json["meanRansacDeg"] = ransac_deg;
  json["meanLeastSquaresDeg"] = fit_deg;
  result.lines.push_back(
      fmt::format("{}: RANSAC given the points of one plane of the map alone, {} largest: {:.2f} deg in the mean; "
                  "least squares {:.2f} deg",
                  run.name, surfaces.size(), ransac_deg, fit_deg));
  result.lines.insert(result.lines.end(), rows.begin(), rows.end());
}

/// A point of the cloud is one in a cube: gaps of two and a half cubes are none.
RansacConfig connected_planes(double leaf_m) {
  RansacConfig config;
  config.connected_within_m = 2.5 * leaf_m;
  return config;
}

}  // namespace

FigureResult draw_fig9(const std::filesystem::path& folder, const SceneRun& scene) {
  const RansacConfig plain;
  const RansacConfig connected = connected_planes(scene.leaf_m);
  const std::vector<RansacPlane> ransac = ransac_planes(scene.cloud_m, plain);
  const std::vector<RansacPlane> connected_ransac = ransac_planes(scene.cloud_m, connected);
  FigureResult result;
  std::vector<PointLabel> labels;  // of best
  PlaneComparison best;
  for (const PresetRun& run : scene.presets) {
    const auto said = label_points(*run.map, scene.cloud_m, run.config.normals.max_deviation_deg);
    const PlaneComparison comparison = compare(scene, run, said, ransac, plain, result);
    compare(scene, run, said, connected_ransac, connected, result);
    compare_on_own_surfaces(scene, run, said, result);
    if (&run != &scene.best()) continue;
    labels = said;
    best = comparison;
  }
  result.lines.push_back(fmt::format("the paper: {:.2f} deg in the mean, 15 planes", kPaperMeanDeg));
  result.numbers["paper's"] = {{"meanNormalDeg", kPaperMeanDeg}, {"planes", 15}};
  MapFaces map = faces_of(*scene.best().map, 0.05);
  colour_as_matched(map, best);
  const auto peers =
      faces_of(ransac, scene.cloud_m, scene.sensors_m, std::max(scene.best().map->cell_size_m(), 1.6 * scene.leaf_m));
  SvgPage page(
      1160.0, 520.0, "Fig. 9: planes by RANSAC and by planemap, " + scene.title,
      fmt::format("{} of {} RANSAC planes are matched; their normals differ by {:.2f}° in the mean (the paper: {}°).",
                  best.matched(), best.pairs.size(), best.mean_normal_deg(), kPaperMeanDeg));
  const Camera camera(scene.up, best_azimuth_rad(scene.up, kElevationRad, map.faces), kElevationRad);
  const std::vector<Eigen::Vector3d> extent = corners_of(map.faces);
  page.text({24.0, 88.0}, "(a) RANSAC (PCL), offline on the accumulated cloud", "text head");
  draw_faces(page, PageFit(camera, extent, {24.0, 100.0, 540.0, 370.0}), camera, peers);
  page.text({594.0, 88.0}, "(b) planemap, online; matched planes in the same colour", "text head");
  const PageFit right(camera, extent, {594.0, 100.0, 540.0, 370.0});
  draw_faces(page, right, camera, map.faces);
  draw_left_out(page, right, ransac, labels, scene.cloud_m);
  page.circle({600.0, 496.0}, 3.0, "f1 solid");
  page.text({610.0, 500.0}, "in a RANSAC plane, but left out here because the normals are too uncertain");
  page.rectangle({24.0, 490.0, 12.0, 10.0}, "f5 solid");
  page.text({42.0, 500.0}, "grey: planes without a partner among RANSAC's");
  result.files.push_back(folder / ("fig9-" + scene.name + ".svg"));
  page.save(result.files.back());
  return result;
}

}  // namespace planemap::experiments
