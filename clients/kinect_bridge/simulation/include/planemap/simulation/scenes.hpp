#pragma once

#include <span>
#include <string_view>

namespace planemap::simulation {

/// A scene that can be rendered.
struct SceneInfo {
  std::string_view name;   ///< for SimulationConfig::scene
  std::string_view shows;  ///< in words, for people
};

/// The scene that has no end.
constexpr std::string_view kBuildingScene = "building";

/// All scenes: first the random apartment, then the special rooms, last the endless building. Each special room has a
/// few surfaces that are hard to tell apart, and a short tour that shows them.
std::span<const SceneInfo> scenes();
/// All but the building: all of their surfaces are known from the start.
std::span<const SceneInfo> scenes_with_an_end();

}  // namespace planemap::simulation
