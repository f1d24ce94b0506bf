#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "real/scene_run.hpp"

namespace planemap::experiments {

/// What one figure came to.
struct FigureResult {
  std::vector<std::filesystem::path> files;  ///< SVGs that were written
  std::vector<std::string> lines;            ///< for people
  nlohmann::ordered_json numbers;            ///< the same for programs, the paper's beside ours
};

// Each draws one figure of the paper into a folder. Throws std::runtime_error where a file can't be written.

FigureResult draw_fig1(const std::filesystem::path& folder);     ///< mapping a point to the grid
FigureResult draw_fig2(const std::filesystem::path& folder);     ///< min-max approach; uncertain normals
FigureResult draw_fig4(const std::filesystem::path& folder);     ///< the table under noise
FigureResult draw_fig5(const std::filesystem::path& folder);     ///< distances of points to centres over noise
FigureResult draw_normals(const std::filesystem::path& folder);  ///< deviation of normals at two levels of noise

FigureResult draw_fig6(const std::filesystem::path& folder, const SceneRun& scene);   ///< time of each step
FigureResult draw_fig7(const std::filesystem::path& folder, const SceneRun& scene);   ///< time, planes over time
FigureResult draw_fig8(const std::filesystem::path& folder, const SceneRun& scene);   ///< uncertainty of the normals
FigureResult draw_fig9(const std::filesystem::path& folder, const SceneRun& scene);   ///< planes beside RANSAC's
FigureResult draw_fig10(const std::filesystem::path& folder, const SceneRun& scene);  ///< the map

}  // namespace planemap::experiments
