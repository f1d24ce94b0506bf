#include <gtest/gtest.h>

#include <cstdlib>
#include <planemap/sources/depth_png.hpp>
#include <planemap/sources/open_folder.hpp>
#include <planemap/sources/seven_scenes_source.hpp>
#include <planemap/sources/tum_source.hpp>

#include "sources_test_files.hpp"
#include "support/temporary_folder.hpp"

namespace planemap::sources {
namespace {

namespace fs = std::filesystem;

const std::vector<std::uint16_t> kDepth = {0, 1, 258, 65535, 4660, 1000};  // 3 x 2
constexpr const char* kIntrinsics = "585 0 320\n0 586 240\n0 0 1\n";
constexpr const char* kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

std::map<std::string, std::size_t> counts(std::initializer_list<std::pair<const std::string, std::size_t>> list) {
  return {list};
}

TEST(DepthPng, ReadsWhatWasWritten) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", 3, 2, kDepth);
  const auto image = read_depth_png(folder / "a.png");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->depth, kDepth);
}

TEST(DepthPng, RefusesOtherImagesAndNamesTheFile) {
  const TemporaryFolder folder;
  write_png(folder / "eight.png", 3, 2, kDepth, 8);
  write_png(folder / "wide.png", kMaxImageSide + 1, 1, std::vector<std::uint16_t>(kMaxImageSide + 1, 7));
  write_png(folder / "whole.png", 3, 2, kDepth);
  folder.write("text.png", "no image at all");
  fs::copy_file(folder / "whole.png", folder / "cut.png");
  fs::resize_file(folder / "cut.png", fs::file_size(folder / "whole.png") - 20);
  for (const char* name : {"eight.png", "wide.png", "text.png", "cut.png", "missing.png"}) {
    const auto image = read_depth_png(folder / name);
    ASSERT_FALSE(image) << name;
    EXPECT_NE(image.error().message.find(name), std::string::npos) << image.error().message;
  }
  EXPECT_NE(read_depth_png(folder / "eight.png").error().message.find("16-bit"), std::string::npos);
}

TEST(DepthPng, RefusesDamagedBytes) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", 3, 2, kDepth);
  std::fstream file(folder / "a.png", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(fs::file_size(folder / "a.png")) - 20);  // within the pixels' checksum
  file.put('\x55').put('\x55').put('\x55');
  file.close();
  EXPECT_FALSE(read_depth_png(folder / "a.png"));
}

TEST(SevenScenes, GivesFramesInOrderWithTheirTimes) {
  const TemporaryFolder folder;
  folder.write("camera-intrinsics.txt", kIntrinsics);
  folder.write("gravity-direction.txt", "0 3 4\n");
  for (const char* number : {"000012", "000000", "000003"}) {
    write_png(folder / ("frame-" + std::string(number) + ".depth.png"), 3, 2, kDepth);
    folder.write("frame-" + std::string(number) + ".pose.txt", "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n");
  }
  auto source = open_folder(folder.path());
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->size(), 3u);
  EXPECT_TRUE((*source)->gravity_direction()->isApprox(Eigen::Vector3d(0.0, 0.6, 0.8)));
  std::vector<std::int64_t> utimes;
  while (const auto frame = (*source)->next()) {
    utimes.push_back(frame->scan.utime);
    EXPECT_EQ(frame->scan.depth, kDepth);
    EXPECT_EQ(frame->scan.intrinsics, (PinholeIntrinsics{3, 2, 585, 586, 320, 240}));
    EXPECT_DOUBLE_EQ(frame->scan.depth_scale_m, 0.001);
    EXPECT_TRUE((frame->T_world_sensor * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3)));
  }
  EXPECT_EQ(utimes, (std::vector<std::int64_t>{1'000'000, 1'100'000, 1'400'000}));
  EXPECT_TRUE((*source)->skipped().empty());
}

