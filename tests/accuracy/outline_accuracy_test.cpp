// Outlines of rendered surfaces beside what was seen of them: area within 5 %, borders within a cell and a half. That
// is asked of planes of which a piece 1.5 m wide at least was seen. Narrower ones lack the row of cells along an edge
// that the plane beside them took: half a cell on each side is 5 % of 1.6 m.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "outline_scoring.hpp"
#include "scene_run.hpp"

namespace planemap::accuracy {
namespace {

constexpr double kMostAreaError = 0.05;
constexpr double kReach_m = 0.12;  // a cell and a half

/// Below which all but a share of the values lie.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

bool follows(const OutlineScore& outline) {
  return std::abs(outline.area_error()) <= kMostAreaError && quantile(outline.border_m, 0.95) <= kReach_m &&
         quantile(outline.overreach_m, 0.99) <= kReach_m && quantile(outline.shortfall_m, 0.99) <= kReach_m;
}

void expect_wide_outlines_follow(const std::string& scene, std::uint64_t seed, std::size_t least_count) {
  RunConfig config;
  config.scene = scene;
  config.seed = seed;
  const MappedScene mapped = map_scene(config);
  std::size_t count = 0;
  for (const SurfaceScore& s : score(*mapped.map, mapped.seen).surfaces) {
    if (s.verdict != Verdict::kCorrect || s.outline.seen_width_m < OutlineErrors::kWide_m) continue;
    ++count;
    EXPECT_TRUE(follows(s.outline)) << s.name << ": area " << 100.0 * s.outline.area_error()
                                    << " %, 95 % of the border within " << quantile(s.outline.border_m, 0.95)
                                    << " m, 99 % reach over by " << quantile(s.outline.overreach_m, 0.99)
                                    << " m at most, fall short by " << quantile(s.outline.shortfall_m, 0.99) << " m";
  }
  EXPECT_GE(count, least_count);
}

TEST(Outlines, OfAnApartmentFollowWhatWasSeen) {
  expect_wide_outlines_follow("apartment", 24, 10);
}

TEST(Outlines, OfARoomWithAPillarFollowWhatWasSeen) {
  expect_wide_outlines_follow("pillar", 2001, 6);
}

TEST(Outlines, OfACorridorFollowWhatWasSeen) {
  expect_wide_outlines_follow("corridor", 2001, 5);
}

TEST(ScoreOutline, TellsOutlinesThatAreTooSmallOrTooLarge) {
  RunConfig config;
  config.scene = "pillar";
  config.seed = 2001;
  const MappedScene mapped = map_scene(config);
  const Score scored = score(*mapped.map, mapped.seen);
  const auto& all = mapped.seen.surfaces();
  const auto surface = std::find_if(all.begin(), all.end(), [](const auto& s) { return s.name == "wall 1"; });
  const auto found =
      std::find_if(scored.surfaces.begin(), scored.surfaces.end(), [](const auto& s) { return s.name == "wall 1"; });
  ASSERT_TRUE(surface != all.end() && found != scored.surfaces.end());
  ASSERT_TRUE(follows(found->outline));
  const PlaneRecord& plane = *mapped.map->find(found->plane);
  const std::vector<Eigen::Vector3d> centres_m = centres_of(*mapped.map, found->plane);
  const Eigen::Vector3d along = basis_of(plane.plane, plane.centroid_m).axis_u;
  const auto scored_with = [&](const std::vector<Eigen::Vector3d>& of_m) {
    const Outline outline = outline_of(plane.plane, plane.centroid_m, of_m, mapped.map->cell_size_m());
    return score_outline(outline, mapped.seen, static_cast<std::size_t>(surface - all.begin()));
  };
  const auto least = std::min_element(centres_m.begin(), centres_m.end(),
                                      [&](const auto& a, const auto& b) { return along.dot(a) < along.dot(b); });
  std::vector<Eigen::Vector3d> fewer_m;
  std::vector<Eigen::Vector3d> more_m = centres_m;
  for (const Eigen::Vector3d& p_m : centres_m) {
    if (along.dot(p_m - *least) > 0.5) {
      fewer_m.push_back(p_m);
    } else {
      more_m.emplace_back(p_m - 0.5 * along);
    }
  }
  const OutlineScore small = scored_with(fewer_m);
  EXPECT_LT(small.area_error(), -kMostAreaError);
  EXPECT_NEAR(quantile(small.shortfall_m, 1.0), 0.5, 0.1);
  EXPECT_FALSE(follows(small));
  const OutlineScore large = scored_with(more_m);
  EXPECT_GT(large.area_error(), kMostAreaError);
  EXPECT_NEAR(quantile(large.overreach_m, 1.0), 0.5, 0.1);
  EXPECT_FALSE(follows(large));
}

}  // namespace
}  // namespace planemap::accuracy
