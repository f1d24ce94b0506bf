// Depth images of other stacks: what comes out of the good ones, and what is said of the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "codec/scan_codec.hpp"
#include "formats/field_formats.hpp"
#include "formats/pixels.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

using kinect_bridge::DrakePixels;
using kinect_bridge::Encoding;
using kinect_bridge::to_image;
using kinect_bridge::to_image_array;
using kinect_bridge::to_images;
using kinect_bridge::to_kinect_disparity;
using kinect_bridge::to_kinect_frame;

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr std::int64_t kUtime = 1'700'000'000'000'000;

/// 16 x 12 pixels, each of another depth, some of them none.
DepthScan test_scan() {
  DepthScan scan;
  scan.utime = kUtime;
  scan.intrinsics = {16, 12, 15.0, 14.0, 7.5, 5.5};
  for (int i = 0; i < 16 * 12; ++i) scan.depth.push_back(static_cast<std::uint16_t>(i % 17 == 0 ? 0 : 500 + 37 * i));
  return scan;
}

ScanFormat test_format() {
  ScanFormat format;
  format.intrinsics = PinholeIntrinsics{0, 0, 15.0, 14.0, 7.5, 5.5};
  return format;
}

template <class Message>
Decoded<DecodedScan> decoded(const Message& message, const ScanFormat& format = test_format(),
                             std::size_t max_bytes = kMaxBytes) {
  return decode_scan(encoded(message), max_bytes, format);
}

/// The reason and the message of a rejection, for comparison with both.
template <class Message>
void expect_rejected(const Message& message, const std::string& reason, const std::string& text,
                     const ScanFormat& format = test_format(), std::size_t max_bytes = kMaxBytes) {
  const auto scan = decoded(message, format, max_bytes);
  ASSERT_FALSE(scan) << text;
  EXPECT_EQ(scan.error().reason, reason) << scan.error().message;
  EXPECT_NE(scan.error().message.find(text), std::string::npos) << scan.error().message;
}

template <class Message>
void expect_the_test_scan(const Message& message) {
  const auto result = decoded(message);
  ASSERT_TRUE(result) << result.error().message;
  const auto& scan = std::get<DepthScan>(result->scan);
  const DepthScan expected = test_scan();
  EXPECT_EQ(scan.utime, expected.utime);
  EXPECT_EQ(scan.intrinsics, expected.intrinsics);
  EXPECT_EQ(scan.depth_scale_m, 0.001);
  EXPECT_EQ(scan.depth, expected.depth);
}

TEST(FieldImages, EveryFamilyGivesTheSameIntegers) {
  for (const Encoding encoding : {Encoding::kRaw, Encoding::kZlib}) {
    expect_the_test_scan(to_kinect_frame(test_scan(), encoding));
    expect_the_test_scan(to_images(test_scan(), encoding));
    expect_the_test_scan(to_image_array(test_scan(), DrakePixels::kUint16, encoding));
    expect_the_test_scan(to_image_array(test_scan(), DrakePixels::kFloat32, encoding));
  }
  expect_the_test_scan(to_image(test_scan()));
  expect_the_test_scan(to_image_array(test_scan(), DrakePixels::kUint16, Encoding::kPng));
}

TEST(FieldImages, FloatsAreRoundedToTheUnitAndWhatIsNoDepthIsNone) {
  auto message = to_image_array(test_scan(), DrakePixels::kFloat32, Encoding::kRaw);
  const float infinity = std::numeric_limits<float>::infinity();
  const float values[] = {std::nanf(""), infinity, -infinity, -1.0F, 0.0F, 1.00026F, 13.2F, 1e30F, 13.1068F, 1e-9F};
  auto& data = message.images[1].data;
  for (std::size_t i = 0; i < std::size(values); ++i) std::memcpy(&data[4 * i], &values[i], 4);
  auto format = test_format();
  format.depth_unit_m = 0.0002;
  const auto result = decoded(message, format);
  ASSERT_TRUE(result) << result.error().message;
  const auto& scan = std::get<DepthScan>(result->scan);
  EXPECT_EQ(scan.depth_scale_m, 0.0002);
  const std::vector<std::uint16_t> first(scan.depth.begin(), scan.depth.begin() + std::size(values));
  EXPECT_EQ(first, (std::vector<std::uint16_t>{0, 0, 0, 0, 0, 5001, 0, 0, 65534, 0}));
}

