// A mirrored map.
#include <vector>

#include "suite.hpp"

namespace planemap::client {
namespace {

TEST_P(MapClientSuite, AWatchTellsWhatChanges) {
  const auto watch = client_->watch();
  auto change = watch->next(kLong);
  ASSERT_TRUE(change) << change.error().message;
  EXPECT_TRUE(change->new_map);
  EXPECT_EQ(change->since_revision, -1);
  EXPECT_EQ(change->epoch, 1234);
  EXPECT_EQ(change->added.size(), 3u);
  EXPECT_EQ(watch->map().planes.size(), 3u);
  auto quiet = watch->next(kShort);
  ASSERT_TRUE(quiet) << quiet.error().message;
  EXPECT_TRUE(quiet->empty());

  std::vector<std::int64_t> walls;
  for (const Plane& plane : watch->map().planes) {
    if (plane.plane_class == "wall") walls.push_back(plane.id);
  }
  ASSERT_EQ(walls.size(), 2u);
  room_.join_walls();
  const auto revision = static_cast<std::int64_t>(room_.service().snapshot()->revision());
  std::vector<std::int64_t> changed;
  std::vector<std::int64_t> removed;
  while (watch->map().revision < revision) {
    const std::int64_t before = watch->map().revision;
    change = watch->next(kLong);
    ASSERT_TRUE(change) << change.error().message;
    EXPECT_EQ(change->since_revision, before);
    EXPECT_FALSE(change->new_map);
    for (const std::int64_t id : change->changed) changed.push_back(id);
    for (const auto& gone : change->removed) removed.push_back(gone.id);
  }
  EXPECT_EQ(changed, (std::vector<std::int64_t>{walls[0]}));
  EXPECT_EQ(removed, (std::vector<std::int64_t>{walls[1]}));
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map);
  ASSERT_EQ(watch->map().planes.size(), map->planes.size());
  for (std::size_t i = 0; i < map->planes.size(); ++i) {
    EXPECT_EQ(watch->map().planes[i].id, map->planes[i].id);
    EXPECT_EQ(watch->map().planes[i].revision, map->planes[i].revision);
    EXPECT_EQ(watch->map().planes[i].polygons.size(), map->planes[i].polygons.size());
  }
}

}  // namespace
}  // namespace planemap::client
