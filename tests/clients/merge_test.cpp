// planemap merge, by running the program: on the halves of a log, and on maps that do not go together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <planemap/block.hpp>
#include <planemap/mapper.hpp>
#include <string>
#include <vector>

#include "../service/store/small_maps.hpp"
#include "store/map_reader.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap {
namespace {

using service::Database;
using service::MapFile;

class Merging : public ::testing::Test {
 protected:
  static Finished run(std::vector<std::string> arguments, const TemporaryFolder& folder) {
    return run_program(arguments, folder.path(), std::chrono::seconds(240));
  }
  Finished planemap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), PLANEMAP_PROGRAM);
    return run(std::move(arguments), folder_);
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, std::uint64_t epoch, const service::MapFacts& facts) const {
    ASSERT_TRUE(service::write_map_file(file(name), facts, service::looked_around(epoch, 2)));
  }

  TemporaryFolder folder_;
};

/// Copies all poses, and those scans of a log whose number passes.
void copy_log(const std::string& from, const std::string& to, const std::function<bool(int)>& takes) {
  lcm::LogFile in(from, "r");
  lcm::LogFile out(to, "w");
  ASSERT_TRUE(in.good() && out.good());
  int scans = 0;
  while (const lcm::LogEvent* event = in.readNextEvent()) {
    if (event->channel == "PLANEMAP_SCAN" && !takes(scans++)) continue;
    lcm::LogEvent copy = *event;
    ASSERT_EQ(out.writeEvent(&copy), 0);
  }
  ASSERT_GT(scans, 0);
}

/// Whether a plane's normal and place are those of a record.
bool is_same_plane(const PlaneRecord& a, const PlaneRecord& b) {
  return a.plane.normal().dot(b.plane.normal()) > std::cos(0.5 * M_PI / 180.0) &&
         std::abs(b.plane.signed_distance_m(a.centroid_m)) < 0.01;
}

/// Cells of a map's planes, and those of planes that have a counterpart in another map.
struct Agreement {
  std::size_t cells = 0;
  std::size_t found = 0;
  double share() const { return static_cast<double>(found) / static_cast<double>(cells); }
};
Agreement agreement(const MapSnapshot& of, const MapSnapshot& with) {
  Agreement result;
  for (const auto& plane : of.planes()) {
    const auto others = with.planes();
    const bool found =
        std::any_of(others.begin(), others.end(), [&](const auto& o) { return is_same_plane(*plane, *o); });
    result.cells += plane->cell_count;
    result.found += found ? plane->cell_count : 0;
  }
  return result;
}

