// Special rooms: each has surfaces that a map must tell apart. In all of them no plane holds two surfaces, and none
// lies where there is no surface.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene_run.hpp"

namespace planemap::accuracy {
namespace {

constexpr double kNearM = 0.003;  // between planes
constexpr double kNearDeg = 0.5;

/// A room's map beside its truth.
class MappedRoom {
 public:
  MappedRoom(const std::string& name, std::uint64_t seed)
      : mapped_(map_scene(config_of(name, seed))), score_(score(*mapped_.map, mapped_.seen)) {}

  const Score& scored() const { return score_; }
  std::size_t frames_with(const std::string& surface) const {
    const auto& all = mapped_.seen.surfaces();
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.name == surface; });
    return found == all.end() ? 0 : mapped_.seen.frames(static_cast<std::size_t>(found - all.begin()));
  }
  /// The plane that holds a surface and nothing else. Throws, which fails the test, if there is none.
  const PlaneRecord& plane_of(const std::string& surface) const {
    for (const SurfaceScore& s : score_.surfaces) {
      if (s.name == surface && s.verdict == Verdict::kCorrect) return *mapped_.map->find(s.plane);
    }
    throw std::runtime_error("'" + surface + "' has no plane of its own\n" + text());
  }
  /// What became of each surface.
  std::string text() const {
    std::ostringstream out;
    for (const SurfaceScore& s : score_.surfaces) {
      out << "  " << s.name << ": " << s.seen_m2 << " m2, verdict " << name_of(s.verdict) << ", plane " << s.plane
          << ", overlap " << s.overlap << ", purity " << s.purity << "\n";
    }
    for (const PlaneId id : score_.noise) out << "  on no surface: plane " << id << "\n";
    return out.str();
  }

 private:
  static RunConfig config_of(const std::string& name, std::uint64_t seed) {
    RunConfig config;
    config.scene = name;
    config.seed = seed;
    return config;
  }

  MappedScene mapped_;
  Score score_;
};

