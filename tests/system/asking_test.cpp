// The map asked by the command line, as a user does: the real daemon on real multicast.
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/network.hpp"
#include "harness/system_test.hpp"

namespace planemap::system_test {
namespace {

constexpr int kFrames = 40;

class Asking : public SystemTest {
 protected:
  void build_map() {
    ASSERT_NO_FATAL_FAILURE(start_daemon({"--set", "map.gravity=[0, 0, -1]"}));
    const auto kinect =
        start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5", "--frames",
                         std::to_string(kFrames), "--rate", "10", "--quiet", "--lcm-url", kLcmUrl});
    // On a busy machine the daemon may let some go: what counts is a map that rests.
    ASSERT_EQ(kinect->wait_for(60s), 0) << kinect->output();
    ASSERT_TRUE(bus_->wait_until(
        [&] { return bus_->counter("scans.received") >= kFrames && bus_->counter("scans.waiting") == 0; }, 30s));
    ASSERT_GT(bus_->counter("scans.mapped"), kFrames / 4);
  }
  Finished planemap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), program("planemap"));
    arguments.insert(arguments.end(), {"--lcm-url", kLcmUrl});
    return run(arguments);
  }
  nlohmann::json json_of(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const Finished asked = planemap(arguments);
    EXPECT_EQ(asked.exit_code, 0) << arguments[0] << ": " << asked.err;
    auto json = nlohmann::json::parse(asked.out, nullptr, /*allow_exceptions=*/false);
    EXPECT_FALSE(json.is_discarded()) << asked.out.substr(0, 200);
    return json;
  }
  /// A command that fails with so and so.
  void expect_failure(const std::vector<std::string>& arguments, int exit_code, const std::string& said) const {
    const Finished asked = planemap(arguments);
    EXPECT_EQ(asked.exit_code, exit_code) << arguments[0];
    EXPECT_NE((asked.err + asked.out).find(said), std::string::npos) << arguments[0] << ": " << asked.err;
  }
};

TEST_F(Asking, EveryQuestionIsAnsweredInWordsAndInJson) {
  ASSERT_NO_FATAL_FAILURE(build_map());
  const auto snapshot = json_of({"snapshot"});
  ASSERT_GT(snapshot["planes"].size(), 5u);
  const auto& plane = snapshot["planes"][0];
  const std::string id = plane["id"].dump();
  const auto& c = plane["polygons"][0]["outer"][0];
  const std::vector<std::string> corner = {c[0].dump(), c[1].dump(), c[2].dump()};

  // A corner of a boundary: its plane is there, at no distance.
  auto near = json_of({"nearest", "--point", corner[0], corner[1], corner[2], "--sigma", "0.01", "--count", "3"});
  EXPECT_EQ(near["epoch"], snapshot["epoch"]);
  ASSERT_EQ(near["planes"].size(), 3u);
  EXPECT_NEAR(near["planes"][0]["surfaceDistance"].get<double>(), 0.0, 1e-3);
  EXPECT_GE(near["planes"][0]["sigma"].get<double>(), 0.01);
  const auto by_covariance = json_of({"nearest", "--point", corner[0], corner[1], corner[2], "--covariance", "1e-4",
                                      "0", "0", "0", "1e-4", "0", "0", "0", "1e-4"});
  EXPECT_NEAR(by_covariance["planes"][0]["sigma"].get<double>(), near["planes"][0]["sigma"].get<double>(), 1e-9);
  EXPECT_NE(planemap({"nearest", "--point", corner[0], corner[1], corner[2]}).out.find("mahalanobis"),
            std::string::npos);
  EXPECT_EQ(planemap({"nearest", "--point", "500", "0", "0", "--max-distance", "1"}).out, "no plane is near\n");

  // From off the surface along the normal's line towards it.
  std::vector<std::string> ray = {"ray", "--from"};
  std::vector<std::string> direction = {"--direction"};
  for (std::size_t i = 0; i < 3; ++i) {
    const double n = plane["normal"][i].get<double>();
    ray.push_back(std::to_string(plane["centroid"][i].get<double>() + 0.3 * n));
    direction.push_back(std::to_string(-n));
  }
  ray.insert(ray.end(), direction.begin(), direction.end());
  const auto hit = json_of(ray);
  if (!hit["plane"].is_null()) {
    EXPECT_GT(hit["plane"]["sigma"].get<double>(), 0.0);
  }
  const std::string ray_text = planemap(ray).out;
  EXPECT_NE(ray_text.find("plane "), std::string::npos) << ray_text;
  EXPECT_NE(ray_text.find("cell"), std::string::npos) << ray_text;

  const auto all = json_of({"region", "--box", "-inf", "-inf", "-inf", "inf", "inf", "inf", "--polygons", "--cells"});
  EXPECT_EQ(all["planes"].size(), snapshot["planes"].size());
  EXPECT_GT(all["cells"].size(), 1000u);
  EXPECT_NEAR(all["planes"][0]["areaInside"].get<double>(), all["planes"][0]["area"].get<double>(), 0.5);
  const auto walls =
      json_of({"region", "--box", "-inf", "-inf", "-inf", "inf", "inf", "inf", "--class", "wall", "--min-area", "0.5"});
  ASSERT_FALSE(walls["planes"].empty());
  EXPECT_LT(walls["planes"].size(), all["planes"].size());
  for (const auto& wall : walls["planes"]) EXPECT_EQ(wall["class"], "wall");
  const std::vector<std::vector<std::string>> shapes = {
      {"--oriented-box", corner[0], corner[1], corner[2], "1", "0", "0", "0", "1", "1", "1"},
      {"--sphere", corner[0], corner[1], corner[2], "0.5"},
      {"--frustum", "0", "0", "1", "1", "0", "0", "0", "57", "46", "0.1", "5"},
      {"--cylinder", corner[0], corner[1], "-1", corner[0], corner[1], "3", "0.3"}};
  for (const auto& shape : shapes) {
    std::vector<std::string> arguments = {"region"};
    arguments.insert(arguments.end(), shape.begin(), shape.end());
    const Finished asked = planemap(arguments);
    EXPECT_EQ(asked.exit_code, 0) << shape[0] << ": " << asked.err;
    EXPECT_NE(asked.out.find("planes: "), std::string::npos) << asked.out;
  }

  const auto told = json_of({"plane", id});
  EXPECT_EQ(told["fate"], "lives");
  EXPECT_EQ(told["plane"]["id"], plane["id"]);
  EXPECT_EQ(told["plane"]["covariance"], plane["covariance"]);
  EXPECT_EQ(told["plane"]["coplanar"], plane["coplanar"]);
  EXPECT_NE(planemap({"plane", id}).out.find("normal"), std::string::npos);

  const auto plan = json_of({"floorplan"});
  EXPECT_FALSE(plan["floor"].empty());
  EXPECT_GT(plan["freeArea"].get<double>(), 0.1);
  EXPECT_NE(planemap({"floorplan", "--cut-low", "0.5"}).out.find("free floor"), std::string::npos);
}