TEST(SevenScenes, SkipsWhatCannotBeUsedAndCountsWhy) {
  const TemporaryFolder folder;
  folder.write("camera-intrinsics.txt", kIntrinsics);
  const auto frame = [&folder](const std::string& number, const std::string& pose) {
    write_png(folder / ("frame-" + number + ".depth.png"), 3, 2, kDepth);
    if (!pose.empty()) folder.write("frame-" + number + ".pose.txt", pose);
  };
  frame("000000", kIdentity);
  frame("000001", "");
  frame("000002", "1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  frame("000003", "1 0 0 0\n0 1 0 0\n0 0 1.002 0\n0 0 0 1\n");  // not orthonormal
  frame("000004", "1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n");     // mirrored
  frame("000005", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n");      // scaled
  frame("000006", "1 0 0 0\n0 1 0 0\n");                        // cut short
  folder.write("frame-000007.pose.txt", kIdentity);             // no image
  folder.write("frame-000008.pose.txt", kIdentity);
  folder.write("frame-000008.depth.png", "\x89PNG\r\n\x1a\nrubbish");
  folder.write("frame-x.depth.png", "not a frame");
  auto source = SevenScenesSource::open(folder.path());
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->size(), 9u);
  EXPECT_TRUE((*source)->next());
  EXPECT_FALSE((*source)->next());
  EXPECT_EQ((*source)->skipped(), counts({{"depth image missing", 1},
                                          {"depth image unreadable", 1},
                                          {"pose file missing", 1},
                                          {"pose is no rigid transform", 5}}));
}

TEST(SevenScenes, MakesRoundedPosesOrthonormal) {
  const TemporaryFolder folder;
  folder.write("camera-intrinsics.txt", kIntrinsics);
  write_png(folder / "frame-000000.depth.png", 3, 2, kDepth);
  folder.write("frame-000000.pose.txt", "0.8 -0.6003 0 0\n0.6 0.8002 0 0\n0 0 1.0004 0\n0 0 0 1\n");
  auto source = SevenScenesSource::open(folder.path());
  ASSERT_TRUE(source);
  const auto frame = (*source)->next();
  ASSERT_TRUE(frame);
  const Eigen::Matrix3d rotation = frame->T_world_sensor.linear();
  EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(rotation.determinant(), 1.0, 1e-12);
  EXPECT_NEAR(rotation(0, 0), 0.8, 5e-4);
}

TEST(SevenScenes, AsksForIntrinsicsWhereThereAreNone) {
  const TemporaryFolder folder;
  write_png(folder / "frame-000000.depth.png", 3, 2, kDepth);
  folder.write("frame-000000.pose.txt", kIdentity);
  const auto refused = open_folder(folder.path());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("--intrinsics"), std::string::npos) << refused.error().message;
  FolderOptions options;
  options.camera = CameraParameters{500, 501, 310, 230};
  options.depth_scale_m = 0.01;
  auto source = open_folder(folder.path(), options);
  ASSERT_TRUE(source) << source.error().message;
  const auto frame = (*source)->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->scan.intrinsics, (PinholeIntrinsics{3, 2, 500, 501, 310, 230}));
  EXPECT_DOUBLE_EQ(frame->scan.depth_scale_m, 0.01);
}

TEST(OpenFolder, SaysWhatItLookedFor) {
  const TemporaryFolder folder;
  const auto empty = open_folder(folder.path());
  ASSERT_FALSE(empty);
  EXPECT_NE(empty.error().message.find("7-Scenes"), std::string::npos);
  EXPECT_NE(empty.error().message.find("groundtruth.txt"), std::string::npos);
  folder.write("file", "");
  EXPECT_FALSE(open_folder(folder / "file"));
  EXPECT_FALSE(open_folder(folder / "missing"));
}

TEST(CameraParameters, TakesFourNumbersWithPositiveFocalLengths) {
  ASSERT_TRUE(parse_camera_parameters("517.3,516.5,318.6,255.3"));
  EXPECT_EQ(*parse_camera_parameters("517.3,516.5,318.6,255.3"), (CameraParameters{517.3, 516.5, 318.6, 255.3}));
  for (const char* wrong : {"", "1,2,3", "1,2,3,4,5", "0,1,2,3", "1,-1,2,3", "a,1,2,3", "1,nan,2,3"}) {
    EXPECT_FALSE(parse_camera_parameters(wrong)) << wrong;
  }
}