TEST(FieldImages, DisparityBecomesDepthByTheCalibration) {
  auto message = to_kinect_frame(test_scan(), Encoding::kRaw);
  message.depth.depth_data_format = kinect::depth_msg_t::DEPTH_11BIT;
  std::vector<std::uint16_t> disparities(16 * 12, 2047);
  disparities[0] = 500;
  disparities[1] = 1000;
  disparities[2] = 1089;  // 8 * 575.8 * 0.075 / 0.5 = 690 m: beyond 65.534 m
  disparities[3] = 1090;
  disparities[4] = 5000;  // no 11 bits
  disparities[5] = 0;
  message.depth.depth_data = kinect_bridge::little_endian(disparities);
  ScanFormat format = test_format();
  format.intrinsics->fx = 575.8;
  format.disparity = DisparityCalibration{0.075, 1089.5};
  const auto result = decoded(message, format);
  ASSERT_TRUE(result) << result.error().message;
  const auto& depth = std::get<DepthScan>(result->scan).depth;
  EXPECT_EQ(depth[0], 586);   // 8 * 575.8 * 0.075 / 589.5 = 0.58605 m
  EXPECT_EQ(depth[1], 3860);  // 345.48 / 89.5 = 3.86011 m
  EXPECT_EQ(depth[2], kNoReturn);
  EXPECT_EQ(depth[3], kNoReturn);
  EXPECT_EQ(depth[4], kNoReturn);
  EXPECT_EQ(depth[5], 317);  // 345.48 / 1089.5
  EXPECT_EQ(depth[6], kNoReturn);
  expect_rejected(message, "disparity",
                  "frame_msg_t: depth is raw 11-bit disparity: set inputs[].disparity to [baseline in metres, offset]");
}

/// Pixels of so many bits, the most significant first, one bit after the other: the slow twin.
std::vector<std::uint8_t> packed_bits(const std::vector<std::uint16_t>& pixels, int bits) {
  std::vector<std::uint8_t> bytes((pixels.size() * static_cast<std::size_t>(bits) + 7) / 8);
  std::size_t at = 0;
  for (const std::uint16_t pixel : pixels) {
    for (int bit = bits - 1; bit >= 0; --bit, ++at) {
      if (((pixel >> bit) & 1) != 0) bytes[at / 8] = static_cast<std::uint8_t>(bytes[at / 8] | (0x80U >> (at % 8)));
    }
  }
  return bytes;
}

TEST(FieldImages, PackedDisparityIsThatOfSixteenBits) {
  for (const int bits : {11, 10}) {
    auto message = to_kinect_frame(test_scan(), Encoding::kRaw);
    std::vector<std::uint16_t> disparities;
    for (int i = 0; i < 16 * 12; ++i) disparities.push_back(static_cast<std::uint16_t>((i * 131) % (1 << bits)));
    disparities[5] = static_cast<std::uint16_t>((1 << bits) - 1);  // nothing was seen
    ScanFormat format = test_format();
    format.disparity = DisparityCalibration{0.075, 1089.5};
    const bool is_11 = bits == 11;
    message.depth.depth_data = kinect_bridge::little_endian(disparities);
    message.depth.depth_data_format = is_11 ? kinect::depth_msg_t::DEPTH_11BIT : kinect::depth_msg_t::DEPTH_10BIT;
    const auto plain = decoded(message, format);
    // The libfreenect driver unpacks, and leaves the format as it was.
    message.depth.depth_data_format =
        is_11 ? kinect::depth_msg_t::DEPTH_11BIT_PACKED : kinect::depth_msg_t::DEPTH_10BIT_PACKED;
    const auto unpacked = decoded(message, format);
    message.depth.depth_data = packed_bits(disparities, bits);
    message.depth.depth_data_nbytes = static_cast<std::int32_t>(message.depth.depth_data.size());
    const auto packed = decoded(message, format);
    ASSERT_TRUE(plain && unpacked && packed);
    const auto& expected = std::get<DepthScan>(plain->scan).depth;
    EXPECT_EQ(std::get<DepthScan>(unpacked->scan).depth, expected);
    EXPECT_EQ(std::get<DepthScan>(packed->scan).depth, expected);
    EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](auto depth) { return depth != 0; }), 50);
    EXPECT_EQ(expected[5], kNoReturn);
  }
}

