// Streams of events, and a mirror that is made from them alone.

#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "test_site.hpp"

namespace planemap::service {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

struct Event {
  std::string name;  ///< empty: the stream has ended; ":": a comment
  Json json;
};

/// A page that watches.
class Watcher {
 public:
  explicit Watcher(std::uint16_t port) : client_(port) {
    client_.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    head_ = client_.read_until("\r\n\r\n");
  }
  const std::string& head() const { return head_; }

  Event next() {
    const std::string text = client_.read_until("\n\n");
    if (text.starts_with(":")) return {":", {}};
    const auto data = text.find("\ndata: ");
    if (!text.starts_with("event: ") || data == std::string::npos) return {};
    return {text.substr(7, data - 7), Json::parse(text.substr(data + 7))};
  }
  /// The next of that name; deltas that come before are applied.
  Event next(const std::string& name) {
    while (true) {
      const Event event = next();
      if (event.name == "delta") apply(event.json);
      if (event.name == name || event.name.empty()) return event;
    }
  }
  /// Reads until it has the map of that revision. @return false: the stream has ended
  bool reach(std::uint64_t epoch, std::uint64_t revision) {
    while (epoch_ != epoch || revision_ != revision) {
      if (next("delta").name.empty()) return false;
    }
    return true;
  }
  const std::map<PlaneId, Json>& planes() const { return planes_; }
  std::uint64_t revision() const { return revision_; }
  int deltas() const { return deltas_; }
  TcpClient& client() { return client_; }

 private:
  void apply(const Json& delta) {
    ++deltas_;
    if (delta.at("full").get<bool>()) {
      planes_.clear();
    } else {
      EXPECT_EQ(delta.at("epoch"), epoch_) << "deltas join";
      EXPECT_EQ(delta.at("since"), revision_) << "deltas join";
    }
    for (const Json& plane : delta.at("planes")) planes_[plane.at("id")] = plane;
    for (const Json& id : delta.at("removed")) planes_.erase(id);
    epoch_ = delta.at("epoch");
    revision_ = delta.at("revision");
  }

