// The client over gRPC where things go wrong: addresses, servers that are not there, TLS and tokens, answers that are
// not sound. That it answers right is shown by the suite of all clients.
#include <gtest/gtest.h>

#include <cmath>
#include <planemap/client/grpc_map_admin.hpp>
#include <planemap/client/grpc_map_client.hpp>
#include <vector>

#include "fake_grpc_service.hpp"
#include "server_address.hpp"
#include "support/certificates.hpp"
#include "support/grpc_door.hpp"
#include "support/room_service.hpp"

namespace planemap::client {
namespace {

using std::chrono::milliseconds;
using Kind = Error::Kind;

constexpr milliseconds kLong(30000);
constexpr const char* kReader = "reader-0123456789abcdef";
constexpr const char* kAdmin = "admin-0123456789abcdef";

std::unique_ptr<GrpcMapClient> client_of(const std::string& server, const GrpcClientOptions& options = {}) {
  auto client = GrpcMapClient::connect(server, options);
  if (!client) throw std::runtime_error(client.error().message);
  return std::move(*client);
}

template <class Answer>
void expect_error(const Answer& answer, Kind kind, const std::string& words) {
  ASSERT_FALSE(answer) << words;
  EXPECT_EQ(answer.error().kind, kind) << answer.error().message;
  EXPECT_NE(answer.error().message.find(words), std::string::npos) << answer.error().message << "\nnot\n" << words;
}

TEST(ServerAddress, IsAHostAndPerhapsAPort) {
  const std::pair<const char*, const char*> good[] = {
      {"robot", "robot:7670"},        {"robot.local:80", "robot.local:80"},
      {"127.0.0.1:1", "127.0.0.1:1"}, {"[::1]:65535", "[::1]:65535"},
      {"::1", "[::1]:7670"},          {"[fe80::1]", "[fe80::1]:7670"},
  };
  for (const auto& [text, meant] : good) {
    const auto address = parse_server_address(text);
    ASSERT_TRUE(address) << text;
    EXPECT_EQ(address->text(), meant);
  }
  for (const char* text : {"", ":7670", "robot:", "robot:0", "robot:65536", "robot:port", "[::1", "[::1]7670", "a b",
                           "http://robot:7670", "unix:/run/planemap"}) {
    expect_error(parse_server_address(text), Kind::kNoNetwork,
                 std::string("'") + text + "' is no address of a server: it must be HOST, HOST:PORT or [IPv6]:PORT");
  }
  for (const char* text : {"localhost", "127.0.0.1", "127.8.9.10", "::1"}) {
    EXPECT_TRUE(parse_server_address(text)->is_loopback()) << text;
  }
  for (const char* text : {"robot", "10.0.0.1", "127.0.0.1.example.org", "::2"}) {
    EXPECT_FALSE(parse_server_address(text)->is_loopback()) << text;
  }
}

TEST(GrpcClientOptions, ThatCannotBeUsedAreRefused) {
  const auto problem = [](const GrpcClientOptions& options, const char* words) {
    expect_error(GrpcMapClient::connect("robot", options), Kind::kNoNetwork, words);
  };
  GrpcClientOptions options;
  options.ca = "nothing";
  problem(options, "ca: holds no certificate in PEM");
  options = {};
  options.client_key = "-----BEGIN PRIVATE KEY-----";
  problem(options, "client_certificate, client_key: each needs the other");
  options.client_certificate = "nothing";
  problem(options, "client_certificate, client_key: are not both in PEM");
  options = {};
  options.token = "two words";
  problem(options, "token: must be of printable ASCII characters, without blanks");
  options.token = kReader;
  problem(options, "token: would go to robot:7670 for everybody to read");
  options.tls = true;
  EXPECT_TRUE(GrpcMapClient::connect("robot", options));
}

/// A port of the loopback on which nobody listens any more.
std::string deserted_address() {
  FakeGrpcService fake;
  return fake.address();
}

TEST(GrpcMapClient, SaysWhereNobodyListens) {
  const std::string server = deserted_address();
  const auto client = client_of(server);
  expect_error(client->status(kLong), Kind::kUnreachable, "no planemapd can be reached at " + server + " (");
  expect_error(client->snapshot(kLong), Kind::kUnreachable, "no planemapd can be reached at " + server);
  const auto watch = client->watch();
  expect_error(watch->next(milliseconds(300)), Kind::kUnreachable, "no planemapd can be reached at " + server);
}

TEST(GrpcMapClient, WaitsNoLongerThanItsTimeout) {
  FakeGrpcService fake;
  fake.hold_calls();
  const auto client = client_of(fake.address());
  expect_error(client->status(milliseconds(100)), Kind::kUnreachable,
               "no answer came from " + fake.address() + " within 0.1 s");
  expect_error(client->region({Sphere{{}, 1.0}, false, false, {}}, milliseconds(100)), Kind::kUnreachable,
               "within 0.1 s");
  fake.release_calls();
}

TEST(GrpcMapClient, SaysHowTheServiceEndedACall) {
  const auto told = [](const grpc::Status& status) {
    FakeGrpcService fake;
    fake.end_with(status);
    const auto answer = client_of(fake.address())->status(kLong);
    EXPECT_FALSE(answer);
    return std::pair(answer.error().kind, answer.error().message.substr(answer.error().message.find(": ") + 2));
  };
  const auto cancelled = told({grpc::StatusCode::CANCELLED, "of its own"});
  EXPECT_EQ(cancelled.first, Kind::kUnreachable) << "asking again may help";
  EXPECT_NE(cancelled.second.find(" ended the call (of its own)"), std::string::npos) << cancelled.second;
  const auto internal = told({grpc::StatusCode::INTERNAL, "it broke"});
  EXPECT_EQ(internal.first, Kind::kMalformed);
  EXPECT_EQ(internal.second, "it broke (gRPC status 13); is a planemapd listening there?");
}

TEST(GrpcMapClient, SaysThatAnAnswerCameInPart) {
  FakeGrpcService fake;
  fake.add_page();  // not the last
  fake.hold_calls_after_pages();
  expect_error(client_of(fake.address())->snapshot(milliseconds(200)), Kind::kIncomplete,
               "the answer came in part only (1 pages); then no answer came from");
  fake.release_calls();
}

TEST(GrpcMapClient, TakesNoAnswerThatIsNotSound) {
  FakeGrpcService fake;
  const auto client = client_of(fake.address());
  const auto expect_unsound = [&] {
    expect_error(client->snapshot(kLong), Kind::kMalformed, "the service's answer cannot be used: ");
    fake.clear_pages();
  };
  const auto one_plane = [&]() -> v1::Plane& {
    v1::SnapshotPage& page = fake.add_page();
    page.set_last(true);
    *page.add_planes() = sound_plane();
    return *page.mutable_planes(0);
  };
  one_plane();
  EXPECT_TRUE(client->snapshot(kLong));
  fake.clear_pages();
  one_plane().set_id(0);
  expect_unsound();
  one_plane().set_id(std::uint64_t{1} << 53u);
  expect_unsound();
  one_plane().mutable_normal()->set_x(std::nan(""));
  expect_unsound();
  one_plane().mutable_covariance()->RemoveLast();
  expect_unsound();
  one_plane().set_plane_class(static_cast<v1::PlaneClass>(17));
  expect_unsound();
  one_plane().mutable_outline()->mutable_polygons(0)->mutable_outer()->add_uv_m(1.0F);
  expect_unsound();
  one_plane().mutable_outline()->mutable_polygons(0)->add_holes()->add_uv_m(1.0F);
  expect_unsound();

  fake.add_page().set_page(1);  // the first is missing
  expect_unsound();
  fake.add_page();
  fake.add_page().mutable_map()->set_revision(9);  // of another revision
  expect_unsound();
  fake.add_page();  // the last is missing
  expect_unsound();
  fake.add_page().set_last(true);
  fake.add_page();  // one after the last
  expect_unsound();

  const std::vector<QueryPoint> points(2);
  expect_error(client->nearest(points, {}, kLong), Kind::kMalformed, "the planes near the points");  // an empty answer
}

TEST(GrpcMapClient, ManyItemsAreOfOneRevisionOrOfNone) {
  FakeGrpcService fake;
  fake.change_with_each_answer();
  const std::vector<QueryPoint> points(6000);
  expect_error(client_of(fake.address())->nearest(points, {}, milliseconds(300)), Kind::kIncomplete,
               "the map changed faster than all could be asked of one revision; there was no answer within 0.3 s");
}

TEST(GrpcMapClient, ManyItemsAreAnsweredByOneMapHoweverFastItChanges) {
  FakeGrpcService fake;
  fake.keep_maps_that_are_named();
  const auto client = client_of(fake.address());
  const std::vector<QueryPoint> points(12000);
  const auto near = client->nearest(points, {}, kLong);
  ASSERT_TRUE(near) << near.error().message;
  EXPECT_EQ(near->version.revision, 1);
  EXPECT_EQ(near->points.size(), 12000u);
  using Batches = std::vector<std::pair<int, std::uint64_t>>;
  EXPECT_EQ(fake.batches(), (Batches{{5000, 1}, {5000, 1}, {2000, 1}}));
  fake.forget_map();
  const auto anew = client->nearest(points, {}, kLong);
  ASSERT_TRUE(anew) << anew.error().message;
  EXPECT_EQ(anew->version.revision, 5);
  EXPECT_EQ(anew->points.size(), 12000u);
  EXPECT_EQ(fake.batches(), (Batches{{5000, 1}, {5000, 1}, {2000, 1}, {5000, 4}, {5000, 5}, {5000, 5}, {2000, 5}}));
}

TEST(GrpcMapClient, AMapOfManyPagesIsWhole) {
  FakeGrpcService fake;
  for (std::uint32_t page = 0; page < 5; ++page) {
    v1::SnapshotPage& message = fake.add_page();
    message.set_page(page);
    message.set_last(page == 4);
    for (std::uint64_t i = 1; i <= 100; ++i) {
      *message.add_planes() = sound_plane();
      message.mutable_planes(static_cast<int>(i) - 1)->set_id(100 * page + i);
    }
  }
  const auto map = client_of(fake.address())->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_EQ(map->planes.size(), 500u);
  EXPECT_EQ(map->planes[499].id, 500);
  EXPECT_EQ(map->frame, "world");
}

class GrpcTls : public testing::Test {
 protected:
  service::ServiceConfig config() const {
    auto config = RoomService::default_config();
    config.grpc.tls_certificate = certificates_.path("server.crt");
    config.grpc.tls_key = certificates_.path("server.key");
    return config;
  }
  GrpcClientOptions trusting(const std::string& authority) const {
    GrpcClientOptions options;
    options.ca = certificates_.text(authority + ".crt");
    return options;
  }