TEST_F(Merging, HalvesOfALogGiveThePlanesOfTheWholeLog) {
  constexpr int kScans = 40;
  const std::string log = file("whole.lcm");
  const Finished made = run({KINECT_BRIDGE_PROGRAM, "--simulate", "apartment", "--seed", "5", "--frames",
                             std::to_string(kScans), "--log", log, "--quiet"},
                            folder_);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  ASSERT_NO_FATAL_FAILURE(copy_log(log, file("a.lcm"), [](int scan) { return scan < kScans / 2; }));
  ASSERT_NO_FATAL_FAILURE(copy_log(log, file("b.lcm"), [](int scan) { return scan >= kScans / 2; }));
  for (const char* name : {"whole", "a", "b"}) {
    const Finished built = planemap(
        {"build", file(name) + std::string(".lcm"), "--quiet", "--output", file(name) + std::string(".planemap")});
    ASSERT_EQ(built.exit_code, 0) << built.err;
  }
  const Finished merged =
      planemap({"merge", file("a.planemap"), file("b.planemap"), "-o", file("sum.planemap"), "--json"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;

  const auto whole = MapFile::read(file("whole.planemap"));
  const auto a = MapFile::read(file("a.planemap"));
  const auto b = MapFile::read(file("b.planemap"));
  const auto sum = MapFile::read(file("sum.planemap"));
  ASSERT_TRUE(whole && a && b && sum) << sum.error().message;
  const auto there = agreement(*whole->snapshot, *sum->snapshot);
  const auto back = agreement(*sum->snapshot, *whole->snapshot);
  std::printf(
      "whole: %zu planes, sum: %zu; of the cells on planes %.2f %% of the whole's and %.2f %% of the sum's are on "
      "planes that the other has; half a: %.2f %%\n",
      whole->snapshot->planes().size(), sum->snapshot->planes().size(), 100.0 * there.share(), 100.0 * back.share(),
      100.0 * agreement(*whole->snapshot, *a->snapshot).share());
  EXPECT_GT(there.share(), 0.97);
  EXPECT_GT(back.share(), 0.97);
  EXPECT_LT(agreement(*whole->snapshot, *a->snapshot).share(), 0.9) << "a half alone shows nothing";

  const auto json = nlohmann::json::parse(merged.out);
  EXPECT_EQ(json["output"], file("sum.planemap"));
  EXPECT_EQ(json["planeCount"], sum->snapshot->planes().size());
  EXPECT_EQ(json["cellCount"], sum->snapshot->cell_count());
  EXPECT_EQ(json["epoch"], sum->snapshot->epoch());
  EXPECT_EQ(json["inputs"][1]["cellCount"], b->snapshot->cell_count());
  EXPECT_NE(sum->snapshot->epoch(), a->snapshot->epoch()) << "a life of its own";
  EXPECT_GE(sum->snapshot->state().next_plane_id, a->snapshot->state().next_plane_id);
  EXPECT_TRUE(sum->closed);
}

TEST_F(Merging, TheSameMapsGiveTheSameSum) {
  write("a.planemap", 7, {});
  write("b.planemap", 8, {});
  for (const char* out : {"one.planemap", "two.planemap"}) {
    const Finished merged = planemap({"merge", file("a.planemap"), file("b.planemap"), "-o", file(out)});
    ASSERT_EQ(merged.exit_code, 0) << merged.err;
    EXPECT_NE(merged.out.find(file(out) + ": "), std::string::npos) << merged.out;
  }
  EXPECT_EQ(service::essence(*MapFile::read(file("one.planemap"))->snapshot),
            service::essence(*MapFile::read(file("two.planemap"))->snapshot));
}

TEST_F(Merging, ManyMapsAreAddedUpInOneGo) {
  const auto points = [](const service::Snapshot& map) {
    double sum = 0.0;
    for (const auto& block : map->blocks()) {
      for (std::size_t i = 0; i < block->size(); ++i) sum += block->cell(i).sums.count;
    }
    return sum;
  };
  std::vector<std::string> arguments = {"merge", "-o", file("sum.planemap"), "--quiet"};
  double all = 0.0;
  for (const std::uint64_t epoch : {7, 8, 9}) {
    const std::string name = std::to_string(epoch) + ".planemap";
    write(name, epoch, {});
    arguments.push_back(file(name));
    all += points(MapFile::read(file(name))->snapshot);
  }
  const Finished merged = planemap(arguments);
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  const auto sum = MapFile::read(file("sum.planemap"));
  ASSERT_TRUE(sum) << sum.error().message;
  EXPECT_EQ(points(sum->snapshot), all);
  EXPECT_GT(sum->snapshot->planes().size(), MapFile::read(file("7.planemap"))->snapshot->planes().size())
      << "cells that no map alone had seen often enough";
}

TEST_F(Merging, ATransformPlacesTheSecondMap) {
  write("a.planemap", 7, {"hall", "", "", ""});
  write("b.planemap", 8, {"office", "0 1 0", "", ""});  // gravity of a frame that is turned about x
  const double s = std::sqrt(0.5);
  const std::string pose = "1,2,0," + std::to_string(s) + ",0,0," + std::to_string(s);
  const std::string matrix = "1 0 0 1\n0 0 -1 2\n0 1 0 0\n0 0 0 1\n";  // the same
  folder_.write("transform.txt", matrix);
  const auto sum = [&](const std::string& transform, const std::string& out) {
    const Finished merged =
        planemap({"merge", file("a.planemap"), file("b.planemap"), "-o", file(out), "--transform", transform});
    EXPECT_EQ(merged.exit_code, 0) << merged.err;
    return MapFile::read(file(out)).value();
  };
  const auto by_pose = sum(pose, "pose.planemap");
  const auto by_file = sum(file("transform.txt"), "file.planemap");
  EXPECT_EQ(by_pose.facts.frame, "hall");
  EXPECT_EQ(by_pose.snapshot->cell_count(), by_file.snapshot->cell_count());
  EXPECT_GT(by_pose.snapshot->cell_count(), MapFile::read(file("a.planemap"))->snapshot->cell_count());
  const auto down = by_file.facts.gravity_direction();
  ASSERT_TRUE(down);
  EXPECT_NEAR(down->z(), 1.0, 1e-9) << "the second map's, in the first one's frame";
}

TEST_F(Merging, MapsThatDoNotGoTogetherAreRefusedInWords) {
  write("a.planemap", 7, {"world", "0 0 -1", "grid: {density_threshold: 12}", ""});
  write("state.planemap", 7, {});
  write("office.planemap", 8, {"office", "", "", ""});
  write("other.planemap", 9, {"world", "", "grid: {density_threshold: 20}\nwear: {after_s: 7}", ""});
  write("tilted.planemap", 10, {"world", "0 0.5 -1", "", ""});
  write("newer.planemap", 11, {});
  Database(file("newer.planemap"), Database::Access::kWrite)
      .execute("PRAGMA user_version=99; UPDATE meta SET value='99' WHERE key='format'");
  write("damaged.planemap", 14, {});
  Database(file("damaged.planemap"), Database::Access::kWrite)
      .execute("UPDATE block SET checksum=checksum+1 WHERE slot=3");
  write("strange.planemap", 12, {"world", "", "grid: {colour: 3}", ""});
  MapperConfig coarse;
  coarse.grid.cell_size_m = 0.1;
  ASSERT_TRUE(service::write_map_file(file("coarse.planemap"), {}, Mapper(coarse, 13).snapshot()));
  struct Case {
    std::string other;
    std::string said;
  };
  const std::vector<Case> cases = {
      {"state.planemap", "are states of one map (epoch 7): what both saw would count twice"},
      {"office.planemap",
       "are of the frames 'world' and 'office': --transform says where the second one is in the first"},
      {"other.planemap", "other.planemap was mapped with other settings than " + file("a.planemap") +
                             ": grid.density_threshold: 20, not 12; wear.after_s: 7, not "},
      {"tilted.planemap", "their directions of gravity are 26.6 degrees apart in the first one's frame"},
      {"newer.planemap", "was written by a newer planemap (format 99, this one knows up to 1)"},
      {"damaged.planemap", "damaged.planemap: block 3: its checksum is wrong"},
      {"strange.planemap", "strange.planemap:1: grid.colour"},
      {"coarse.planemap", "have cells of 0.08 m and 0.1 m: cells of different sizes do not add up"},
  };
  for (const Case& wrong : cases) {
    const Finished refused = planemap({"merge", file("a.planemap"), file(wrong.other), "-o", file("sum.planemap")});
    EXPECT_EQ(refused.exit_code, 1) << wrong.other;
    EXPECT_NE(refused.err.find(wrong.said), std::string::npos) << refused.err;
    EXPECT_FALSE(std::filesystem::exists(file("sum.planemap")));
  }
  const Finished wanted = planemap(
      {"merge", file("a.planemap"), file("other.planemap"), "-o", file("sum.planemap"), "--first-settings", "--quiet"});
  EXPECT_EQ(wanted.exit_code, 0) << wanted.err;
  EXPECT_EQ(wanted.out, "");
}

TEST_F(Merging, WrongUseIsTwoAndSaysWhatIsWrong) {
  write("a.planemap", 7, {});
  write("b.planemap", 8, {});
  write("c.planemap", 9, {});
  folder_.write("words.txt", "one two three\n");
  const std::string a = file("a.planemap");
  const std::string b = file("b.planemap");
  struct Case {
    std::vector<std::string> arguments;
    std::string said;
  };
  const std::vector<Case> cases = {
      {{a, b}, "--output is required"},
      {{a, "-o", file("new")}, "merge needs two maps or more"},
      {{a, file("none"), "-o", file("new")}, "none"},
      {{a, b, "-o", a}, "a.planemap: is one of the maps to merge; the sum needs a file of its own"},
      {{a, a, "-o", file("new")}, "a.planemap: is given twice: what it saw would count twice"},
      {{a, b, "-o", file("c.planemap")}, "c.planemap: is there already"},
      {{a, b, "-o", file("nowhere/new")}, "nowhere/new: there is no folder "},
      {{a, b, file("c.planemap"), "-o", file("new"), "--transform", "0,0,0,0,0,0,1"},
       "--transform places the second of two maps"},
      {{a, b, "-o", file("new"), "--transform", "1,2,3"},
       "--transform: 3 numbers, where there should be seven numbers"},
      {{a, b, "-o", file("new"), "--transform", "0,0,0,0,0,1,1"}, "the quaternion qx,qy,qz,qw is not of length 1"},
      {{a, b, "-o", file("new"), "--transform", "2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"},
       "the 4x4 matrix is no rigid transform"},
      {{a, b, "-o", file("new"), "--transform", file("words.txt")}, "words.txt: holds other words than numbers"},
      {{a, b, "-o", file("new"), "--transform", "nan,0,0,0,0,0,1"}, "(a file, or seven numbers"},
  };
  for (const Case& wrong : cases) {
    std::vector<std::string> arguments = {"merge"};
    arguments.insert(arguments.end(), wrong.arguments.begin(), wrong.arguments.end());
    const Finished refused = planemap(arguments);
    EXPECT_EQ(refused.exit_code, 2) << wrong.said;
    EXPECT_NE((refused.err + refused.out).find(wrong.said), std::string::npos) << refused.err << refused.out;
  }
}

}  // namespace
}  // namespace planemap
