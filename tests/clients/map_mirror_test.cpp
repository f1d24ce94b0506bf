#include "map_mirror.hpp"

#include <gtest/gtest.h>

#include "fake_map_service.hpp"
#include "lcm/delta_collector.hpp"

namespace planemap::client {
namespace {

Plane plane_at(std::int64_t id, std::int64_t revision, const char* plane_class = "wall") {
  Plane plane;
  plane.id = id;
  plane.revision = revision;
  plane.plane_class = plane_class;
  return plane;
}

/// Planes 1, 2 and 5 of epoch 7 at revision 10.
MapMirror mirror_at_ten() {
  MapMirror mirror;
  mirror.replace({"world", 7, 10, {plane_at(5, 9), plane_at(1, 3), plane_at(2, 10)}, {}});
  return mirror;
}

std::vector<std::int64_t> ids_of(const Map& map) {
  std::vector<std::int64_t> ids;
  for (const Plane& plane : map.planes) ids.push_back(plane.id);
  return ids;
}

TEST(MapMirror, TheFirstMapIsNewAsAWhole) {
  MapMirror mirror;
  EXPECT_FALSE(mirror.has_map());
  const MapChange change = mirror.replace({"world", 7, 10, {plane_at(5, 9), plane_at(1, 3)}, {}});
  EXPECT_TRUE(change.new_map);
  EXPECT_TRUE(change.caught_up);
  EXPECT_EQ(change.since_revision, -1);
  EXPECT_EQ(change.added, (std::vector<std::int64_t>{1, 5}));
  EXPECT_EQ(ids_of(mirror.map()), (std::vector<std::int64_t>{1, 5}));
}

TEST(MapMirror, AWholeMapIsComparedWithWhatWasKnown) {
  MapMirror mirror = mirror_at_ten();
  const MapChange change = mirror.replace({"world", 7, 20, {plane_at(1, 3), plane_at(2, 15), plane_at(6, 20)}, {}});
  EXPECT_FALSE(change.new_map);
  EXPECT_TRUE(change.caught_up);
  EXPECT_EQ(change.since_revision, 10);
  EXPECT_EQ(change.added, (std::vector<std::int64_t>{6}));
  EXPECT_EQ(change.changed, (std::vector<std::int64_t>{2}));
  ASSERT_EQ(change.removed.size(), 1u);
  EXPECT_EQ(change.removed[0].id, 5);
}

TEST(MapMirror, OfAnotherEpochAllIsNew) {
  MapMirror mirror = mirror_at_ten();
  const MapChange change = mirror.replace({"world", 8, 1, {plane_at(1, 1)}, {}});
  EXPECT_TRUE(change.new_map);
  EXPECT_EQ(change.added, (std::vector<std::int64_t>{1}));
  EXPECT_TRUE(change.removed.empty()) << "ids of the other map";
}

TEST(MapMirror, TakesDeltasThatConnect) {
  const MapMirror mirror = mirror_at_ten();
  const auto fits = [&](std::int64_t epoch, std::int64_t since, std::int64_t revision) {
    return mirror.fits({epoch, since, revision, "world", {}, {}});
  };
  EXPECT_TRUE(fits(7, 10, 11));
  EXPECT_TRUE(fits(7, 8, 12)) << "it says again what is known, and more";
  EXPECT_TRUE(fits(7, 0, 12));
  EXPECT_FALSE(fits(7, 8, 10)) << "all of it is known";
  EXPECT_FALSE(fits(7, 11, 12)) << "something is missing between them";
  EXPECT_TRUE(fits(8, 0, 1)) << "a new map from its beginning";
  EXPECT_FALSE(fits(8, 3, 4));
  EXPECT_FALSE(fits(6, 0, 99)) << "of an old map, late";
}

TEST(MapMirror, ADeltaAddsChangesAndRemoves) {
  MapMirror mirror = mirror_at_ten();
  const MapChange change =
      mirror.apply({7, 8, 12, "world", {plane_at(3, 12), plane_at(1, 11), plane_at(2, 10)}, {{5, 1}, {77, 0}}});
  EXPECT_EQ(change.since_revision, 10);
  EXPECT_EQ(change.revision, 12);
  EXPECT_FALSE(change.caught_up);
  EXPECT_EQ(change.added, (std::vector<std::int64_t>{3}));
  EXPECT_EQ(change.changed, (std::vector<std::int64_t>{1})) << "plane 2 was known so";
  ASSERT_EQ(change.removed.size(), 1u) << "plane 77 came and went in between";
  EXPECT_EQ(change.removed[0].merged_into, 1);
  EXPECT_EQ(ids_of(mirror.map()), (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(mirror.map().revision, 12);
}

TEST(MapMirror, AClassThatChangesIsAChange) {
  MapMirror mirror = mirror_at_ten();
  const MapChange change = mirror.apply({7, 10, 11, "world", {plane_at(1, 3, "floor")}, {}});
  EXPECT_EQ(change.changed, (std::vector<std::int64_t>{1}));
  EXPECT_EQ(mirror.map().planes[0].plane_class, "floor");
}

TEST(MapMirror, ADeltaFromTheBeginningIsTheWholeMap) {
  MapMirror mirror = mirror_at_ten();
  const MapChange change = mirror.apply({7, 0, 12, "world", {plane_at(2, 10)}, {}});
  EXPECT_EQ(change.removed.size(), 2u);
  EXPECT_EQ(ids_of(mirror.map()), (std::vector<std::int64_t>{2}));
}

planemap_lcm::planes_t page(int number, int count, std::int64_t revision) {
  planemap_lcm::planes_t page{};
  page.epoch = 7;
  page.since_revision = 3;
  page.revision = revision;
  page.page = number;
  page.page_count = count;
  page.planes = {wire_plane(100 + number)};
  page.n_planes = 1;
  return page;
}

TEST(DeltaCollector, PagesMayComeInAnyOrderTwiceAndOfTwoDeltasAtOnce) {
  DeltaCollector collector;
  EXPECT_FALSE(collector.add(page(2, 3, 5)));
  EXPECT_FALSE(collector.add(page(0, 2, 6)));
  EXPECT_FALSE(collector.add(page(2, 3, 5)));
  EXPECT_FALSE(collector.add(page(0, 3, 5)));
  const auto second = collector.add(page(1, 2, 6));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->revision, 6);
  EXPECT_EQ(second->planes.size(), 2u);
  const auto first = collector.add(page(1, 3, 5));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->since_revision, 3);
  EXPECT_EQ(first->planes.size(), 3u);
}

TEST(DeltaCollector, GivesUpTheOldestOfMany) {
  DeltaCollector collector;
  for (std::int64_t revision = 10; revision < 19; ++revision) EXPECT_FALSE(collector.add(page(0, 2, revision)));
  EXPECT_FALSE(collector.add(page(1, 2, 10))) << "its first page was given up";
  EXPECT_TRUE(collector.add(page(1, 2, 18)));
}

}  // namespace
}  // namespace planemap::client
