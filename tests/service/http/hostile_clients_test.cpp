// Clients that do not behave: others are served all the same.

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "test_site.hpp"

namespace planemap::service {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Requests that are there whole, on a connection of their own, one after the other.
void expect_others_are_served(const TestSite& site) {
  for (const char* target : {"/healthz", "/readyz", "/metrics", "/api/v1/planes", "/api/v1/cells", "/"}) {
    EXPECT_EQ(site.get(target).status, 200) << target;
  }
}

TEST(HostileClients, TwoHundredThatSitThereKeepNobodyOut) {
  TestSite site;
  site.room().look_around();
  std::vector<std::unique_ptr<TcpClient>> idle;
  for (int i = 0; i < 200; ++i) {
    idle.push_back(std::make_unique<TcpClient>(site.port()));
    if (i % 50 == 0) expect_others_are_served(site);
  }
  expect_others_are_served(site);
  EXPECT_TRUE(idle.front()->is_closed_within(seconds(30))) << "the oldest made room";
  EXPECT_GE(site.counter("http.connections.closed_idle"), 200 - http_test_config().http.max_connections);
  EXPECT_EQ(site.counter("http.connections.refused"), 0);
}

TEST(HostileClients, RequestsThatComeDropByDropKeepNobodyOut) {
  ServiceConfig config = http_test_config();
  config.http.max_connections = 8;
  config.http.max_event_streams = 2;
  TestSite site(config);
  std::vector<std::unique_ptr<TcpClient>> slow;
  for (int i = 0; i < 8; ++i) slow.push_back(std::make_unique<TcpClient>(site.port()));
  for (const char drop : std::string("GET / HTTP/1.1\r\nHost: localhost\r\nX: ")) {
    for (auto& client : slow) client->send(std::string(1, drop));
    EXPECT_EQ(site.get("/healthz").status, 200);
  }
  expect_others_are_served(site);
}

TEST(HostileClients, WhoNeverEndsARequestIsClosedInTime) {
  TestSite site;
  TcpClient client(site.port());
  client.send("GET / HTTP/1.1\r\nX: ");
  const auto begin = std::chrono::steady_clock::now();
  while (!client.is_closed_within(milliseconds(200))) {
    client.send("a");
    ASSERT_LT(std::chrono::steady_clock::now() - begin, seconds(40));
  }
  EXPECT_GE(std::chrono::steady_clock::now() - begin, seconds(9)) << "ten seconds for the whole";
}

TEST(HostileClients, WhereAllConnectionsAreServedTheNextIsToldSo) {
  ServiceConfig config = http_test_config();
  config.http.max_connections = 2;
  config.http.max_event_streams = 1;
  TestSite site(config);
  TcpClient watcher(site.port());
  watcher.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_NE(watcher.read_until("event: hello"), "");
  TcpClient idle(site.port());
  EXPECT_EQ(site.get("/healthz").status, 200) << "the idle one makes room";
  EXPECT_TRUE(idle.is_closed_within(seconds(30)));
  EXPECT_NE(watcher.read_until("event: status"), "") << "who is served is not closed";
}

TEST(HostileClients, AWatcherThatStopsReadingHoldsNobodyUp) {
  TestSite site;
  site.room().look_around();
  TcpClient sleeper(site.port());
  sleeper.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  TcpClient awake(site.port());
  awake.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_NE(awake.read_until("event: delta"), "");
  for (int i = 0; i < 40; ++i) {
    site.room().look_at_wall(0.1 * i);
    const std::string wanted = "\"revision\":" + std::to_string(site.service().snapshot()->revision());
    ASSERT_NE(awake.read_until(wanted).find(wanted), std::string::npos) << i;
  }
  expect_others_are_served(site);
}

TEST(HostileClients, AnAnswerThatNobodyTakesHoldsNoThreadAndIsGivenUp) {
  ServiceConfig config = http_test_config();
  config.http.threads = 1;
  TestSite site(config);
  for (int i = 0; i < 60; ++i) site.room().look_at_wall(1.0 * i);
  std::vector<std::unique_ptr<TcpClient>> sleepers;
  for (int i = 0; i < 20; ++i) {
    sleepers.push_back(std::make_unique<TcpClient>(site.port()));
    std::string requests;
    for (int k = 0; k < 200; ++k) requests += "GET /api/v1/cells HTTP/1.1\r\nHost: localhost\r\n\r\n";
    sleepers.back()->send(requests);
  }
  expect_others_are_served(site);
  EXPECT_TRUE(eventually([&] { return !sleepers.back()->send("x"); })) << "closed after ten seconds";
}

TEST(HostileClients, RequestsBeyondThoseThatMayWaitAreToldSo) {
  ServiceConfig config = http_test_config();
  config.http.threads = 1;
  config.http.max_waiting_requests = 1;
  TestSite site(config);
  for (int i = 0; i < 30; ++i) site.room().look_at_wall(1.0 * i);
  std::vector<std::unique_ptr<TcpClient>> clients;
  for (int i = 0; i < 40; ++i) {
    clients.push_back(std::make_unique<TcpClient>(site.port()));
    clients.back()->send("GET /api/v1/export/planes.svg HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  int refused = 0;
  for (auto& client : clients) {
    const HttpReply reply = read_reply(*client);
    if (reply.status == 200) continue;
    ++refused;
    EXPECT_EQ(reply.status, 503);
    EXPECT_EQ(nlohmann::json::parse(reply.body).at("error"),
              "1 requests wait already (http.max_waiting_requests); ask again later");
  }
  EXPECT_GE(refused, 1);
  EXPECT_EQ(site.get("/healthz").status, 200);
}

TEST(HostileClients, AnyBytesAreAnsweredOrClosed) {
  TestSite site;
  std::uint32_t state = 12345;
  const auto random = [&state] { return state = state * 1664525u + 1013904223u; };
  const std::string good = "GET /api/v1/planes?a=b HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n";
  for (int i = 0; i < 300; ++i) {
    std::string bytes = good;
    for (int changes = 1 + static_cast<int>(random() >> 30); changes > 0; --changes) {
      bytes[(random() >> 8) % bytes.size()] = static_cast<char>(random() >> 24);
    }
    TcpClient client(site.port());
    client.send(bytes.substr(0, (random() >> 8) % bytes.size() + 1));
  }
  EXPECT_EQ(site.get("/healthz").status, 200);
}

}  // namespace
}  // namespace planemap::service
