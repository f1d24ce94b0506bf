#include <gtest/gtest.h>

#include <functional>
#include <planemap/block.hpp>
#include <planemap/mapper.hpp>

#include "rooms.hpp"

namespace planemap {
namespace {

using testing::looking;
using testing::render;

/// A look around the room, one scan a step.
void look(Mapper& mapper, int step) {
  testing::look(mapper, step, /*turn_rad=*/0.1);
}

Mapper mapped(int scans, const MapperConfig& config = {}) {
  Mapper mapper(config, 77);
  for (int i = 0; i < scans; ++i) {
    look(mapper, i);
    (void)mapper.snapshot();
  }
  return mapper;
}

void expect_same_planes(const MapSnapshot& a, const MapSnapshot& b, double tolerance) {
  ASSERT_EQ(a.planes().size(), b.planes().size());
  ASSERT_GE(a.planes().size(), 3u);
  for (std::size_t i = 0; i < a.planes().size(); ++i) {
    const PlaneRecord& p = *a.planes()[i];
    const PlaneRecord& q = *b.planes()[i];
    EXPECT_EQ(p.id, q.id);
    EXPECT_EQ(p.revision, q.revision);
    EXPECT_EQ(p.cell_count, q.cell_count);
    EXPECT_EQ(p.point_count, q.point_count);
    EXPECT_LE((p.plane.normal() - q.plane.normal()).norm(), tolerance);
    EXPECT_LE(std::abs(p.plane.d() - q.plane.d()), tolerance);
    EXPECT_LE((p.covariance - q.covariance).norm(), tolerance * p.covariance.norm());
  }
}

/// The error when one part of a good map is changed.
std::string complaint_of(const std::function<void(MapSnapshot::Parts&)>& change, const MapperConfig& config = {}) {
  Mapper mapper = mapped(4);
  const auto good = mapper.snapshot();
  MapSnapshot::Parts parts;
  parts.epoch = good->epoch();
  parts.revision = good->revision();
  parts.cell_size_m = good->cell_size_m();
  parts.planes.assign(good->planes().begin(), good->planes().end());
  for (const auto& block : good->blocks()) parts.blocks.push_back(block);
  parts.state = good->state();
  change(parts);
  const auto restored = Mapper::restore(config, MapSnapshot(std::move(parts)));
  return restored ? "" : restored.error().message;
}

std::shared_ptr<Block> copy_of(const MapSnapshot::Parts& parts, std::size_t block) {
  return std::make_shared<Block>(*parts.blocks[block]);
}

/// A cell that carries the label of a plane.
std::pair<std::size_t, std::size_t> labelled_cell(const MapSnapshot::Parts& parts) {
  for (std::size_t b = 0; b < parts.blocks.size(); ++b) {
    for (std::size_t i = 0; i < parts.blocks[b]->size(); ++i) {
      if (parts.blocks[b]->cell(i).plane != kNoSlot) return {b, i};
    }
  }
  throw std::runtime_error("no cell carries a label");
}

TEST(MapperRestore, HasTheSamePlanesToTheBit) {
  Mapper first = mapped(8);
  const auto before = first.snapshot();
  auto second = Mapper::restore({}, *before);
  ASSERT_TRUE(second) << second.error().message;
  const auto after = second->snapshot();
  expect_same_planes(*before, *after, 0.0);
  EXPECT_EQ(after->epoch(), 77u);
  EXPECT_EQ(after->revision(), before->revision());
  EXPECT_EQ(after->utime(), before->utime());
  EXPECT_EQ(after->cell_count(), before->cell_count());
  EXPECT_EQ(after->block_count(), before->block_count());
}

TEST(MapperRestore, GoesOnAsIfNeverStopped) {
  MapperConfig config;
  config.pose_error = {0.002, 0.001, 10.0};  // so that the evidence of poses counts, too
  Mapper first = mapped(8, config);
  auto second = Mapper::restore(config, *first.snapshot());
  ASSERT_TRUE(second) << second.error().message;
  for (int i = 8; i < 16; ++i) {
    look(first, i);
    look(*second, i);
    expect_same_planes(*first.snapshot(), *second->snapshot(), 1e-9);
  }
}

TEST(MapperRestore, NewPlanesGetIdsBehindTheReservedOnes) {
  Mapper first(MapperConfig{}, 1);
  const auto T = looking({0, 0, 1.2}, {1.5, 0, 0});
  first.integrate(render({testing::small_room()[0]}, T, 1), T);
  MapSnapshot::Parts parts;
  const auto snapshot = first.snapshot();
  parts.cell_size_m = snapshot->cell_size_m();
  parts.planes.assign(snapshot->planes().begin(), snapshot->planes().end());
  for (const auto& block : snapshot->blocks()) parts.blocks.push_back(block);
  parts.state = snapshot->state();
  parts.state.next_plane_id = 1000;
  parts.revision = 5000;
  auto second = Mapper::restore({}, MapSnapshot(std::move(parts)));
  ASSERT_TRUE(second) << second.error().message;
  const auto T2 = looking({0, 0, 1.2}, {-1.0, 0, 1.2});
  second->integrate(render({{{1, 0, 0}, 2.0}}, T2, 2), T2);
  const auto after = second->snapshot();
  ASSERT_EQ(after->planes().size(), 2u);
  EXPECT_EQ(after->planes()[1]->id, 1000u);
  EXPECT_GT(after->planes()[1]->revision, 5000u);
}

TEST(MapperRestore, SaysWhatIsWrongWithAMap) {
  EXPECT_EQ(complaint_of([](auto&) {}), "");
  MapperConfig other;
  other.grid.cell_size_m = 0.05;
  EXPECT_NE(complaint_of([](auto&) {}, other).find("grid.cell_size_m"), std::string::npos);
  EXPECT_NE(complaint_of([](auto& p) { p.blocks.push_back(p.blocks[0]); }).find("is there twice"), std::string::npos);
  EXPECT_NE(complaint_of([](auto& p) { p.revision = 1ULL << 53; }).find("out of range"), std::string::npos);
  EXPECT_NE(complaint_of([](auto& p) { p.state.next_plane_id = 1; }).find("the id was never given"), std::string::npos);
  EXPECT_NE(complaint_of([](auto& p) { p.planes.pop_back(); }).find("which is not there"), std::string::npos);
  EXPECT_NE(complaint_of([](auto& p) { std::swap(p.planes[0], p.planes[1]); }).find("order of their ids"),
            std::string::npos);
  EXPECT_NE(complaint_of([](auto& p) {
              auto record = std::make_shared<PlaneRecord>(*p.planes[0]);
              record->state.reset();
              p.planes[0] = record;
            }).find("is missing"),
            std::string::npos);
  EXPECT_NE(complaint_of([](auto& p) {
              auto record = std::make_shared<PlaneRecord>(*p.planes[0]);
              record->covariance(1, 2) = std::nan("");
              p.planes[0] = record;
            }).find("not finite"),
            std::string::npos);
}

TEST(MapperRestore, SaysWhatIsWrongWithACell) {
  const auto with_cell = [](const std::function<void(Cell&)>& change) {
    return complaint_of([&](MapSnapshot::Parts& p) {
      const auto [b, i] = labelled_cell(p);
      const auto block = copy_of(p, b);
      change(block->cell(i));
      p.blocks.set(b, block);
    });
  };
  EXPECT_NE(with_cell([](Cell& c) { c.evidence.second[2] = INFINITY; }).find("not finite"), std::string::npos);
  EXPECT_NE(with_cell([](Cell& c) { c.sums.count = -1.0; }).find("negative count"), std::string::npos);
  EXPECT_NE(with_cell([](Cell& c) { c.plane_weight = 2.0F; }).find("more than all"), std::string::npos);
  EXPECT_NE(with_cell([](Cell& c) { c.normal = {3.0F, 0.0F, 0.0F}; }).find("no unit vector"), std::string::npos);
  EXPECT_NE(with_cell([](Cell& c) { c.plane = kNoSlot; }).find("carry its label"), std::string::npos);
  EXPECT_NE(with_cell([](Cell& c) { c.working = 3; }).find("at work"), std::string::npos);
}

}  // namespace
}  // namespace planemap
