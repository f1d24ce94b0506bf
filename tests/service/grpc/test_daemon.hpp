#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <planemap/v1/admin_service.grpc.pb.h>
#include <planemap/v1/planemap_service.grpc.pb.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "serve/grpc/grpc_server.hpp"
#include "service.hpp"
#include "support/messages.hpp"

namespace planemap::service {

constexpr std::chrono::seconds kPatience(30);

/// A call's context: nothing waits longer than half a minute.
inline std::unique_ptr<grpc::ClientContext> new_context() {
  auto context = std::make_unique<grpc::ClientContext>();
  context->set_deadline(std::chrono::system_clock::now() + kPatience);
  return context;
}

/// On any free port, always answering by the newest map; up is towards the camera, so the wall that it sees is a floor.
inline ServiceConfig test_config() {
  ServiceConfig config;
  config.queue.scans = 1000;
  config.map.gravity = {0.0, 0.0, 1.0};
  config.grpc.listen = "127.0.0.1:0";
  config.grpc.index_age_s = 0.0;
  config.grpc.watch_period_s = 0.01;
  return config;
}

/// The whole service with its gRPC server, and a sensor on its bus.
class TestDaemon {
 public:
  explicit TestDaemon(const ServiceConfig& config = test_config(), std::uint64_t epoch = 1234)
      : bus_("memq://"), service_(config, bus_, epoch) {
    auto started = GrpcServer::start(config, service_.mapping(), service_.status_board(), service_.counter_board());
    if (!started) throw std::runtime_error(started.error().message);
    server_ = std::move(*started);
    service_.set_snapshot_listener([this] { server_->wake(); });
  }
  ~TestDaemon() {
    service_.set_snapshot_listener({});
    server_->stop();
  }
  TestDaemon(const TestDaemon&) = delete;
  TestDaemon& operator=(const TestDaemon&) = delete;

  Service& service() { return service_; }
  GrpcServer& server() { return *server_; }
  const GrpcServer& server() const { return *server_; }

  /// Maps scans of a wall, square on at that depth.
  void map_walls(int count, std::uint16_t depth_mm = 1000) {
    const std::int64_t before = counter("scans.mapped");
    send_walls(count, depth_mm);
    ASSERT_TRUE(handle_until([&] { return counter("scans.mapped") >= before + count; }));
  }
  void send_walls(int count, std::uint16_t depth_mm = 1000) {
    for (int i = 0; i < count; ++i, ++sent_) {
      const std::int64_t utime = 10000000 + sent_ * std::int64_t{33333};
      send("POSE", encoded(pose_message(utime)));
      send("PLANEMAP_SCAN", encoded(zipped(wall_message(utime, sent_, depth_mm))));
    }
  }
  /// Handles the bus until the condition holds. @return false after half a minute
  bool handle_until(const std::function<bool()>& holds) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!holds()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      service_.handle(5);
    }
    return true;
  }
  std::int64_t counter(const std::string& name) const {
    const auto values = service_.counters();
    const auto found = values.find(name);
    return found == values.end() ? 0 : found->second;
  }

  std::shared_ptr<grpc::Channel> channel(const grpc::ChannelArguments& more = {}) const {
    grpc::ChannelArguments arguments = more;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own
    return grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(), arguments);
  }
  std::unique_ptr<v1::PlaneMap::Stub> stub(const grpc::ChannelArguments& more = {}) const {
    return v1::PlaneMap::NewStub(channel(more));
  }
  std::unique_ptr<v1::Admin::Stub> admin() const { return v1::Admin::NewStub(channel()); }

 private:
  void send(const std::string& channel, const Bytes& bytes) {
    ASSERT_EQ(bus_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())), 0);
  }

  lcm::LCM bus_;
  Service service_;
  std::unique_ptr<GrpcServer> server_;
  std::int32_t sent_ = 0;
};

/// All messages of a stream, and how it ended.
template <class Message>
std::pair<std::vector<Message>, grpc::Status> read_all(grpc::ClientReader<Message>& reader) {
  std::vector<Message> messages;
  for (Message message; reader.Read(&message);) messages.push_back(message);
  return {std::move(messages), reader.Finish()};
}

/// Code and words of an error.
inline void expect_error(const grpc::Status& status, grpc::StatusCode code, const std::string& words) {
  EXPECT_EQ(status.error_code(), code) << status.error_message();
  EXPECT_NE(status.error_message().find(words), std::string::npos) << status.error_message() << "\nnot\n" << words;
}

}  // namespace planemap::service
