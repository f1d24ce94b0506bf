// Metrics: the numbers against the service's own, and the documents against what is served.

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "test_site.hpp"

namespace planemap::service {
namespace {

struct Served {
  std::map<std::string, std::string> types;  ///< by family
  std::map<std::string, double> values;      ///< by name with labels
};

Served metrics_of(const TestSite& site) {
  const HttpReply reply = site.get("/metrics");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("content-type"), "text/plain; version=0.0.4; charset=utf-8");
  Served served;
  std::istringstream lines(reply.body);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) {
      std::istringstream words(line.substr(7));
      std::string name;
      words >> name >> served.types[name];
    } else if (!line.starts_with("#")) {
      const auto space = line.rfind(' ');
      EXPECT_TRUE(served.values.emplace(line.substr(0, space), std::stod(line.substr(space + 1))).second) << line;
    }
  }
  return served;
}

std::string text_of(const std::string& file) {
  std::ifstream in(std::string(PLANEMAP_SOURCE_DIR "/") + file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(Metrics, TellWhatTheServiceKnows) {
  TestSite site;
  site.room().look_around();
  const Served served = metrics_of(site);
  const auto snapshot = site.service().snapshot();
  const auto& values = served.values;
  EXPECT_EQ(values.at("planemap_scans_received_total"), 3);
  EXPECT_EQ(values.at(R"(planemap_scans_total{outcome="mapped",reason=""})"), 3);
  EXPECT_EQ(values.at(R"(planemap_points_total{outcome="mapped"})"), site.counter("points.mapped"));
  EXPECT_EQ(values.at("planemap_map_planes"), 3);
  EXPECT_EQ(values.at("planemap_map_revision"), static_cast<double>(snapshot->revision()));
  EXPECT_EQ(values.at("planemap_map_cells"), static_cast<double>(snapshot->cell_count()));
  EXPECT_EQ(values.at("planemap_map_blocks"), static_cast<double>(snapshot->block_count()));
  EXPECT_GT(values.at("planemap_map_bytes"), 100.0 * static_cast<double>(snapshot->cell_count()));
  EXPECT_GT(values.at("process_resident_memory_bytes"), 1e6);
#ifndef __SANITIZE_ADDRESS__  // which has an allocator of its own
  EXPECT_GT(values.at("planemap_heap_used_bytes"), values.at("planemap_map_bytes"));
#endif
  EXPECT_EQ(values.at("planemap_scan_seconds_count"), 3);
  EXPECT_EQ(values.at(R"(planemap_scan_seconds_bucket{le="+Inf"})"), 3);
  double stages_s = 0.0;
  for (const char* stage : {"assign", "normals", "localPlanes", "globalPlanes", "wear", "snapshot"}) {
    const std::string labels = std::string("{stage=\"") + stage + "\"}";
    EXPECT_EQ(values.at("planemap_stage_seconds_count" + labels), 3) << stage;
    stages_s += values.at("planemap_stage_seconds_sum" + labels);
  }
  EXPECT_GT(stages_s, 0.0);
  EXPECT_LE(stages_s, values.at("planemap_scan_seconds_sum"));
  EXPECT_EQ(values.at("planemap_live"), 1);
  EXPECT_EQ(values.at("planemap_ready"), 1);
  EXPECT_EQ(values.at(R"(planemap_clients{protocol="http"})"), 1) << "the one that asks";
  EXPECT_EQ(values.at(R"(planemap_events_total{event="poses.received"})"), 3);
  EXPECT_EQ(values.at("planemap_queue_capacity_scans"), 1000);
  EXPECT_EQ(metrics_of(site).values.at(R"(planemap_http_requests_total{code="200"})"), 1);
}

TEST(Metrics, CountDroppedScansByReason) {
  TestSite site;
  site.service().mapping().pause();
  site.service().counter_board().scan_received();
  site.service().counter_board().scan_dropped("paused");
  const Served served = metrics_of(site);
  EXPECT_EQ(served.values.at(R"(planemap_scans_total{outcome="dropped",reason="paused"})"), 1);
  EXPECT_EQ(served.values.at("planemap_paused"), 1);
}

TEST(Metrics, FollowTheConventionsOfPrometheus) {
  TestSite site;
  for (const auto& [name, type] : metrics_of(site).types) {
    EXPECT_TRUE(std::regex_match(name, std::regex("(planemap|process)_[a-z][a-z_]*"))) << name;
    EXPECT_EQ(name.ends_with("_total"), type == "counter") << name;
    for (const char* unit : {"_ms", "_us", "_kb", "_kilobytes", "_milliseconds"}) {
      EXPECT_FALSE(name.ends_with(unit)) << name << " is not in a base unit";
    }
  }
}

TEST(Metrics, TheTableOfTheDocumentationIsWhatIsServed) {
  TestSite site;
  std::map<std::string, std::string> told;
  const std::string text = text_of("docs/http.md");
  const std::regex row(R"(\n\| `([a-z_]+)(?:\{[a-z, ]*\})?` \| (counter|gauge|histogram) \|)");
  for (std::sregex_iterator at(text.begin(), text.end(), row); at != std::sregex_iterator(); ++at) {
    told[(*at)[1]] = (*at)[2];
  }
  EXPECT_EQ(told, metrics_of(site).types);
}

TEST(Metrics, TheDashboardAsksForWhatIsServed) {
  TestSite site;
  const auto types = metrics_of(site).types;
  const auto dashboard = nlohmann::json::parse(text_of("deploy/grafana/planemapd.json"));
  std::set<std::string> asked;
  for (const auto& panel : dashboard.at("panels")) {
    ASSERT_FALSE(panel.at("targets").empty()) << panel.at("title");
    for (const auto& target : panel.at("targets")) {
      const std::string expression = target.at("expr");
      const std::regex metric("(planemap|process)_[a-z_]+");
      std::sregex_iterator at(expression.begin(), expression.end(), metric);
      ASSERT_NE(at, std::sregex_iterator()) << expression;
      for (; at != std::sregex_iterator(); ++at) {
        const std::string name = at->str();
        const std::string family = std::regex_replace(name, std::regex("_(bucket|sum|count)$"), "");
        EXPECT_TRUE(types.contains(name) || (types.contains(family) && types.at(family) == "histogram"))
            << name << " in " << panel.at("title");
        asked.insert(types.contains(name) ? name : family);
      }
    }
  }
  for (const auto& [name, type] : types) EXPECT_TRUE(asked.contains(name)) << name << " is on no panel";
}

}  // namespace
}  // namespace planemap::service
