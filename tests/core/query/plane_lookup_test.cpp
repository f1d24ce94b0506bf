#include "planemap/query/plane_lookup.hpp"

#include <gtest/gtest.h>

#include <planemap/coplanar.hpp>
#include <planemap/query/snapshot_queries.hpp>

#include "query/random_map.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;
using testing::described;
using testing::record_of;

/// Planes 2 and 17 in one line, 30 apart. 9 went into 17 by way of 12 (and 12 took 10, of which no snapshot told); 4
/// went into 5, which is gone.
testing::RandomMap map_with_a_past() {
  PlaneRecord two = record_of(2, {0.0, 0.0, 1.0}, Vector3d::UnitX(), 0.001, 0.003);
  PlaneRecord seventeen = record_of(17, {0.0, 2.0, 1.0}, Vector3d::UnitX(), 0.001, 0.001);
  PlaneRecord thirty = record_of(30, {1.0, 0.0, 0.0}, Vector3d::UnitZ(), 0.001, 0.001);
  seventeen.merged = {9, 10, 12};
  MapSnapshot::Parts parts;
  parts.revision = 50;
  parts.removed = {{9, 12, 20}, {4, 5, 21}, {12, 17, 30}, {5, kNoPlane, 40}};
  std::vector<DescribedPlane> planes;
  for (const PlaneRecord& record : {two, seventeen, thirty}) {
    planes.push_back(described(record, testing::rectangle(record, 1.0, 1.0), PlaneClass::kWall));
  }
  return testing::map_of(planes, std::move(parts));
}

PlaneLookup looked_up(PlaneId id) {
  const auto found = map_with_a_past().queries().plane(id);
  EXPECT_TRUE(found.has_value()) << found.error().message;
  EXPECT_EQ(found->asked, id);
  return *found;
}

TEST(PlaneLookup, TellsEverythingOfALivingPlane) {
  const PlaneLookup found = looked_up(2);
  EXPECT_EQ(found.fate, PlaneFate::kLives);
  EXPECT_EQ(found.lineage, std::vector<PlaneId>{2});
  EXPECT_FALSE(found.removed_revision.has_value());
  ASSERT_TRUE(found.details.has_value());
  EXPECT_EQ(found.details->plane.record->id, 2U);
  EXPECT_EQ(found.details->plane.plane_class, PlaneClass::kWall);
  EXPECT_EQ(found.details->plane.outline->polygons.size(), 1U);
  EXPECT_NEAR(found.details->normal_deviation_rad, 0.003, 1e-9);
  EXPECT_EQ(found.details->coplanar, std::vector<PlaneId>{17});
}

TEST(PlaneLookup, FollowsAMergedPlaneToWhatHoldsItNow) {
  const PlaneLookup found = looked_up(9);
  EXPECT_EQ(found.fate, PlaneFate::kMerged);
  EXPECT_EQ(found.lineage, (std::vector<PlaneId>{9, 12, 17}));
  EXPECT_EQ(found.removed_revision, 20U);
  ASSERT_TRUE(found.details.has_value());
  EXPECT_EQ(found.details->plane.record->id, 17U);
  EXPECT_EQ(found.details->coplanar, std::vector<PlaneId>{2});
}

TEST(PlaneLookup, KnowsMergersThatNoSnapshotTold) {
  const PlaneLookup found = looked_up(10);
  EXPECT_EQ(found.fate, PlaneFate::kMerged);
  EXPECT_EQ(found.lineage, (std::vector<PlaneId>{10, 17}));
  EXPECT_FALSE(found.removed_revision.has_value());
}

TEST(PlaneLookup, TellsWhatIsGoneFromWhatNeverWas) {
  const PlaneLookup gone = looked_up(4);
  EXPECT_EQ(gone.fate, PlaneFate::kGone);
  EXPECT_EQ(gone.lineage, (std::vector<PlaneId>{4, 5}));
  EXPECT_FALSE(gone.details.has_value());
  const PlaneLookup unknown = looked_up(99);
  EXPECT_EQ(unknown.fate, PlaneFate::kUnknown);
  EXPECT_TRUE(unknown.lineage.empty());
}

TEST(PlaneLookup, ZeroNamesNoPlane) {
  const auto found = map_with_a_past().queries().plane(0);
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().message, "id: must not be 0, which names no plane");
}

TEST(CoplanarWith, IsWhatAllLinksHaveForThePlane) {
  testing::Random random(51);
  std::vector<PlaneRecord> records;
  for (PlaneId id = 1; id <= 60; ++id) {
    const Vector3d normal(1.0, random.uniform(-0.01, 0.01), 0.0);
    records.push_back(record_of(id, {random.uniform(0.0, 0.02), random.uniform(0.0, 3.0), 0.0}, normal, 0.002, 0.002));
  }
  std::vector<SizedPlane> planes;
  for (const PlaneRecord& record : records) planes.push_back({&record, random.one_in(5) ? 0.1 : 1.0});
  CoplanarLinks links = coplanar_links(planes);
  std::size_t linked = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto with = coplanar_with(planes, i);
    EXPECT_EQ(with, links[records[i].id]);
    linked += with.size();
  }
  EXPECT_GT(linked, 100U);
}

}  // namespace
}  // namespace planemap