TEST(FieldImages, RegisteredDepthIsMillimetres) {
  auto message = to_kinect_frame(test_scan(), Encoding::kZlib);
  message.depth.depth_data_format = kinect::depth_msg_t::DEPTH_REGISTERED;
  expect_the_test_scan(message);
}

TEST(FieldImages, KinectFramesThatCannotBeUsed) {
  struct Case {
    const char* reason;
    const char* text;
    std::function<void(kinect::frame_msg_t&)> spoil;
  };
  const Case cases[] = {
      {"no_depth", "depth_data_format is 10: the driver sends no depth",
       [](auto& m) { m.depth.depth_data_format = 10; }},
      {"format", "depth_data_format is 7 (allowed: 0 to 5)", [](auto& m) { m.depth.depth_data_format = 7; }},
      {"time", "frame_msg_t: utime is 0, must be > 0", [](auto& m) { m.depth.timestamp = 0; }},
      {"size", "0 x 12 pixels (allowed: 1 to 4096 each)", [](auto& m) { m.depth.width = 0; }},
      {"size", "16 x -12 pixels (allowed", [](auto& m) { m.depth.height = -12; }},
      {"size", "16 x 4097 pixels (allowed", [](auto& m) { m.depth.height = 4097; }},
      {"size", "depth_data_nbytes is 384 for 17 x 12 pixels, must be 408", [](auto& m) { m.depth.width = 17; }},
      {"encoding", "compression is 2 (allowed: 0 none, 1 zlib)", [](auto& m) { m.depth.compression = 2; }},
      {"size", "uncompressed_size is 385 for 16 x 12 pixels, must be 384",
       [](auto& m) {
         m.depth.compression = 1;
         m.depth.uncompressed_size = 385;
       }},
      {"encoding", "zlib data of 384 bytes gave 0 of 384 bytes", [](auto& m) { m.depth.compression = 1; }},
  };
  for (const Case& c : cases) {
    auto message = to_kinect_frame(test_scan(), Encoding::kRaw);
    c.spoil(message);
    expect_rejected(message, c.reason, c.text);
  }
  auto large = to_kinect_frame(test_scan(), Encoding::kZlib);
  large.depth.width = large.depth.height = 4096;
  large.depth.uncompressed_size = 2 * 4096 * 4096;
  expect_rejected(large, "too_large", "4096 x 4096 pixels are 33554432 bytes, limits.image_bytes is 1048576");
  large.depth.width = large.depth.height = 700;
  large.depth.uncompressed_size = 2 * 700 * 700;
  large.depth.depth_data.resize(30);
  large.depth.depth_data_nbytes = 30;
  expect_rejected(large, "size", "30 bytes of zlib data cannot hold 700 x 700 pixels");
}