TEST_F(Asking, TheServerAnswersAsTheBusDoes) {
  ASSERT_NO_FATAL_FAILURE(build_map());
  const std::vector<std::vector<std::string>> questions = {
      {"snapshot", "--json"},
      {"snapshot"},
      {"nearest", "--point", "0", "0", "1", "--sigma", "0.01", "--json"},
      {"ray", "--from", "0", "0", "1", "--direction", "0", "0", "-1"},
      {"region", "--sphere", "0", "0", "0", "3", "--polygons"},
      {"plane", "1"},
      {"plane", "999999", "--json"},
      {"floorplan"}};
  for (const auto& question : questions) {
    std::vector<std::string> command = question;
    command.insert(command.begin(), program("planemap"));  // at the default server
    const Finished by_server = run(command);
    const bool is_known = question.size() < 2 || question[1] != "999999";
    EXPECT_EQ(by_server.exit_code, is_known ? 0 : 1) << question[0] << ": " << by_server.err;
    EXPECT_FALSE(by_server.out.empty()) << question[0];
    EXPECT_EQ(by_server.out, planemap(question).out) << question[0];
  }
  const Finished status = run({program("planemap"), "status", "--json"});
  ASSERT_EQ(status.exit_code, 0) << status.err;
  EXPECT_GT(nlohmann::json::parse(status.out)["planeCount"], 5);
  const std::string exported = (scratch_ / "map.json").string();
  EXPECT_EQ(run({program("planemap"), "export", "-", exported}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(exported));
  const Finished watch = run({program("planemap"), "watch", "--changes", "1", "--json"});
  EXPECT_EQ(watch.exit_code, 0) << watch.err;
  EXPECT_TRUE(nlohmann::json::parse(watch.out)["newMap"]);
}

TEST_F(Asking, ADaemonIsPausedResumedAndReset) {
  ASSERT_NO_FATAL_FAILURE(build_map());
  const auto admin = [&](const std::string& what) { return run({program("planemap"), what, "--json"}); };
  const auto status = [&] { return nlohmann::json::parse(run({program("planemap"), "status", "--json"}).out); };
  EXPECT_EQ(admin("pause").out, "{\"paused\":true}\n");
  EXPECT_NE(status()["idleReason"].dump().find("paused"), std::string::npos) << status()["idleReason"];
  EXPECT_EQ(admin("resume").out, "{\"paused\":false}\n");
  const auto before = status();
  const auto reset = nlohmann::json::parse(admin("reset").out);
  EXPECT_GT(reset["epoch"], before["epoch"]);
  EXPECT_EQ(status()["epoch"], reset["epoch"]);
  EXPECT_EQ(status()["planeCount"], 0);
  const Finished save = admin("save");
  EXPECT_EQ(save.exit_code, 1);
  EXPECT_NE(save.err.find("the map has no file: planemapd --map FILE"), std::string::npos) << save.err;
}

TEST_F(Asking, WhatIsWrongIsSaidInWords) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  expect_failure({"floorplan"}, 1, "the service refused the request: floorplan: which way is down is not known");
  expect_failure({"plane", "999999"}, 1, "planemap: plane 999999 was never in this map, or went too long ago");
  expect_failure({"nearest", "--point", "1e12", "0", "0"}, 1, "points[0].point_m: coordinates may be at most ");
  expect_failure({"nearest", "--point", "0", "0", "0", "--epoch", "3"}, 1, "asked for is 3");
  expect_failure({"nearest", "--point", "nan", "0", "0"}, 2, "--point: must be a finite number, is nan");
  expect_failure({"nearest", "--point", "0", "0"}, 2, "--point");
  expect_failure({"nearest"}, 2, "--point");
  expect_failure({"nearest", "--point", "0", "0", "0", "--class", "door"}, 2, "door");
  expect_failure({"region"}, 2, "Exactly 1 option from [--box,");
  expect_failure({"region", "--sphere", "0", "0", "0", "1", "--box", "0", "0", "0", "1", "1", "1"}, 2, "2 were given");
  expect_failure({"plane", "0"}, 2, "0");
  expect_failure({"watch", "--for", "-1"}, 2, "--for");
}