  TcpClient client_;
  std::string head_;
  std::map<PlaneId, Json> planes_;
  std::uint64_t epoch_ = 0;
  std::uint64_t revision_ = 0;
  int deltas_ = 0;
};

std::map<PlaneId, Json> planes_of(const TestSite& site) {
  std::map<PlaneId, Json> planes;
  const Json json = Json::parse(site.get("/api/v1/planes").body);
  for (const Json& plane : json.at("planes")) planes[plane.at("id")] = plane;
  return planes;
}

TEST(HttpEvents, BeginWithHelloAndTheWholeMap) {
  TestSite site;
  site.room().look_around();
  Watcher watcher(site.port());
  EXPECT_TRUE(watcher.head().starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_NE(watcher.head().find("Content-Type: text/event-stream\r\n"), std::string::npos);
  EXPECT_NE(watcher.head().find("Content-Security-Policy: default-src 'self'\r\n"), std::string::npos);
  const Event hello = watcher.next();
  ASSERT_EQ(hello.name, "hello");
  EXPECT_EQ(hello.json.at("epoch"), 1234);
  EXPECT_EQ(hello.json.at("frame"), "world");
  EXPECT_TRUE(hello.json.contains("version"));
  const Event delta = watcher.next();
  ASSERT_EQ(delta.name, "delta");
  EXPECT_EQ(delta.json.at("full"), true);
  EXPECT_EQ(delta.json.at("planes").size(), 3u);
  EXPECT_EQ(delta.json.at("blocksChanged"), site.service().snapshot()->block_count());
  const Event pose = watcher.next("pose");
  EXPECT_EQ(pose.json.at("utime"), site.service().snapshot()->utime());
  EXPECT_NEAR(pose.json.at("position")[1].get<double>(), 1.1, 1e-12);
  EXPECT_EQ(pose.json.at("orientation").size(), 4u);
  EXPECT_EQ(watcher.next("status").json.at("planeCount"), 3);
}

TEST(HttpEvents, BringAMirrorToEveryMap) {
  TestSite site;
  Watcher watcher(site.port());
  site.room().look_around();
  auto snapshot = site.service().snapshot();
  ASSERT_TRUE(watcher.reach(snapshot->epoch(), snapshot->revision()));
  EXPECT_EQ(watcher.planes(), planes_of(site));
  site.room().join_walls();
  snapshot = site.service().snapshot();
  ASSERT_TRUE(watcher.reach(snapshot->epoch(), snapshot->revision()));
  EXPECT_EQ(watcher.planes().size(), 2u) << "a merged plane is taken back";
  EXPECT_EQ(watcher.planes(), planes_of(site));
  ASSERT_TRUE(site.service().mapping().reset(seconds(30)));
  snapshot = site.service().snapshot();
  ASSERT_TRUE(watcher.reach(snapshot->epoch(), snapshot->revision()));
  EXPECT_TRUE(watcher.planes().empty()) << "a new map begins with everything";
}

TEST(HttpEvents, GoOnWithHeartbeatsWhenNothingHappens) {
  ServiceConfig config = http_test_config();
  config.http.heartbeat_s = 0.1;
  TestSite site(config);
  Watcher watcher(site.port());
  EXPECT_EQ(watcher.next(":").name, ":");
  EXPECT_EQ(watcher.next("status").name, "status");
  EXPECT_EQ(watcher.next(":").name, ":");
  EXPECT_EQ(watcher.next("status").name, "status") << "once in a second";
}

TEST(HttpEvents, StreamsBeyondTheLimitAreToldSo) {
  ServiceConfig config = http_test_config();
  config.http.max_event_streams = 2;
  TestSite site(config);
  auto first = std::make_unique<Watcher>(site.port());
  Watcher second(site.port());
  EXPECT_EQ(first->next("hello").name, "hello");
  EXPECT_EQ(second.next("hello").name, "hello");
  const HttpReply refused = site.get("/api/v1/events");
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(Json::parse(refused.body).at("error"), "2 event streams are served already (http.max_event_streams)");
  EXPECT_EQ(site.get("/healthz").status, 200);
  first.reset();
  EXPECT_TRUE(eventually([&] { return Watcher(site.port()).next("hello").name == "hello"; }))
      << "its room is free again";
}

TEST(HttpEvents, AReaderThatSleepsGetsTheChangesInOne) {
  TestSite site;
  Watcher awake(site.port());
  Watcher asleep(site.port());
  ASSERT_EQ(asleep.next("delta").name, "delta");
  // Enough that the sockets' buffers are full for whoever does not read.
  std::uint64_t revision = 0;
  for (int i = 0; i < 60; ++i) {
    site.room().look_at_wall(0.1 * i);
    revision = site.service().snapshot()->revision();
    ASSERT_TRUE(awake.reach(1234, revision));
  }
  ASSERT_TRUE(asleep.reach(1234, revision));
  EXPECT_LE(asleep.deltas(), awake.deltas());
  EXPECT_EQ(asleep.planes(), awake.planes());
  EXPECT_EQ(asleep.planes(), planes_of(site));
}

TEST(HttpEvents, EndWithTheServerWithinASecond) {
  TestSite site;
  site.room().look_around();
  Watcher first(site.port());
  Watcher second(site.port());
  EXPECT_EQ(first.next("delta").name, "delta");
  EXPECT_EQ(second.next("hello").name, "hello");
  const auto begin = std::chrono::steady_clock::now();
  site.server().stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, seconds(1));
  EXPECT_TRUE(first.client().is_closed_within(seconds(30)));
  EXPECT_TRUE(second.client().is_closed_within(seconds(30)));
}

}  // namespace
}  // namespace planemap::service