TEST(FieldImages, BotCoreImagesThatCannotBeUsed) {
  struct Case {
    const char* reason;
    const char* text;
    std::function<void(bot_core::images_t&)> spoil;
  };
  const Case cases[] = {
      {"no_depth", "of 2 images none is depth; their image_types are [0, 2] (taken: 4 DEPTH_MM, 6 DEPTH_MM_ZIPPED)",
       [](auto& m) { m.image_types[1] = 2; }},
      {"no_depth", "of 0 images none is depth",
       [](auto& m) {
         m.n_images = 0;
         m.image_types.clear();
         m.images.clear();
       }},
      {"size", "images_t: row_stride is 31 for 16 pixels of 2 bytes (allowed: 32 to 4128)",
       [](auto& m) { m.images[1].row_stride = 31; }},
      {"size", "row_stride is -32", [](auto& m) { m.images[1].row_stride = -32; }},
      {"too_large", "16 x 12 pixels are 25769803764 bytes", [](auto& m) { m.images[1].row_stride = 0x7fffffff; }},
      {"size", "384 bytes of raw data for 12 rows of 34 bytes, must be 408",
       [](auto& m) { m.images[1].row_stride = 34; }},
      {"size", "4097 x 12 pixels (allowed", [](auto& m) { m.images[1].width = 4097; }},
      {"encoding", "zlib data of 384 bytes gave 0 of 384 bytes of pixels", [](auto& m) { m.image_types[1] = 6; }},
      {"time", "utime is -1, must be > 0", [](auto& m) { m.images[1].utime = -1; }},
  };
  for (const Case& c : cases) {
    auto message = to_images(test_scan(), Encoding::kRaw);
    c.spoil(message);
    expect_rejected(message, c.reason, c.text);
  }
  auto image = to_image(test_scan());
  image.pixelformat = 859981650;  // RGB3
  expect_rejected(image, "format",
                  "image_t: pixelformat is 859981650, no 16-bit grey (allowed: 909199180 "
                  "little-endian, 357 big-endian)");
}

TEST(FieldImages, ManyImagesAndTrailingBytesAreRefused) {
  bot_core::images_t many{};
  many.utime = kUtime;
  many.n_images = 1001;
  many.image_types.resize(1001);
  many.images.resize(1001);
  expect_rejected(many, "size", "images_t: n_images is 1001 (allowed: up to 1000)");
  drake::lcmt_image_array array{};
  array.num_images = 1001;
  array.images.resize(1001);
  expect_rejected(array, "size", "lcmt_image_array: num_images is 1001 (allowed: up to 1000)");
  const Bytes good[] = {encoded(to_images(test_scan(), Encoding::kZlib)), encoded(to_image(test_scan())),
                        encoded(to_image_array(test_scan(), DrakePixels::kUint16, Encoding::kPng)),
                        encoded(to_kinect_frame(test_scan(), Encoding::kZlib))};
  for (Bytes bytes : good) {
    bytes.push_back(0);
    const auto scan = decode_scan(bytes, kMaxBytes, test_format());
    ASSERT_FALSE(scan);
    EXPECT_EQ(scan.error().reason, "size");
    EXPECT_NE(scan.error().message.find("1 bytes too many"), std::string::npos) << scan.error().message;
    bytes.resize(bytes.size() - 2);
    EXPECT_EQ(decode_scan(bytes, kMaxBytes, test_format()).error().reason, "truncated");
  }
}

TEST(FieldImages, PaddedRowsMetadataAndBigEndianPixelsAreRead) {
  auto image = to_image(test_scan());
  const auto raw = image.data;
  image.data.clear();
  for (std::size_t v = 0; v < 12; ++v) {
    for (std::size_t i = 0; i < 32; i += 2) {
      image.data.push_back(raw[32 * v + i + 1]);
      image.data.push_back(raw[32 * v + i]);
    }
    image.data.insert(image.data.end(), 8, 0xEE);
  }
  image.row_stride = 40;
  image.size = static_cast<std::int32_t>(image.data.size());
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_BE_GRAY16;
  bot_core::image_metadata_t metadata{};
  metadata.key = "exposure";
  metadata.n = 3;
  metadata.value = {1, 2, 3};
  image.metadata = {metadata};
  image.nmetadata = 1;
  expect_the_test_scan(image);
}

