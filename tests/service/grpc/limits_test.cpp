// What the server takes at most, and that it goes on behind a limit.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <optional>

#include "test_daemon.hpp"

namespace planemap::service {
namespace {

using grpc::StatusCode;

/// A connection that says nothing.
class Socket {
 public:
  explicit Socket(std::uint16_t port) : descriptor_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("connect failed");
    }
  }
  ~Socket() { close(descriptor_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Waits for the other side to close.
  bool is_closed_by_peer() {
    pollfd waited{descriptor_, POLLIN, 0};
    char byte = 0;
    while (poll(&waited, 1, 20000) > 0) {
      const auto size = recv(descriptor_, &byte, 1, 0);
      if (size <= 0) return true;  // closed or reset
    }
    return false;
  }

 private:
  int descriptor_;
};

TEST(Limits, ConnectionsBeyondTheLimitAreClosedAndCounted) {
  auto config = test_config();
  config.grpc.max_connections = 2;
  TestDaemon daemon(config);
  const auto port = daemon.server().port();
  {
    Socket first(port);
    Socket second(port);
    ASSERT_TRUE(daemon.handle_until([&] { return daemon.counter("grpc.connections.accepted") == 2; }));
    Socket third(port);
    EXPECT_TRUE(third.is_closed_by_peer());
    EXPECT_EQ(daemon.counter("grpc.connections.refused"), 1);
  }
  // Once they have gone there is room again.
  const auto context = new_context();
  context->set_wait_for_ready(true);
  v1::GetStatusResponse response;
  const auto status = daemon.stub()->GetStatus(context.get(), {}, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST(Limits, StreamsBeyondTheLimitAreRefused) {
  auto config = test_config();
  config.grpc.max_streams = 2;
  TestDaemon daemon(config);
  const auto stub = daemon.stub();
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<grpc::ClientReader<v1::WatchEvent>>> readers;
  v1::WatchEvent event;
  for (int i = 0; i < 2; ++i) {
    contexts.push_back(new_context());
    readers.push_back(stub->Watch(contexts.back().get(), {}));
    ASSERT_TRUE(readers.back()->Read(&event));
  }
  const std::string words = "2 watchers and answers in pages are served already (grpc.max_streams)";
  expect_error(read_all(*stub->Watch(new_context().get(), {})).second, StatusCode::RESOURCE_EXHAUSTED, words);
  expect_error(read_all(*stub->GetSnapshot(new_context().get(), {})).second, StatusCode::RESOURCE_EXHAUSTED, words);
  v1::GetStatusResponse response;
  EXPECT_TRUE(stub->GetStatus(new_context().get(), {}, &response).ok());  // others go on
  for (auto& context : contexts) context->TryCancel();
  for (auto& reader : readers) reader->Finish();
  ASSERT_TRUE(daemon.handle_until([&] { return read_all(*stub->GetSnapshot(new_context().get(), {})).second.ok(); }));
}

TEST(Limits, CallsBeyondThoseOfOneConnectionWaitForTheirTurn) {
  auto config = test_config();
  config.grpc.max_streams_per_connection = 1;
  TestDaemon daemon(config);
  const auto stub = daemon.stub();
  const auto context = new_context();
  const auto reader = stub->Watch(context.get(), {});
  v1::WatchEvent event;
  ASSERT_TRUE(reader->Read(&event));
  const auto waiting = std::make_unique<grpc::ClientContext>();
  waiting->set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(300));
  v1::GetStatusResponse response;
  EXPECT_EQ(stub->GetStatus(waiting.get(), {}, &response).error_code(), StatusCode::DEADLINE_EXCEEDED);
  context->TryCancel();
  reader->Finish();
  EXPECT_TRUE(stub->GetStatus(new_context().get(), {}, &response).ok());
}

TEST(Limits, RequestsThatAreTooLargeAreRefused) {
  auto config = test_config();
  config.grpc.max_request_bytes = 1024;
  TestDaemon daemon(config);
  v1::NearestPlanesRequest request;
  for (int i = 0; i < 100; ++i) request.add_points()->mutable_point_m()->set_x(i + 0.5);
  v1::NearestPlanesResponse response;
  expect_error(daemon.stub()->NearestPlanes(new_context().get(), request, &response), StatusCode::RESOURCE_EXHAUSTED,
               "larger than max (");
}

TEST(Limits, AnAddressThatOthersUseIsRefusedAtTheStart) {
  TestDaemon daemon;
  auto config = test_config();
  config.grpc.listen = daemon.server().address();
  try {
    const TestDaemon second(config);
    ADD_FAILURE() << "two servers on " << config.grpc.listen;
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(e.what(), "grpc.listen: cannot listen on 127.0.0.1 port " + std::to_string(daemon.server().port()) +
                            ": Address already in use");
  }
}

TEST(Limits, IPv6LoopbackIsServed) {
  auto config = test_config();
  config.grpc.listen = "[::1]:0";
  std::optional<TestDaemon> daemon;
  try {
    daemon.emplace(config);
  } catch (const std::runtime_error& e) {
    GTEST_SKIP() << "this machine has no IPv6: " << e.what();
  }
  EXPECT_EQ(daemon->server().address().rfind("[::1]:", 0), 0u);
  v1::PauseResponse response;  // the caller counts as one on loopback
  const auto status = daemon->admin()->Pause(new_context().get(), {}, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
}

}  // namespace
}  // namespace planemap::service
