// The server itself: life, health, and what it refuses.

#include <atomic>
#include <future>
#include <thread>

#include "test_site.hpp"

namespace planemap::service {
namespace {

using std::chrono::seconds;

std::string problem_of(const ServiceConfig& config) {
  try {
    TestSite site(config);
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

TEST(HttpServer, AnswersOnAnyFreePort) {
  TestSite site;
  EXPECT_EQ(site.server().url(), "http://127.0.0.1:" + std::to_string(site.port()) + "/");
  const HttpReply reply = site.get("/healthz");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body, "ok\n");
  EXPECT_EQ(reply.header("content-security-policy"), "default-src 'self'");
  EXPECT_EQ(reply.header("x-content-type-options"), "nosniff");
  EXPECT_EQ(site.counter("http.requests.200"), 1);
}

TEST(HttpServer, KeepsAConnectionForTheNextRequests) {
  TestSite site;
  TcpClient client(site.port());
  for (int i = 0; i < 3; ++i) {
    client.send("GET /readyz HTTP/1.1\r\nHost: 127.0.0.1:1\r\n\r\n");
    EXPECT_EQ(read_reply(client).status, 200);
  }
  client.send("GET /healthz HTTP/1.1\r\nHost: [::1]\r\n\r\nGET /readyz HTTP/1.1\r\nHost: LOCALHOST\r\n\r\n");
  EXPECT_EQ(read_reply(client).status, 200);
  EXPECT_EQ(read_reply(client).status, 200);
  EXPECT_EQ(site.counter("http.connections.accepted"), 1);
  client.send("HEAD /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const HttpReply head = read_reply(client, false);
  EXPECT_EQ(head.header("content-length"), "3");
  client.send("GET /healthz HTTP/1.0\r\n\r\n");
  EXPECT_EQ(read_reply(client).body, "ok\n") << "HEAD has no body, and HTTP/1.0 needs no Host";
  EXPECT_TRUE(client.is_closed_within(seconds(30)));
}

TEST(HttpServer, SaysWhoHasItsPort) {
  TestSite site;
  ServiceConfig config = http_test_config();
  config.http.listen = "127.0.0.1:" + std::to_string(site.port());
  EXPECT_EQ(problem_of(config),
            "http.listen: cannot listen on 127.0.0.1 port " + std::to_string(site.port()) +
                ": Address already in use; stop what listens there (another planemapd?), or choose another port, or "
                "none: --set http.listen=127.0.0.1:0 takes any free one, --set http.listen= does without the viewer");
}

TEST(HttpServer, ListensOffTheLoopbackOnlyIfAskedTo) {
  ServiceConfig config = http_test_config();
  config.http.listen = "0.0.0.0:0";
  EXPECT_EQ(problem_of(config), "http.listen: 0.0.0.0:0 can be reached from other machines: http.allow_remote");
  config.http.allow_remote = true;
  TestSite site(config);
  TcpClient client(site.port());
  client.send("GET /healthz HTTP/1.1\r\nHost: robot.example.org\r\n\r\n");
  EXPECT_EQ(read_reply(client).status, 200) << "names of a machine on a network are not known to it";
}

TEST(HttpServer, StartsAgainOnTheSamePort) {
  ServiceConfig config = http_test_config();
  {
    TestSite site(config);
    config.http.listen = "127.0.0.1:" + std::to_string(site.port());
    TcpClient client(site.port());
    client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(read_reply(client).status, 200);
    site.server().stop();
    EXPECT_TRUE(client.is_closed_within(seconds(30)));
  }
  EXPECT_EQ(problem_of(config), "");
}

struct Refusal {
  std::string request;
  int status;
  std::string words;
};

TEST(HttpServer, RefusesInSentences) {
  TestSite site;
  const std::string host = "Host: localhost\r\n";
  const std::vector<Refusal> refusals = {
      {"POST /api/v1/planes HTTP/1.1\r\n" + host + "Content-Length: 3\r\n\r\nabc", 405,
       "POST is not taken here: the interface is read only, by GET and HEAD; change the map over gRPC"},
      {"DELETE / HTTP/1.1\r\n" + host + "\r\n", 405, "DELETE is not taken here"},
      {"BREW / HTTP/1.1\r\n" + host + "\r\n", 405, "BREW is not taken here"},
      {"GET / HTTP/1.1\r\nHost: planes.example.org\r\n\r\n", 400,
       "the Host header names planes.example.org, and this server answers to localhost, 127.0.0.1 and [::1] only"},
      {"GET / HTTP/1.1\r\nHost: localhost.example.org\r\n\r\n", 400, "the Host header names localhost.example.org"},
      {"GET / HTTP/1.1\r\nHost: [\r\n\r\n", 400, "the Host header names ["},
      {"GET / HTTP/1.1\r\n\r\n", 400, "the request has no Host header"},
      {"GET / HTTP/1.1\r\n" + host + host + "\r\n", 400, "more than one Host header"},
      {"GET http://localhost/ HTTP/1.1\r\n" + host + "\r\n", 400, "must be a path that begins with /"},
      {"GET /%4 HTTP/1.1\r\n" + host + "\r\n", 400, "wrong % sequence"},
      {"GET /%00 HTTP/1.1\r\n" + host + "\r\n", 400, "a control character"},
      {"GET /nowhere HTTP/1.1\r\n" + host + "\r\n", 404, "there is nothing at /nowhere"},
      {"GET /%ff%22 HTTP/1.1\r\n" + host + "\r\n", 404, "there is nothing at /\xEF\xBF\xBD\\\""},
      {"GET / HTTP/1.1\r\n" + host + "Content-Length: 10\r\n\r\n0123456789", 413, "requests have no body here"},
      {"GET / HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 413, "requests have no body here"},
      {"GET /" + std::string(3000, 'a') + " HTTP/1.1\r\n" + host + "\r\n", 414,
       "the URL is 3001 bytes long, 2048 are taken"},
      {"GET / HTTP/1.1\r\n" + host + "X: " + std::string(9000, 'a') + "\r\n\r\n", 431,
       "the request's line and headers are longer than 8192 bytes"},
      {"nonsense\r\n\r\n", 400, "this is no HTTP request: "},
      {std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 15), 400, "this is no HTTP request: "},
  };
  for (const Refusal& refusal : refusals) {
    TcpClient client(site.port());
    client.send(refusal.request);
    const HttpReply reply = read_reply(client);
    EXPECT_EQ(reply.status, refusal.status) << refusal.request.substr(0, 80);
    EXPECT_NE(reply.body.find(refusal.words), std::string::npos) << reply.body << "\nnot\n" << refusal.words;
    EXPECT_EQ(reply.header("content-type"), "application/json");
  }
  EXPECT_EQ(site.get("/healthz").status, 200);
}

TEST(HttpServer, AnUrlWithoutEndIsAnsweredAtItsLimit) {
  TestSite site;
  TcpClient client(site.port());
  client.send("GET /");
  const std::string piece(100000, 'a');
  for (int i = 0; i < 100 && client.send(piece); ++i) {
  }
  EXPECT_TRUE(client.is_closed_within(seconds(30)));
  EXPECT_EQ(site.counter("http.requests.431"), 1);
}

TEST(HealthOverHttp, IsReadyFromStartToEnd) {
  TestSite site;
  EXPECT_EQ(site.get("/readyz").body, "ok\n");
  site.service().health().end();
  const HttpReply ending = site.get("/readyz");
  EXPECT_EQ(ending.status, 503);
  EXPECT_EQ(ending.body, "planemapd is ending\n");
  EXPECT_EQ(site.get("/healthz").status, 200) << "it lives until it is gone";
}

TEST(HealthOverHttp, IsNotReadyWhileStarting) {
  RoomService room(http_test_config());
  const auto started = HttpServer::start(room.config(), room.service());
  ASSERT_TRUE(started);
  const HttpReply reply = http_get((*started)->port(), "/readyz");
  EXPECT_EQ(reply.status, 503);
  EXPECT_EQ(reply.body, "planemapd is starting\n");
}

TEST(Health, TellsAMapperThatHangs) {
  RoomService room;
  const Health health(room.service().mapping(), 2.0);
  std::promise<void> release;
  const auto released = release.get_future().share();
  std::atomic<bool> hangs = false;
  room.service().mapping().set_scan_listener([released, &hangs](const MappedScan&) {
    hangs = true;
    released.wait();
  });
  room.send_look({0.0, 0.0, 1.0}, -Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitX());
  ASSERT_TRUE(eventually([&] {
    room.service().handle(5);
    return hangs.load();
  }));
  const double now_s = steady_now_s();
  EXPECT_TRUE(health.liveness(now_s).is_good);
  const HealthReport report = health.liveness(now_s + 100.0);
  EXPECT_FALSE(report.is_good);
  EXPECT_TRUE(report.reason.starts_with("the mapper has been at one scan for 10")) << report.reason;
  release.set_value();
  EXPECT_TRUE(eventually([&] { return health.liveness(steady_now_s() + 100.0).is_good; }));
}

}  // namespace
}  // namespace planemap::service