/// A quarter turn about z in 40 ms, in steps of 10 ms; then nothing for a second.
void write_trajectory(const TemporaryFolder& folder) {
  folder.write("groundtruth.txt",
               "# timestamp tx ty tz qx qy qz qw\n"
               "10.0000 0 0 0 0 0 0 1\n"
               "10.0200 2 0 0 0 0 0.70710678 0.70710678\n"
               "nonsense\n"
               "11.0000 9 0 0 0 0 0 1\n"
               "12.0000 0 0 0 0.5 0 0 1\n"  // no unit quaternion
               "13.0000 0.4 0.");           // cut short
}

TEST(Tum, InterpolatesPosesAndSkipsFramesWithoutOne) {
  const TemporaryFolder folder;
  write_trajectory(folder);
  folder.write("depth.txt",
               "# timestamp filename\n"
               "10.005000 depth/a.png\n"
               "10.030000 depth/b.png\n"  // 10 ms after the last pose before the gap
               "10.500000 depth/a.png\n"  // in the gap
               "12.000000 depth/a.png\n"  // its pose is unusable
               "13.500000\n"
               "10.015000 depth/missing.png\n");
  write_png(folder / "depth/a.png", 3, 2, kDepth);
  write_png(folder / "depth/b.png", 3, 2, kDepth);
  auto source = TumSource::open(folder.path());
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->unreadable_pose_lines(), 3u);
  const auto first = (*source)->next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->scan.utime, 10'005'000);
  EXPECT_NEAR(first->T_world_sensor.translation().x(), 0.5, 1e-9);
  const double quarter_rad = 0.25 * 1.5707963267948966;
  EXPECT_NEAR((first->T_world_sensor.linear() * Eigen::Vector3d::UnitX()).y(), std::sin(quarter_rad), 1e-7);
  EXPECT_DOUBLE_EQ(first->scan.depth_scale_m, 1.0 / 5000.0);
  EXPECT_EQ(first->scan.intrinsics, (PinholeIntrinsics{3, 2, 525.0, 525.0, 319.5, 239.5}));
  const auto second = (*source)->next();
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->T_world_sensor.translation().x(), 2.0, 1e-12) << "the nearest: the next pose is far away";
  EXPECT_FALSE((*source)->next());
  EXPECT_EQ(
      (*source)->skipped(),
      counts({{"depth image missing", 1}, {"line of depth.txt unreadable", 1}, {"no pose near the frame's time", 2}}));
}

TEST(Tum, RefusesFoldersThatCannotWork) {
  const TemporaryFolder folder;
  folder.write("depth.txt", "# nothing\n");
  write_trajectory(folder);
  const auto no_images = open_folder(folder.path());
  ASSERT_FALSE(no_images);
  EXPECT_NE(no_images.error().message.find("depth.txt"), std::string::npos);
  folder.write("depth.txt", "10.0 a.png\n");
  folder.write("groundtruth.txt", "10.0 0 0");
  const auto no_poses = open_folder(folder.path());
  ASSERT_FALSE(no_poses);
  EXPECT_NE(no_poses.error().message.find("groundtruth.txt"), std::string::npos);
}

class RealData : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PLANEMAP_TEST_DATA");
    if (folder == nullptr) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set: no real data here";
    data_ = folder;
  }
  fs::path data_;
};

TEST_F(RealData, RedKitchenIsReadWhole) {
  auto source = open_folder(data_ / "redkitchen");
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_NEAR((*source)->gravity_direction()->norm(), 1.0, 1e-12);
  std::size_t frames = 0;
  std::int64_t last_utime = 0;
  while (const auto frame = (*source)->next()) {
    ++frames;
    EXPECT_EQ(frame->scan.depth.size(), 640u * 480u);
    EXPECT_GT(frame->scan.utime, last_utime);
    last_utime = frame->scan.utime;
  }
  EXPECT_EQ(frames, 300u);
  EXPECT_EQ(last_utime, 1'000'000 + 598 * 1'000'000LL / 30);
  EXPECT_TRUE((*source)->skipped().empty());
}

TEST_F(RealData, TumDeskCountsTheMissingFrames) {
  auto source = TumSource::open(data_ / "tum_fr1_desk_9");
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->unreadable_pose_lines(), 1u) << "the last line is cut short";
  std::size_t frames = 0;
  while ((*source)->next()) ++frames;
  EXPECT_EQ(frames, 9u);
  EXPECT_EQ((*source)->skipped(), counts({{"depth image missing", 586}}));
}

}  // namespace
}  // namespace planemap::sources
