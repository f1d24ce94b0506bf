#include <spdlog/fmt/fmt.h>

#include <numbers>

#include "figures/figures.hpp"
#include "figures/map_faces.hpp"
#include "picture/camera.hpp"
#include "plot/svg_page.hpp"

namespace planemap::experiments {

using namespace plot;

FigureResult draw_fig10(const std::filesystem::path& folder, const SceneRun& scene) {
  constexpr double kElevationRad = 0.62;
  constexpr double kLeastAreaM2 = 0.05;
  const MapFaces map = faces_of(*scene.best().map, kLeastAreaM2);
  SvgPage page(1160.0, 520.0, "Fig. 10: the map, " + scene.title,
               fmt::format("{} planes of at least {} m² (preset best), from two directions; what turns away from the "
                           "viewer is left out.",
                           map.ids.size(), kLeastAreaM2));
  const double first_rad = best_azimuth_rad(scene.up, kElevationRad, map.faces);
  double x = 24.0;
  for (const double azimuth_rad : {first_rad, first_rad + 0.4 * std::numbers::pi}) {
    const Camera camera(scene.up, azimuth_rad, kElevationRad);
    page.text({x, 88.0}, x < 100.0 ? "(a)" : "(b) from 72° farther round", "text head");
    draw_faces(page, PageFit(camera, corners_of(map.faces), {x, 100.0, 540.0, 400.0}), camera, map.faces);
    x += 570.0;
  }
  double area_m2 = 0.0;
  for (const PictureFace& face : map.faces) area_m2 += face.outline.area_m2;
  FigureResult result;
  result.lines.push_back(
      fmt::format("{} planes of at least {} m2, {:.1f} m2 together", map.ids.size(), kLeastAreaM2, area_m2));
  result.numbers = {{"planes", map.ids.size()}, {"areaM2", area_m2}};
  result.files.push_back(folder / ("fig10-" + scene.name + ".svg"));
  page.save(result.files.back());
  return result;
}

}  // namespace planemap::experiments
