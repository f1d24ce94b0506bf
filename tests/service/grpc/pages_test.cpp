// Answers in pages and deltas, on maps that are made up: more than goes into one message.

#include "serve/grpc/pages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <planemap/block.hpp>
#include <set>

#include "codec/proto_answer_codec.hpp"
#include "serve/grpc/delta_pages.hpp"
#include "serve/grpc/map_pages.hpp"
#include "serve/worker_pool.hpp"

namespace planemap::service {
namespace {

std::shared_ptr<const PlaneRecord> record(PlaneId id, std::uint64_t revision) {
  auto record = std::make_shared<PlaneRecord>();
  record->id = id;
  record->revision = revision;
  record->plane = Plane::through({0.0, 0.0, 0.1 * static_cast<double>(id)}, Eigen::Vector3d::UnitZ());
  record->covariance = 1e-6 * Eigen::Matrix4d::Ones();
  return record;
}

/// @param planes  with the ids 1, 2, ...
std::shared_ptr<const MapIndex> index_of(std::size_t planes, std::uint64_t revision, int blocks = 0,
                                         const MapIndex* previous = nullptr) {
  MapSnapshot::Parts parts;
  parts.epoch = 7;
  parts.revision = revision;
  parts.cell_size_m = 0.1;
  parts.density_threshold = 3;
  for (PlaneId id = 1; id <= planes; ++id) parts.planes.push_back(record(id, revision));
  for (int i = 0; i < blocks; ++i) {
    auto block = std::make_shared<Block>(BlockIndex(i, 0, 0));
    for (int place = 0; place < kBlockCells; ++place) {
      Cell& cell = block->cell(static_cast<std::size_t>(block->find_or_add(place)));
      cell.sums.count = place % 2 == 0 ? 100.0 : 1.0;  // half of them dense
      cell.normal = Eigen::Vector3f::UnitZ();
    }
    parts.blocks.push_back(std::move(block));
  }
  return std::make_shared<const MapIndex>(std::make_shared<const MapSnapshot>(std::move(parts)), std::nullopt,
                                          previous);
}

FilterMatch everything(const MapIndex& index) {
  return index.queries().matching({}).value();
}

template <class Page>
std::vector<Page> all_pages(const std::function<bool(Page&)>& next) {
  std::vector<Page> pages(1);
  while (!next(pages.back())) pages.emplace_back();
  for (std::size_t i = 0; i < pages.size(); ++i) {
    EXPECT_LE(pages[i].ByteSizeLong(), kMaxMessageBytes);
    EXPECT_EQ(pages[i].page(), i);
    EXPECT_EQ(pages[i].last(), i + 1 == pages.size());
    EXPECT_EQ(pages[i].map().epoch(), 7u);
  }
  return pages;
}

TEST(Pages, OfASnapshotHoldEveryPlaneOnce) {
  const auto index = index_of(24000, 5);
  const auto pages = all_pages(snapshot_pages(index, "world", everything(*index)));
  EXPECT_GT(pages.size(), 2u);
  PlaneId next = 1;
  for (const auto& page : pages) {
    EXPECT_GT(page.ByteSizeLong(), page.last() ? 0 : kMaxMessageBytes * 9 / 10);  // none is sent half empty
    for (const auto& plane : page.planes()) EXPECT_EQ(plane.id(), next++);
  }
  EXPECT_EQ(next, 24001u);
}

TEST(Pages, OfAnEmptyMapAreOne) {
  const auto index = index_of(0, 0);
  EXPECT_EQ(all_pages(snapshot_pages(index, "world", everything(*index))).size(), 1u);
  EXPECT_EQ(all_pages(cells_pages(index, "world", everything(*index))).size(), 1u);
  EXPECT_EQ(all_pages(region_pages(index, {})).size(), 1u);
}

TEST(Pages, OfCellsHoldEveryDenseCellOnce) {
  const auto index = index_of(0, 5, /*blocks=*/200);
  const auto pages = all_pages(cells_pages(index, "world", everything(*index)));
  EXPECT_GT(pages.size(), 2u);
  std::set<std::tuple<int, int, int>> places;
  int cells = 0;
  for (const auto& page : pages) {
    for (const auto& cell : page.cells()) {
      ++cells;
      places.insert({cell.index_x(), cell.index_y(), cell.index_z()});
    }
  }
  EXPECT_EQ(cells, 200 * kBlockCells / 2);
  EXPECT_EQ(places.size(), static_cast<std::size_t>(cells));
}

TEST(Pages, OfARegionHoldPlanesThenCells) {
  const auto index = index_of(3, 5, /*blocks=*/200);
  RegionContents contents;
  for (const auto& plane : index->queries().planes()) contents.planes.push_back({plane, true, {}, 0.0});
  index->snapshot().for_each_cell([&](const CellView& cell) { contents.cells.push_back(cell); });
  const auto pages = all_pages(region_pages(index, contents));
  EXPECT_GT(pages.size(), 2u);
  EXPECT_EQ(pages[0].planes_size(), 3);
  std::size_t cells = 0;
  for (const auto& page : pages) cells += static_cast<std::size_t>(page.cells_size());
  EXPECT_EQ(cells, contents.cells.size());
}

TEST(Pages, APlaneThatFitsInNoneIsCut) {
  v1::Plane plane;
  for (int i = 0; i < 8; ++i) {
    auto& polygon = *plane.mutable_outline()->add_polygons();
    for (int corner = 0; corner < 1000; ++corner) polygon.mutable_outer()->add_uv_m(1.0F);
  }
  v1::Plane whole = plane;
  EXPECT_FALSE(cut_to_fit(whole, 40000));
  EXPECT_EQ(whole.outline().polygons_size(), 8);
  EXPECT_TRUE(cut_to_fit(plane, 10000));
  EXPECT_EQ(plane.outline().polygons_size(), 2);  // the largest come first
  EXPECT_LE(plane.ByteSizeLong(), 10000u);
}

TEST(Deltas, TooLargeForOneMessageComeInPages) {
  const auto before = index_of(0, 1);
  const auto index = index_of(24000, 5, 0, before.get());
  DeltaPages deltas;
  const auto events = deltas.between({7, 1, true}, index);
  ASSERT_NE(events, nullptr);
  ASSERT_GT(events->size(), 2u);
  PlaneId next = 1;
  for (std::size_t i = 0; i < events->size(); ++i) {
    const auto& event = (*events)[i];
    EXPECT_LE(event.ByteSizeLong(), kMaxMessageBytes);
    EXPECT_EQ(event.delta().since_revision(), 1u);
    EXPECT_EQ(event.delta().page(), i);
    EXPECT_EQ(event.delta().last(), i + 1 == events->size());
    for (const auto& plane : event.delta().changed()) EXPECT_EQ(plane.id(), next++);
  }
  EXPECT_EQ(next, 24001u);
  EXPECT_EQ(deltas.between({7, 1, true}, index), events) << "made once for all who stand there";
  EXPECT_EQ(deltas.between({7, 5, true}, index), nullptr) << "nothing has changed";
}

TEST(Deltas, OfARevisionTooOldAskForASnapshot) {
  MapSnapshot::Parts parts;
  parts.epoch = 7;
  parts.revision = 9;
  parts.cell_size_m = 0.1;
  parts.removed_complete_since = 5;
  const auto index =
      std::make_shared<const MapIndex>(std::make_shared<const MapSnapshot>(std::move(parts)), std::nullopt, nullptr);
  DeltaPages deltas;
  const auto events = deltas.between({7, 4, false}, index);
  ASSERT_NE(events, nullptr);
  EXPECT_EQ(events->front().snapshot_needed().reason(), v1::SnapshotNeeded::REASON_REVISION_TOO_OLD);
  EXPECT_EQ(events->front().snapshot_needed().message(),
            "what was removed since revision 4 is not known any more; take a snapshot");
}

/// Two planes that face up: the lower one is large, so it is the floor, and with it the upper one, which is little
/// higher. Once the lower one has gone the upper one is a table, though its record stays as it is.
TEST(Deltas, TellAClassThatChangesWithAnotherPlane) {
  const auto lower = record(1, 1);
  auto step = std::make_shared<PlaneRecord>(*record(2, 1));
  step->centroid_m.z() = 0.2;
  const auto make = [&](bool with_lower, std::uint64_t revision, const MapIndex* previous) {
    MapSnapshot::Parts parts;
    parts.epoch = 7;
    parts.revision = revision;
    parts.cell_size_m = 0.1;
    parts.density_threshold = 3;
    auto block = std::make_shared<Block>(BlockIndex(0, 0, 0));
    for (int place = 0; place < kBlockEdge * kBlockEdge; ++place) {  // 0.64 m2
      Cell& cell = block->cell(static_cast<std::size_t>(block->find_or_add(place)));
      cell.sums.count = 100.0;
      cell.plane = static_cast<PlaneSlot>(lower->id);
    }
    if (with_lower) {
      parts.blocks.push_back(std::move(block));
      parts.planes.push_back(lower);
    } else {
      parts.removed.push_back({lower->id, kNoPlane, revision});
    }
    parts.planes.push_back(step);
    return std::make_shared<const MapIndex>(std::make_shared<const MapSnapshot>(std::move(parts)),
                                            Eigen::Vector3d(0.0, 0.0, -1.0), previous);
  };
  const auto both = make(true, 1, nullptr);
  const auto one = make(false, 2, both.get());
  const auto later = make(false, 3, one.get());
  ASSERT_EQ(both->queries().planes()[1].plane_class, PlaneClass::kFloor);
  ASSERT_EQ(one->queries().planes()[0].plane_class, PlaneClass::kTable);
  DeltaPages deltas;
  const auto events = deltas.between({7, 1, true}, one);
  ASSERT_NE(events, nullptr);
  ASSERT_EQ(events->front().delta().changed_size(), 1);
  EXPECT_EQ(events->front().delta().changed(0).plane_class(), v1::PLANE_CLASS_TABLE);
  EXPECT_EQ(events->front().delta().removed_size(), 1);
  // Whoever missed that revision hears of it, whoever did not does not hear it again.
  EXPECT_EQ(deltas.between({7, 1, true}, later)->front().delta().changed_size(), 1);
  EXPECT_EQ(deltas.between({7, 2, true}, later)->front().delta().changed_size(), 0);
}

TEST(WorkerPool, RefusesWhatFindsNoRoomAndDoesTheRest) {
  std::promise<void> begun;
  std::promise<void> may_end;
  int done = 0;
  {
    WorkerPool pool(1, 2);
    ASSERT_TRUE(pool.try_post([&] {
      begun.set_value();
      may_end.get_future().wait();
    }));
    begun.get_future().wait();
    EXPECT_TRUE(pool.try_post([&] { ++done; }));
    EXPECT_TRUE(pool.try_post([&] { ++done; }));
    EXPECT_FALSE(pool.try_post([&] { ++done; }));
    pool.post([&] { ++done; });  // a next step always finds room
    may_end.set_value();
  }
  EXPECT_EQ(done, 3);
}

}  // namespace
}  // namespace planemap::service
