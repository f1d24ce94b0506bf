// What the command line does with a map file: info, export, save and recover, by running the program.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../service/store/small_maps.hpp"
#include "store/file_lock.hpp"
#include "store/map_reader.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace planemap {
namespace {

using service::Database;
using service::MapFile;

class MapCommands : public ::testing::Test {
 protected:
  MapCommands() : map_(service::looked_around(77, 3)) {
    EXPECT_TRUE(service::write_map_file(path_, {"hall", "0 0 -1", "grid: {}", ""}, map_));
  }
  Finished planemap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), PLANEMAP_PROGRAM);
    return run_program(arguments, folder_.path(), std::chrono::seconds(60));
  }
  void damage() const {
    Database(path_, Database::Access::kWrite).execute("UPDATE block SET checksum=checksum+1 WHERE slot=3");
  }
  std::string out(const std::string& name) const { return (folder_ / name).string(); }

  TemporaryFolder folder_;
  const std::string path_ = (folder_ / "hall.planemap").string();
  const service::Snapshot map_;
};

TEST_F(MapCommands, InfoSaysWhatIsInTheFile) {
  const Finished info = planemap({"info", path_});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_NE(info.out.find("format     1, written by planemap "), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("frame      hall\ngravity    0 0 -1\nmap        epoch 77, revision "), std::string::npos);
  EXPECT_NE(info.out.find("state      whole, closed in good order"), std::string::npos) << info.out;
  const auto json = nlohmann::json::parse(planemap({"info", path_, "--json"}).out);
  EXPECT_EQ(json["epoch"], 77);
  EXPECT_EQ(json["planeCount"], map_->planes().size());
  EXPECT_EQ(json["cellCount"], map_->cell_count());
  EXPECT_EQ(json["nextPlaneId"], map_->state().next_plane_id);
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["bytes"], std::filesystem::file_size(path_));
}

TEST_F(MapCommands, ExportWritesTheFilesMap) {
  const Finished exported = planemap({"export", path_, out("a.json"), out("a.csv")});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  const auto json = nlohmann::json::parse(read_file(out("a.json")));
  EXPECT_EQ(json["frame"], "hall");
  EXPECT_EQ(json["epoch"], 77);
  ASSERT_EQ(json["planes"].size(), map_->planes().size());
  for (std::size_t i = 0; i < map_->planes().size(); ++i) {
    const auto& record = *map_->planes()[i];
    const auto found = std::find_if(json["planes"].begin(), json["planes"].end(),
                                    [&](const auto& plane) { return plane["id"] == record.id; });
    ASSERT_NE(found, json["planes"].end());
    EXPECT_EQ((*found)["d"].get<double>(), record.plane.d());
    EXPECT_EQ((*found)["covariance"].get<std::vector<double>>()[0], record.covariance(0, 0));
  }
  EXPECT_TRUE(std::filesystem::exists(out("a.csv")));
}

TEST_F(MapCommands, SaveCopiesAFileThatIsBeingWritten) {
  auto opened = MapFile::open(path_);
  ASSERT_TRUE(opened);
  const auto newer = service::looked_around(78, 4);
  ASSERT_TRUE(opened->file.commit(newer));  // it is in the WAL, and the file is open
  folder_.write("copy.planemap-wal", "left by a file that had this name");
  const Finished saved = planemap({"save", path_, out("copy.planemap")});
  EXPECT_EQ(saved.exit_code, 0) << saved.err;
  EXPECT_EQ(saved.out, out("copy.planemap") + "\n");
  EXPECT_FALSE(std::filesystem::exists(out("copy.planemap-wal")));
  const auto copy = MapFile::read(out("copy.planemap"));
  ASSERT_TRUE(copy) << copy.error().message;
  EXPECT_TRUE(service::essence(*copy->snapshot) == service::essence(*newer));
}

TEST_F(MapCommands, RecoverTakesOutWhatIsWholeAndSaysWhatIsLost) {
  damage();
  const Finished info = planemap({"info", path_});
  EXPECT_EQ(info.exit_code, 1);
  EXPECT_EQ(info.err, "planemap: " + path_ + ": block 3: its checksum is wrong\n");
  const Finished recovered = planemap({"recover", path_, "-o", out("whole.planemap")});
  EXPECT_EQ(recovered.exit_code, 0) << recovered.err;
  EXPECT_NE(recovered.out.find(" cells recovered; lost: 1 blocks, 0 planes"), std::string::npos) << recovered.out;
  const auto whole = MapFile::read(out("whole.planemap"));
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->snapshot->block_count(), map_->block_count() - 1);
  EXPECT_GT(whole->snapshot->epoch(), 77u) << "a life of its own";
  EXPECT_EQ(whole->facts.frame, "hall");
}

TEST_F(MapCommands, WrongUseIsTwoAndSaysWhatIsWrong) {
  struct Case {
    std::vector<std::string> arguments;
    std::string said;
  };
  const std::vector<Case> cases = {
      {{"info"}, "MAP is required"},
      {{"info", out("none")}, "none"},
      {{"export", out("none"), out("a.json")}, "none: there is no such file; '-' asks the running daemon"},
      {{"recover", path_}, "--output is required"},
      {{"recover", path_, "-o", path_}, "hall.planemap: is there already"},
      {{"recover", path_, "-o", out("nowhere/a.planemap")}, "nowhere/a.planemap: there is no folder "},
      {{"save", path_}, "MAP requires OUT"},
      {{"save", path_, path_}, "a file cannot be copied onto itself"},
      {{"save", path_, folder_.path().string()}, "is a folder"},
  };
  for (const Case& wrong : cases) {
    const Finished outcome = planemap(wrong.arguments);
    EXPECT_EQ(outcome.exit_code, 2) << wrong.said;
    EXPECT_NE((outcome.err + outcome.out).find(wrong.said), std::string::npos) << outcome.err << outcome.out;
  }
}

TEST_F(MapCommands, AFileThatIsInUseIsNotReplaced) {
  ASSERT_TRUE(service::write_map_file(out("live.planemap"), {}, map_));
  const auto lock = service::FileLock::take(out("live.planemap"));
  ASSERT_TRUE(lock);
  const Finished saved = planemap({"save", path_, out("live.planemap")});
  EXPECT_EQ(saved.exit_code, 1);
  EXPECT_EQ(saved.err, "planemap: " + out("live.planemap") + ": another process has the map open\n");
}

TEST_F(MapCommands, WhatIsNoMapIsSaid) {
  folder_.write("notes.txt", "nothing but words\n");
  const Finished info = planemap({"info", out("notes.txt")});
  EXPECT_EQ(info.exit_code, 1);
  EXPECT_EQ(info.err, "planemap: " + out("notes.txt") + ": is no map file: it is none of SQLite's databases\n");
}

}  // namespace
}  // namespace planemap
