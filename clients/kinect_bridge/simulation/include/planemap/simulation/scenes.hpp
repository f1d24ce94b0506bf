#pragma once

#include <span>
#include <string_view>

namespace planemap::simulation {

/// A scene that can be rendered.
struct SceneInfo {
  std::string_view name;   ///< for SimulationConfig::scene
  std::string_view shows;  ///< in words, for people
};

/// All scenes: first the random apartment, then the special rooms. Each of these has a few surfaces that are hard to
/// tell apart, and a short tour that shows them.
std::span<const SceneInfo> scenes();

}  // namespace planemap::simulation
