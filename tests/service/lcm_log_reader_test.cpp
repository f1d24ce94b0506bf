#include "ingest/lcm_log_reader.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <string>
#include <vector>

#include "support/temporary_folder.hpp"

namespace planemap::service {
namespace {

namespace fs = std::filesystem;

class LcmLogReaderTest : public testing::Test {
 protected:
  /// Message k is k * 100 + 1 bytes of value k; where its record begins is in offsets_, and the file's size behind
  /// them.
  fs::path write_log(int count) {
    const fs::path path = folder_ / "log";
    lcm::LogFile log(path.string(), "w");
    EXPECT_TRUE(log.good());
    std::uint64_t offset = 0;
    for (int k = 0; k < count; ++k) {
      std::string bytes(static_cast<std::size_t>(k) * 100 + 1, static_cast<char>(k));
      lcm::LogEvent event{};
      event.eventnum = k;
      event.timestamp = 1000 + k;
      event.channel = "CHANNEL_" + std::to_string(k % 3);
      event.datalen = static_cast<int>(bytes.size());
      event.data = bytes.data();
      EXPECT_EQ(log.writeEvent(&event), 0);
      offsets_.push_back(offset);
      offset += LcmLogReader::kHeaderBytes + event.channel.size() + bytes.size();
    }
    offsets_.push_back(offset);
    return path;
  }

  static void overwrite(const fs::path& path, std::uint64_t offset, const std::string& bytes) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(offset));
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    ASSERT_TRUE(file.good());
  }

  TemporaryFolder folder_;
  std::vector<std::uint64_t> offsets_;
};

/// The numbers of all events; their channel, time and bytes are checked to be those of write_log().
std::vector<std::int64_t> numbers_of(LcmLogReader& reader) {
  std::vector<std::int64_t> numbers;
  while (const auto event = reader.next()) {
    const std::int64_t k = event->number;
    numbers.push_back(k);
    EXPECT_EQ(event->utime, 1000 + k);
    EXPECT_EQ(event->channel, "CHANNEL_" + std::to_string(k % 3));
    EXPECT_EQ(event->data.size(), static_cast<std::size_t>(k) * 100 + 1);
    for (const std::uint8_t byte : event->data) EXPECT_EQ(byte, static_cast<std::uint8_t>(k));
  }
  return numbers;
}

