#include <algorithm>
#include <array>
#include <planemap/simulation/scenes.hpp>
#include <stdexcept>
#include <string>

#include "rooms/rooms.hpp"
#include "scene.hpp"

namespace planemap::simulation {
namespace {

using MakeScene = Scene (*)(Random&);

constexpr std::array kScenes = {
    SceneInfo{"apartment", "four or five furnished rooms, another one for each seed"},
    SceneInfo{"door-ajar", "a door's leaf that makes 10 degrees with its wall"},
    SceneInfo{"thin-walls", "walls of 10 cm, seen from both sides"},
    SceneInfo{"cabinet-fronts", "fronts 6 cm before the wall"},
    SceneInfo{"table-tops", "two tables of one height, tops 4 cm thick, seen from above and from below"},
    SceneInfo{"stairs", "five steps of 17 cm by 28 cm"},
    SceneInfo{"ramp", "a rise of 1 in 12 between two floors"},
    SceneInfo{"pillar", "a square pillar of 40 cm"},
    SceneInfo{"column", "a round column of 40 cm, which is no plane"},
    SceneInfo{"corridor", "long walls that are seen at grazing angles alone"},
    SceneInfo{"ceiling-glimpse", "a ceiling that is seen in three frames"},
    SceneInfo{kBuildingScene, "corridors and furnished rooms without end, another one for each seed"},
};
constexpr std::array<MakeScene, kScenes.size() - 1> kMakers = {
    make_apartment_scene, make_door_ajar, make_thin_walls, make_cabinet_fronts, make_table_tops, make_stairs, make_ramp,
    make_pillar,          make_column,    make_corridor,   make_ceiling_glimpse};

}  // namespace

std::span<const SceneInfo> scenes() {
  return kScenes;
}

std::span<const SceneInfo> scenes_with_an_end() {
  return std::span(kScenes).first(kMakers.size());
}

Scene make_scene(std::string_view name, Random& random) {
  const auto all = scenes_with_an_end();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SceneInfo& scene) { return scene.name == name; });
  if (found == all.end()) throw std::invalid_argument("SimulationConfig: no scene '" + std::string(name) + "'");
  return kMakers[static_cast<std::size_t>(found - all.begin())](random);
}

}  // namespace planemap::simulation
