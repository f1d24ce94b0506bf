// The drawings: ticks, order of planes, well-formed files.

#include <gtest/gtest.h>

#include <cstdlib>
#include <support/temporary_folder.hpp>

#include "figures/figures.hpp"
#include "picture/camera.hpp"
#include "picture/plane_picture.hpp"
#include "plot/chart.hpp"

namespace planemap::experiments {

using namespace plot;
namespace {

TEST(Ticks, AreRoundAndIncludeRoundEnds) {
  EXPECT_EQ(round_ticks(0.0, 40.0, 4), (std::vector<double>{0.0, 10.0, 20.0, 30.0, 40.0}));
  const auto ticks = round_ticks(0.03, 0.61, 5);
  ASSERT_EQ(ticks.size(), 3U);  // steps of 0.2
  EXPECT_DOUBLE_EQ(ticks[0], 0.2);
  EXPECT_DOUBLE_EQ(ticks[2], 0.6000000000000001);
  EXPECT_TRUE(round_ticks(1.0, 1.0).empty());
}

TEST(Ticks, AnAxisFromZeroEndsAtARoundNumberThatHoldsTheGreatest) {
  EXPECT_DOUBLE_EQ(axis_from_zero("", 23.0).to, 25.0);
  EXPECT_DOUBLE_EQ(axis_from_zero("", 25.0).to, 25.0);
  EXPECT_GT(axis_from_zero("", 0.0).to, 0.0);
}

TEST(Camera, UpIsUpAndNearerIsNearer) {
  const Camera camera(Eigen::Vector3d::UnitZ(), 0.3, 0.5);
  EXPECT_GT(camera.project(Eigen::Vector3d::UnitZ()).y(), 0.5);
  EXPECT_NEAR(camera.project(Eigen::Vector3d::UnitZ()).x(), 0.0, 1e-12);
  EXPECT_NEAR(camera.nearness(camera.towards()), 1.0, 1e-12);
  EXPECT_NEAR(camera.project(camera.towards()).norm(), 0.0, 1e-12);
}

/// A square about a point, seen from the normal's side.
PictureFace square(const Eigen::Vector3d& middle_m, const Eigen::Vector3d& normal, double edge_m) {
  const Plane plane = Plane::through(middle_m, normal);
  const PlaneBasis basis = basis_of(plane, middle_m);
  const double h = 0.5 * edge_m;
  return {plane, {basis, {{{{-h, -h}, {h, -h}, {h, h}, {-h, h}}, {}}}, edge_m * edge_m}, {}};
}

TEST(BackToFront, ATableIsDrawnAfterTheFloorAlthoughItIsFartherAway) {
  const Camera camera(Eigen::Vector3d::UnitZ(), 0.0, 0.6);
  // The table stands at the far end of the floor: its middle is farther from the viewer than the floor's.
  const Eigen::Vector3d away(-2.0 * camera.towards().x(), -2.0 * camera.towards().y(), 0.7);
  const std::vector<PictureFace> faces = {square(away, Eigen::Vector3d::UnitZ(), 1.0),
                                          square(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), 6.0)};
  ASSERT_LT(camera.nearness(away), camera.nearness(Eigen::Vector3d::Zero()));
  EXPECT_EQ(back_to_front(camera, faces), (std::vector<std::size_t>{1, 0}));
}

TEST(BackToFront, WhatTurnsAwayIsLeftOut) {
  const Camera camera(Eigen::Vector3d::UnitZ(), 0.0, 0.6);
  EXPECT_TRUE(back_to_front(camera, {square(Eigen::Vector3d::Zero(), -Eigen::Vector3d::UnitZ(), 1.0)}).empty());
}

TEST(SvgPage, TextIsEscaped) {
  SvgPage page(100.0, 100.0, "a < b & \"c\"", "");
  EXPECT_NE(page.svg().find("<title>a &lt; b &amp; &quot;c&quot;</title>"), std::string::npos);
}

TEST(SvgPage, AFolderThatIsNotThereIsSaid) {
  const SvgPage page(100.0, 100.0, "t", "");
  EXPECT_THROW(page.save("no/such/folder/x.svg"), std::runtime_error);
}

TEST(Figures, AreWellFormedAndSmall) {
  const TemporaryFolder folder;
  for (const auto draw : {draw_fig1, draw_fig2, draw_fig4, draw_fig5}) {
    const FigureResult result = draw(folder.path());
    ASSERT_EQ(result.files.size(), 1U);
    EXPECT_LT(std::filesystem::file_size(result.files[0]), 300000U);
    EXPECT_EQ(std::system(("xmllint --noout " + result.files[0].string()).c_str()), 0) << result.files[0];
  }
}

}  // namespace
}  // namespace planemap::experiments
