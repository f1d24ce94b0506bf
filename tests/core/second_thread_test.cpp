// A second thread does some of the work; the map is the same to the last bit.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <planemap/mapper.hpp>
#include <planemap/second_thread.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "rooms.hpp"

namespace planemap {
namespace {

using Eigen::Vector3d;

/// As simple as it can be: a new thread for each work.
class NewThreads final : public SecondThread {
 public:
  void begin(void (*work)(void*), void* argument) override {
    ++begun;
    thread_ = std::jthread(work, argument);
  }
  void wait() override { thread_.join(); }

  int begun = 0;

 private:
  std::jthread thread_;
};

TEST(SecondThread, BothPartsAreDoneWithAndWithoutOne) {
  NewThreads second;
  for (SecondThread* which : {static_cast<SecondThread*>(nullptr), static_cast<SecondThread*>(&second)}) {
    int here = 0;
    int there = 0;
    do_both(
        which, [&] { here = 1; }, [&] { there = 2; });
    EXPECT_EQ(here + there, 3);
  }
  EXPECT_EQ(second.begun, 1);
}

TEST(SecondThread, WhatFailsHereWaitsForTheOtherPart) {
  NewThreads second;
  bool is_done = false;
  EXPECT_THROW(do_both(
                   &second, [] { throw std::runtime_error("no memory"); }, [&] { is_done = true; }),
               std::runtime_error);
  EXPECT_TRUE(is_done);
}

bool is_box(const Vector3d& p) {
  return std::abs(p.y()) < 0.4 && p.z() < 0.1;
}
std::vector<testing::Wall> room(bool with_box) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.3, Vector3d(0.1, 0.2, 1.0).normalized()).toRotationMatrix();
  std::vector<testing::Wall> walls = {{-R * Vector3d::UnitX(), 3.0},
                                      {R * Vector3d::UnitY(), 1.6},
                                      {-R * Vector3d::UnitY(), 1.6},
                                      {R * Vector3d::UnitZ(), 1.0}};
  if (with_box) walls.push_back({-R * Vector3d::UnitX(), 1.8, is_box});
  return walls;
}

/// Looks about in a room, from which a box is carried away: cells with two surfaces, planes that grow and merge, wear.
struct Result {
  std::size_t worn = 0;
  std::shared_ptr<const MapSnapshot> map;
};
Result map_room(SecondThread* second, bool as_clouds) {
  Mapper mapper(preset(Preset::kBest), 1, second);
  Result result;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Isometry3d T = testing::looking({-0.2, 0.01 * i, 0.3}, {2.0, std::sin(0.3 * i), -0.2});
    DepthScan scan = testing::render(room(i < 12), T, static_cast<std::uint64_t>(i), 1.0, 200, 150);
    scan.utime = 1'000'000 + 100'000 * i;
    result.worn += mapper.integrate(as_clouds ? Scan(testing::cloud_of(scan)) : Scan(scan), T).worn_cells;
  }
  result.map = mapper.snapshot();
  return result;
}

void expect_equal_bits(const double* a, const double* b, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i]));
}

class WithSecondThread : public ::testing::TestWithParam<bool> {};

TEST_P(WithSecondThread, TheMapIsTheSameToTheLastBit) {
  NewThreads second;
  const Result alone = map_room(nullptr, GetParam());
  const Result both = map_room(&second, GetParam());
  EXPECT_EQ(second.begun, 3 * 30);  // three times a scan
  EXPECT_EQ(both.worn, alone.worn);
  EXPECT_GT(alone.worn, 0U);
  EXPECT_EQ(both.map->revision(), alone.map->revision());
  ASSERT_GE(alone.map->planes().size(), 4U);
  ASSERT_EQ(both.map->planes().size(), alone.map->planes().size());
  for (std::size_t i = 0; i < alone.map->planes().size(); ++i) {
    const PlaneRecord& a = *alone.map->planes()[i];
    const PlaneRecord& b = *both.map->planes()[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.cell_count, b.cell_count);
    EXPECT_EQ(a.point_count, b.point_count);
    expect_equal_bits(a.covariance.data(), b.covariance.data(), 16);
    expect_equal_bits(a.plane.normal().data(), b.plane.normal().data(), 3);
  }
  std::vector<CellView> cells;
  alone.map->for_each_cell([&](const CellView& cell) { cells.push_back(cell); });
  std::size_t next = 0;
  both.map->for_each_cell([&](const CellView& cell) {
    ASSERT_LT(next, cells.size());
    const CellView& other = cells[next++];
    EXPECT_EQ(cell.plane_id, other.plane_id);
    EXPECT_EQ(cell.count, other.count);
    expect_equal_bits(cell.centre_m.data(), other.centre_m.data(), 3);
  });
  EXPECT_EQ(next, cells.size());
}

INSTANTIATE_TEST_SUITE_P(OfDepthImagesAndClouds, WithSecondThread, ::testing::Bool(),
                         [](const auto& which) { return which.param ? "Clouds" : "DepthImages"; });

}  // namespace
}  // namespace planemap