TEST_F(LcmLogReaderTest, ReadsWhatLcmWrote) {
  auto reader = LcmLogReader::open(write_log(5));
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(numbers_of(*reader), (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(reader->gaps(), 0u);
  EXPECT_EQ(reader->position_bytes(), reader->size_bytes());
  EXPECT_EQ(reader->size_bytes(), offsets_.back());
}

TEST_F(LcmLogReaderTest, GoesOnBehindALostSyncWord) {
  const fs::path path = write_log(5);
  overwrite(path, offsets_[2], "....");
  auto reader = LcmLogReader::open(path);
  ASSERT_TRUE(reader);
  EXPECT_EQ(numbers_of(*reader), (std::vector<std::int64_t>{0, 1, 3, 4}));
  EXPECT_EQ(reader->gaps(), 1u);
  EXPECT_EQ(reader->gap_bytes(), offsets_[3] - offsets_[2]);
}

TEST_F(LcmLogReaderTest, ALengthThatSwallowsOtherRecordsCostsOnlyItsOwn) {
  const fs::path path = write_log(6);
  overwrite(path, offsets_[1] + 24, std::string("\x00\x00\x02\x00", 4));  // 512 B: ends inside record 3
  auto reader = LcmLogReader::open(path);
  ASSERT_TRUE(reader);
  EXPECT_EQ(numbers_of(*reader), (std::vector<std::int64_t>{0, 2, 3, 4, 5}));
  EXPECT_EQ(reader->gap_bytes(), offsets_[2] - offsets_[1]);
}

TEST_F(LcmLogReaderTest, ImpossibleHeadersCostOnlyTheirRecord) {
  struct Damage {
    const char* what;
    std::uint64_t offset;
    std::string bytes;
  };
  const std::vector<Damage> damages = {{"channel of -1 bytes", 20, std::string("\xff\xff\xff\xff", 4)},
                                       {"channel of no bytes", 20, std::string("\x00\x00\x00\x00", 4)},
                                       {"message of -1 bytes", 24, std::string("\xff\xff\xff\xff", 4)},
                                       {"message of 2 GiB", 24, std::string("\x7f\xff\xff\xff", 4)},
                                       {"message beyond the file", 24, std::string("\x0f\xff\xff\xff", 4)},
                                       {"channel with a zero in it", 28, std::string("\x00", 1)}};
  for (const Damage& damage : damages) {
    offsets_.clear();
    const fs::path path = write_log(4);
    overwrite(path, offsets_[1] + damage.offset, damage.bytes);
    auto reader = LcmLogReader::open(path);
    ASSERT_TRUE(reader);
    EXPECT_EQ(numbers_of(*reader), (std::vector<std::int64_t>{0, 2, 3})) << damage.what;
    EXPECT_EQ(reader->gap_bytes(), offsets_[2] - offsets_[1]) << damage.what;
  }
}

TEST_F(LcmLogReaderTest, ATruncatedLastRecordIsCounted) {
  const fs::path path = write_log(4);
  fs::resize_file(path, offsets_[4] - 7);
  auto reader = LcmLogReader::open(path);
  ASSERT_TRUE(reader);
  EXPECT_EQ(numbers_of(*reader), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(reader->gaps(), 1u);
  EXPECT_EQ(reader->gap_bytes(), offsets_[4] - 7 - offsets_[3]);
}

TEST_F(LcmLogReaderTest, AFileThatIsNoLogHasNoEvents) {
  const fs::path path = folder_ / "text";
  std::ofstream(path) << std::string(3'000'000, 'x');  // more than a window
  auto reader = LcmLogReader::open(path);
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->next());
  EXPECT_EQ(reader->gap_bytes(), 3'000'000u);
  EXPECT_FALSE(reader->next());
  EXPECT_EQ(reader->gaps(), 1u);
}

TEST_F(LcmLogReaderTest, FoldersAndMissingFilesAreNamedInTheError) {
  for (const fs::path& path : {folder_.path(), folder_ / "missing"}) {
    const auto reader = LcmLogReader::open(path);
    ASSERT_FALSE(reader);
    EXPECT_NE(reader.error().message.find(path.string()), std::string::npos);
  }
}

std::map<std::string, int> channels_of(const char* name) {
  std::map<std::string, int> counts;
  auto reader = LcmLogReader::open(fs::path(std::getenv("PLANEMAP_TEST_DATA")) / "lcm" / name);
  EXPECT_TRUE(reader);
  while (const auto event = reader->next()) ++counts[std::string(event->channel)];
  EXPECT_EQ(reader->gaps(), 0u);
  return counts;
}

/// As LCM's own reader counts them.
std::map<std::string, int> channels_by_lcm(const char* name) {
  std::map<std::string, int> counts;
  lcm::LogFile log((fs::path(std::getenv("PLANEMAP_TEST_DATA")) / "lcm" / name).string(), "r");
  while (const lcm::LogEvent* event = log.readNextEvent()) ++counts[event->channel];
  return counts;
}

TEST(LcmLogReaderRealLogs, AreReadWhole) {
  if (std::getenv("PLANEMAP_TEST_DATA") == nullptr) GTEST_SKIP() << "PLANEMAP_TEST_DATA is not set";
  EXPECT_EQ(channels_of("poses-only-bot_core.lcmlog"), (std::map<std::string, int>{{"POSE", 557}}));
  const auto foreign = channels_of("botlab-foreign-channels.lcmlog");
  EXPECT_GT(foreign.size(), 1u);
  EXPECT_EQ(foreign, channels_by_lcm("botlab-foreign-channels.lcmlog"));
}

}  // namespace
}  // namespace planemap::service