/// Whichever way the command line asks.
class WatchingBy : public Asking, public testing::WithParamInterface<std::vector<std::string>> {
 protected:
  std::vector<std::string> command(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {program("planemap"), "watch"});
    arguments.insert(arguments.end(), GetParam().begin(), GetParam().end());
    return arguments;
  }
};

INSTANTIATE_TEST_SUITE_P(LcmAndGrpc, WatchingBy,
                         testing::Values(std::vector<std::string>{"--lcm-url", kLcmUrl}, std::vector<std::string>{}),
                         [](const auto& way) { return way.param.empty() ? "Grpc" : "Lcm"; });

TEST_P(WatchingBy, EachChangeIsTold) {
  ASSERT_NO_FATAL_FAILURE(start_daemon());
  const auto watch = start("watch", command({"--json", "--changes", "4"}));
  ASSERT_TRUE(bus_->wait_until([&] { return watch->output().find('\n') != std::string::npos; }, 20s));
  const auto kinect = start("kinect", {program("planemap-kinect-bridge"), "--simulate", "apartment", "--seed", "5",
                                       "--frames", "40", "--rate", "10", "--quiet", "--lcm-url", kLcmUrl});
  ASSERT_EQ(watch->wait_for(60s), 0) << watch->output();
  std::istringstream lines(watch->output());
  std::string line;
  std::int64_t revision = -1;
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    const auto change = nlohmann::json::parse(line, nullptr, false);
    ASSERT_FALSE(change.is_discarded()) << line;
    EXPECT_EQ(change["newMap"], count == 0);
    EXPECT_EQ(change["sinceRevision"], revision);
    revision = change["revision"];
  }
  EXPECT_EQ(count, 4);

  const auto endless = start("endless", command({}));
  ASSERT_TRUE(bus_->wait_until([&] { return endless->output().find("from the beginning") != std::string::npos; }, 20s));
  endless->send_signal(SIGINT);
  EXPECT_EQ(endless->wait_for(5s), 0) << endless->output();
}

TEST_F(Asking, AProgramInCNeedsNothingButTheTypes) {
  const std::vector<std::string> command = {
      "env", std::string("LCM_DEFAULT_URL=") + kLcmUrl, program("planemap-c-example"), "0", "0", "0"};
  ASSERT_NO_FATAL_FAILURE(build_map());
  const Finished asked = run(command);
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_NE(asked.out.find("surface "), std::string::npos) << asked.out;
  const auto near = json_of({"nearest", "--point", "0", "0", "0", "--sigma", "0.01", "--count", "3"});
  for (const auto& plane : near["planes"]) {
    EXPECT_NE(asked.out.find("plane " + plane["id"].dump() + ": "), std::string::npos) << asked.out;
  }
  const Finished wrong =
      run({"env", std::string("LCM_DEFAULT_URL=") + kLcmUrl, program("planemap-c-example"), "nan", "0", "0"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_EQ(wrong.err, "planemapd refused: points[0].point_m: not every coordinate is a finite number\n");
}

TEST_F(Asking, NoDaemonIsThree) {
  const std::vector<std::vector<std::string>> commands = {
      {"nearest", "--point", "0", "0", "0"},
      {"ray", "--from", "0", "0", "0", "--direction", "1", "0", "0"},
      {"region", "--sphere", "0", "0", "0", "1"},
      {"plane", "1"},
      {"floorplan"},
      {"watch"}};
  for (auto command : commands) {
    command.insert(command.end(), {"--timeout", "0.2"});
    expect_failure(command, 3, "is planemapd running");
  }
}

}  // namespace
}  // namespace planemap::system_test