  const Certificates certificates_;
  RoomService room_;
};

TEST_F(GrpcTls, TheServersCertificateIsChecked) {
  const GrpcDoor door(room_.service(), config());
  const auto status = client_of(door.address(), trusting("ca"))->status(kLong);
  EXPECT_TRUE(status) << status.error().message;
  expect_error(client_of(door.address(), trusting("other-ca"))->status(kLong), Kind::kUnreachable,
               "no planemapd can be reached at " + door.address() + " over TLS (");
  auto misnamed = trusting("ca");
  misnamed.server_name = "robot";
  expect_error(client_of(door.address(), misnamed)->status(kLong), Kind::kUnreachable, " over TLS (");
  misnamed.server_name = "localhost";
  EXPECT_TRUE(client_of(door.address(), misnamed)->status(kLong));
  expect_error(client_of(door.address())->status(kLong), Kind::kUnreachable, "if it speaks TLS, name its authority");
}

TEST_F(GrpcTls, ClientsShowTheirCertificate) {
  auto with_clients = config();
  with_clients.grpc.tls_client_ca = certificates_.path("ca.crt");
  const GrpcDoor door(room_.service(), with_clients);
  auto options = trusting("ca");
  expect_error(client_of(door.address(), options)->status(kLong), Kind::kUnreachable, " over TLS (");
  options.client_certificate = certificates_.text("client.crt");
  options.client_key = certificates_.text("client.key");
  const auto status = client_of(door.address(), options)->status(kLong);
  EXPECT_TRUE(status) << status.error().message;
}

class GrpcTokens : public testing::Test {
 protected:
  GrpcTokens() {
    folder_.write("tokens", std::string("read ") + kReader + "\nadmin " + kAdmin + "\n");
    auto config = RoomService::default_config();
    config.grpc.token_file = (folder_ / "tokens").string();
    door_ = std::make_unique<GrpcDoor>(room_.service(), config);
  }
  static GrpcClientOptions with_token(const std::string& token) {
    GrpcClientOptions options;
    options.token = token;
    return options;
  }
  GrpcMapAdmin admin(const std::string& token) const {
    return GrpcMapAdmin(*GrpcConnection::open(door_->address(), with_token(token)));
  }