TEST(FieldImages, DrakeArraysThatCannotBeUsed) {
  struct Case {
    const char* reason;
    const char* text;
    std::function<void(drake::lcmt_image_array&)> spoil;
  };
  const Case cases[] = {
      {"no_depth", "none of 2 images is depth (pixel_format 5)", [](auto& m) { m.images[1].pixel_format = 6; }},
      {"frame", "2 depth images, of frames 'kinect_colour', 'kinect': say which with inputs[].frame",
       [](auto& m) { m.images[0].pixel_format = 5; }},
      {"format", "channel_type of a depth image is 7 (allowed: 3 uint16, 6 float32)",
       [](auto& m) { m.images[1].channel_type = 7; }},
      {"encoding", "compression_method of a depth image of uint16 is 2 (allowed: 0 none, 1 zlib, 3 png)",
       [](auto& m) { m.images[1].compression_method = 2; }},
      {"encoding", "compression_method of a depth image of float32 is 3 (allowed: 0 none, 1 zlib)",
       [](auto& m) {
         m.images[1].channel_type = 6;
         m.images[1].compression_method = 3;
       }},
      {"size", "row_stride is 32 for 16 pixels of 4 bytes (allowed: 64 to 4160)",
       [](auto& m) { m.images[1].channel_type = 6; }},
      {"size", "1 bytes of PNG data cannot hold 1000 x 500 pixels",
       [](auto& m) {
         m.images[1].compression_method = 3;
         m.images[1].width = 1000;
         m.images[1].height = 500;
         m.images[1].data = {7};
         m.images[1].size = 1;
       }},
      {"encoding", "damaged PNG of 384 bytes: Not a PNG file", [](auto& m) { m.images[1].compression_method = 3; }},
  };
  for (const Case& c : cases) {
    auto message = to_image_array(test_scan(), DrakePixels::kUint16, Encoding::kRaw);
    c.spoil(message);
    expect_rejected(message, c.reason, c.text);
  }
}

TEST(FieldImages, PngsMustBeTheImageThatTheMessageSays) {
  const auto good = to_image_array(test_scan(), DrakePixels::kUint16, Encoding::kPng);
  auto message = good;
  message.images[1].width = 17;
  expect_rejected(message, "encoding", "the PNG has 16 x 12 pixels, the message says 17 x 12");
  message.images[1].width = 15;
  expect_rejected(message, "encoding", "damaged PNG of");
  message = good;
  message.images[1].data.resize(message.images[1].data.size() / 2);
  message.images[1].size = static_cast<std::int32_t>(message.images[1].data.size());
  expect_rejected(message, "encoding", "bytes: ends too early");
  message = good;
  message.images[1].data[24] = 8;  // bit depth, which the chunk's checksum covers
  expect_rejected(message, "encoding", "damaged PNG of");
}

TEST(FieldImages, TheFrameChoosesAmongDepthImages) {
  auto message = to_image_array(test_scan(), DrakePixels::kUint16, Encoding::kZlib);
  message.images[0] = message.images[1];
  message.images[0].header.frame_name = "other";
  message.images[0].height = 0;
  auto format = test_format();
  format.frame = "kinect";
  const auto result = decoded(message, format);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(std::get<DepthScan>(result->scan).depth, test_scan().depth);
  format.frame = "neither";
  expect_rejected(message, "frame",
                  "no depth image is of frame 'neither' (inputs[].frame); there are 'other', 'kinect'", format);
}

TEST(FieldImages, IntrinsicsMustBeThereAndFit) {
  const auto message = to_images(test_scan(), Encoding::kZlib);
  expect_rejected(message, "intrinsics",
                  "images_t brings no intrinsics: set inputs[].intrinsics to [fx, fy, cx, cy] of its 16 x 12 pixels",
                  ScanFormat{});
  auto format = test_format();
  format.intrinsics->width = 640;
  format.intrinsics->height = 480;
  expect_rejected(message, "intrinsics", "16 x 12 pixels, but inputs[].intrinsics are of 640 x 480", format);
  format = test_format();
  format.intrinsics->cx = 319.5;
  expect_rejected(message, "intrinsics", "the centre 319.5 5.5 of inputs[].intrinsics is outside of 16 x 12 pixels",
                  format);
  format = test_format();
  format.intrinsics->fx = 0.01;
  expect_rejected(message, "intrinsics", "look more than 89 degrees to the side", format);
}

}  // namespace
}  // namespace planemap::service