/// Maps a room at three places in the world, and checks what all rooms have in common and then what it is for.
void for_each_place(const std::string& name, const std::function<void(const MappedRoom&)>& check) {
  for (const std::uint64_t seed : {2001, 2002, 2003}) {
    SCOPED_TRACE(name + ", seed " + std::to_string(seed));
    const MappedRoom room(name, seed);
    EXPECT_EQ(room.scored().count(Verdict::kUnderSegmented), 0U) << room.text();
    EXPECT_TRUE(room.scored().noise.empty()) << room.text();
    try {
      check(room);
    } catch (const std::runtime_error& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

double degrees_between(const PlaneRecord& a, const PlaneRecord& b) {
  const Eigen::Vector3d& m = a.plane.normal();
  const Eigen::Vector3d& n = b.plane.normal();
  return std::atan2(m.cross(n).norm(), m.dot(n)) * 180.0 / std::numbers::pi;
}

/// How far the middle of a plane's points lies before another plane, metres.
double before_m(const PlaneRecord& plane, const PlaneRecord& other) {
  return other.plane.signed_distance_m(plane.centroid_m);
}

TEST(SpecialRooms, DoorLeafAndItsWallAreTwoPlanesTenDegreesApart) {
  for_each_place("door-ajar", [](const MappedRoom& room) {
    const PlaneRecord& leaf = room.plane_of("door leaf 1 front");
    const PlaneRecord& wall = room.plane_of("wall 5");
    EXPECT_NE(leaf.id, wall.id);
    EXPECT_NEAR(degrees_between(leaf, wall), 10.0, kNearDeg);
  });
}

TEST(SpecialRooms, FacesOfAThinWallAreTwoPlanesTenCentimetresApart) {
  for_each_place("thin-walls", [](const MappedRoom& room) {
    for (const std::string wall : {"thin wall 1", "thin wall 2"}) {
      const PlaneRecord& left = room.plane_of(wall + " left side");
      const PlaneRecord& right = room.plane_of(wall + " right side");
      EXPECT_NEAR(degrees_between(left, right), 180.0, kNearDeg);
      EXPECT_NEAR(before_m(left, right), -0.10, kNearM);
      EXPECT_NEAR(before_m(right, left), -0.10, kNearM);
    }
  });
}

TEST(SpecialRooms, CabinetFrontsAreTheirOwnPlanesSixCentimetresBeforeTheWall) {
  for_each_place("cabinet-fronts", [](const MappedRoom& room) {
    const auto check = [&room](const char* front_name, const char* wall_name) {
      const PlaneRecord& front = room.plane_of(front_name);
      const PlaneRecord& wall = room.plane_of(wall_name);
      EXPECT_NEAR(degrees_between(front, wall), 0.0, kNearDeg);
      EXPECT_NEAR(before_m(front, wall), 0.06, kNearM);
    };
    check("tall cabinet 1 front", "wall 4");
    check("low cabinet 1 front", "wall 2");
  });
}

TEST(SpecialRooms, TopsAndUndersidesOfTwoTablesAreFourPlanes) {
  for_each_place("table-tops", [](const MappedRoom& room) {
    std::set<PlaneId> ids;
    for (const std::string table : {"table 1", "table 2"}) {
      const PlaneRecord& top = room.plane_of(table + " top");
      const PlaneRecord& underside = room.plane_of(table + " underside");
      EXPECT_NEAR(degrees_between(top, underside), 180.0, kNearDeg);
      EXPECT_NEAR(before_m(top, underside), -0.04, kNearM);
      ids.insert({top.id, underside.id});
    }
    EXPECT_EQ(ids.size(), 4U);
  });
}

TEST(SpecialRooms, EachTreadAndEachRiserIsItsOwnPlane) {
  for_each_place("stairs", [](const MappedRoom& room) {
    std::set<PlaneId> ids = {room.plane_of("floor").id};
    for (int i = 1; i <= 5; ++i) {
      const PlaneRecord& riser = room.plane_of("riser " + std::to_string(i));
      const PlaneRecord& tread = room.plane_of(i == 5 ? "landing" : "tread " + std::to_string(i));
      EXPECT_NEAR(before_m(tread, room.plane_of("floor")), 0.17 * i, kNearM);
      EXPECT_NEAR(degrees_between(riser, tread), 90.0, 1.5) << "strips of two cells' width";
      if (i > 1) {
        EXPECT_NEAR(before_m(riser, room.plane_of("riser " + std::to_string(i - 1))), -0.28, kNearM);
      }
      ids.insert({riser.id, tread.id});
    }
    EXPECT_EQ(ids.size(), 11U);
  });
}

TEST(SpecialRooms, RampAndTheFloorsThatItJoinsAreThreePlanes) {
  for_each_place("ramp", [](const MappedRoom& room) {
    const PlaneRecord& floor = room.plane_of("floor");
    const PlaneRecord& ramp = room.plane_of("ramp");
    const PlaneRecord& upper = room.plane_of("upper floor");
    EXPECT_EQ((std::set<PlaneId>{floor.id, ramp.id, upper.id}).size(), 3U);
    const double rise_deg = std::atan(1.0 / 12.0) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(degrees_between(ramp, floor), rise_deg, 0.2);
    EXPECT_NEAR(degrees_between(ramp, upper), rise_deg, 0.2);
    EXPECT_NEAR(before_m(upper, floor), 0.2, kNearM);
  });
}

TEST(SpecialRooms, PillarHasFourFacesAtRightAngles) {
  for_each_place("pillar", [](const MappedRoom& room) {
    const PlaneRecord& front = room.plane_of("pillar front");
    const PlaneRecord& back = room.plane_of("pillar back");
    const PlaneRecord& left = room.plane_of("pillar left side");
    const PlaneRecord& right = room.plane_of("pillar right side");
    for (const PlaneRecord* side : {&left, &right}) {
      EXPECT_NEAR(degrees_between(front, *side), 90.0, kNearDeg);
      EXPECT_NEAR(degrees_between(back, *side), 90.0, kNearDeg);
    }
    EXPECT_NEAR(before_m(front, back), -0.4, kNearM);
    EXPECT_NEAR(before_m(left, right), -0.4, kNearM);
  });
}

TEST(SpecialRooms, ARoundColumnIsNoPlaneAndHidesNone) {
  // That nothing wider than a facet lies on it is what all rooms have in common.
  for_each_place("column", [](const MappedRoom& room) {
    EXPECT_EQ(room.scored().count(Verdict::kCorrect), room.scored().surfaces.size()) << room.text();
  });
}

TEST(SpecialRooms, WallsOfACorridorAreOnePlaneEachThoughSeenAtGrazingAngles) {
  for_each_place("corridor", [](const MappedRoom& room) {
    const PlaneRecord& left = room.plane_of("wall 1");
    const PlaneRecord& right = room.plane_of("wall 2");
    EXPECT_NEAR(degrees_between(left, right), 180.0, 0.1);
    EXPECT_NEAR(before_m(left, right), 1.6, kNearM);
    EXPECT_NEAR(before_m(right, left), 1.6, kNearM);
  });
}

TEST(SpecialRooms, CeilingThatWasSeenInThreeFramesIsThere) {
  for_each_place("ceiling-glimpse", [](const MappedRoom& room) {
    ASSERT_EQ(room.frames_with("ceiling"), 3U);
    const PlaneRecord& ceiling = room.plane_of("ceiling");
    EXPECT_NEAR(degrees_between(ceiling, room.plane_of("floor")), 180.0, kNearDeg);
    EXPECT_NEAR(before_m(ceiling, room.plane_of("floor")), 2.6, kNearM);
  });
}

}  // namespace
}  // namespace planemap::accuracy