  TemporaryFolder folder_;
  RoomService room_;
  std::unique_ptr<GrpcDoor> door_;
};

TEST_F(GrpcTokens, AreSentWithEveryCall) {
  const auto client = client_of(door_->address(), with_token(kReader));
  EXPECT_TRUE(client->status(kLong));
  EXPECT_TRUE(client->whole_map(kLong));
  EXPECT_TRUE(client->nearest(std::vector<QueryPoint>(1), {}, kLong));
  EXPECT_TRUE(client->region({Sphere{{}, 1.0}, false, false, {}}, kLong));
  EXPECT_EQ(client->plane(1, kLong)->fate, PlaneFate::kUnknown);
  EXPECT_TRUE(client->watch()->next(kLong));
}

TEST_F(GrpcTokens, OnesThatAreMissingOrUnknownAreSaidToBe) {
  const auto none = client_of(door_->address());
  expect_error(none->status(kLong), Kind::kDenied,
               "the service refused the request: this call needs a token of scope read");
  expect_error(none->watch()->next(kLong), Kind::kDenied, "this call needs a token of scope read");
  expect_error(client_of(door_->address(), with_token("unknown-0123456789"))->status(kLong), Kind::kDenied,
               "the token is not known");
}

TEST_F(GrpcTokens, OfScopeAdminChangeWhatTheServiceDoes) {
  expect_error(admin(kReader).pause(kLong), Kind::kDenied, "the token is of scope read, this call needs admin");
  auto by_admin = admin(kAdmin);
  EXPECT_TRUE(by_admin.pause(kLong));
  EXPECT_TRUE(room_.service().mapping().is_paused());
  EXPECT_TRUE(by_admin.resume(kLong));
  EXPECT_FALSE(room_.service().mapping().is_paused());
  const auto epoch = by_admin.reset(kLong);
  ASSERT_TRUE(epoch) << epoch.error().message;
  EXPECT_GT(*epoch, 1234);
  expect_error(by_admin.save(kLong), Kind::kRefused, "the map has no file: planemapd --map FILE");
}

}  // namespace
}  // namespace planemap::client
