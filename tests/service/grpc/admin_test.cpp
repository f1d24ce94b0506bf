// Admin, health and reflection over a real connection.

#include <planemap/test/health.grpc.pb.h>
#include <planemap/test/reflection.pb.h>

#include <atomic>
#include <future>
#include <set>

#include "test_daemon.hpp"

namespace planemap::service {
namespace {

using grpc::StatusCode;
using grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

/// received - mapped - dropped - rejected - waiting.
std::int64_t unaccounted(const CounterValues& values) {
  std::int64_t left = values.at("scans.received") - values.at("scans.mapped") - values.at("scans.waiting");
  for (const auto& [name, value] : values) {
    if (name.rfind("scans.dropped.", 0) == 0 || name.rfind("scans.rejected.", 0) == 0) left -= value;
  }
  return left;
}

TEST(Admin, PausedScansAreCountedAndTheMapStays) {
  TestDaemon daemon;
  daemon.map_walls(4);
  const auto revision = daemon.service().snapshot()->revision();
  const auto admin = daemon.admin();
  v1::PauseResponse paused;
  ASSERT_TRUE(admin->Pause(new_context().get(), {}, &paused).ok());
  daemon.send_walls(5, 1500);
  ASSERT_TRUE(daemon.handle_until([&] { return daemon.counter("scans.dropped.paused") == 5; }));
  EXPECT_EQ(daemon.service().snapshot()->revision(), revision);
  EXPECT_EQ(unaccounted(daemon.service().counters()), 0);
  v1::GetStatusResponse status;
  ASSERT_TRUE(daemon.stub()->GetStatus(new_context().get(), {}, &status).ok());
  EXPECT_TRUE(status.paused());
  EXPECT_NE(status.idle_reason().find("paused"), std::string::npos) << status.idle_reason();
  v1::ResumeResponse resumed;
  ASSERT_TRUE(admin->Resume(new_context().get(), {}, &resumed).ok());
  daemon.map_walls(3, 1500);
  EXPECT_GT(daemon.service().snapshot()->revision(), revision);
  EXPECT_EQ(unaccounted(daemon.service().counters()), 0);
}

TEST(Admin, ResetBeginsAnEmptyMapOfAGreaterEpoch) {
  TestDaemon daemon;
  daemon.map_walls(4);
  ASSERT_FALSE(daemon.service().snapshot()->planes().empty());
  v1::ResetResponse response;
  const auto status = daemon.admin()->Reset(new_context().get(), {}, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_GT(response.epoch(), 1234u);
  EXPECT_EQ(daemon.service().snapshot()->epoch(), response.epoch());
  EXPECT_TRUE(daemon.service().snapshot()->planes().empty());
  v1::GetStatusResponse told;
  ASSERT_TRUE(daemon.stub()->GetStatus(new_context().get(), {}, &told).ok());
  EXPECT_NE(told.idle_reason().find(" since the map was reset 0 s ago"), std::string::npos) << told.idle_reason();
  daemon.map_walls(4);
  ASSERT_TRUE(daemon.stub()->GetStatus(new_context().get(), {}, &told).ok());
  EXPECT_EQ(told.idle_reason(), "");
  EXPECT_EQ(daemon.service().snapshot()->epoch(), response.epoch());
  EXPECT_FALSE(daemon.service().snapshot()->planes().empty());
  v1::ResetResponse again;
  ASSERT_TRUE(daemon.admin()->Reset(new_context().get(), {}, &again).ok());
  EXPECT_GT(again.epoch(), response.epoch());
  EXPECT_EQ(unaccounted(daemon.service().counters()), 0);
}

/// Holds a daemon's mapper with the first scan that it maps. Must outlive the daemon.
class BusyMapper {
 public:
  void keep_busy(TestDaemon& daemon) {
    daemon.service().set_snapshot_listener([this] {
      is_busy_ = true;
      released_.wait();
    });
  }
  bool is_busy() const { return is_busy_; }
  void release() { release_.set_value(); }

 private:
  std::atomic<bool> is_busy_ = false;
  std::promise<void> release_;
  const std::shared_future<void> released_ = release_.get_future().share();
};

TEST(Admin, ResetDropsWhatWaitsForABusyMapper) {
  BusyMapper mapper;
  TestDaemon daemon;  // last: the mapper uses what is before until it ends
  mapper.keep_busy(daemon);
  daemon.send_walls(5);
  ASSERT_TRUE(daemon.handle_until([&] { return mapper.is_busy(); }));
  ASSERT_TRUE(daemon.handle_until([&] { return daemon.service().mapping().stats(0.0).queued == 4u; }));
  v1::ResetResponse response;
  auto reset =
      std::async(std::launch::async, [&] { return daemon.admin()->Reset(new_context().get(), {}, &response); });
  ASSERT_TRUE(daemon.handle_until([&] { return daemon.counter("scans.dropped.reset") == 4; }));
  mapper.release();
  const auto status = reset.get();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(daemon.counter("scans.mapped"), 1);
  EXPECT_EQ(unaccounted(daemon.service().counters()), 0);
}

TEST(Admin, ResetSaysThatTheMapperIsBusy) {
  BusyMapper mapper;
  TestDaemon daemon;  // last: the mapper uses what is before until it ends
  mapper.keep_busy(daemon);
  daemon.send_walls(1);
  ASSERT_TRUE(daemon.handle_until([&] { return mapper.is_busy(); }));
  v1::ResetResponse response;
  const auto status = daemon.admin()->Reset(new_context().get(), {}, &response);  // which gives up after 5 s
  mapper.release();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(status.error_message(), "the mapper is busy with a scan; the new map begins once that is mapped");
}

TEST(Admin, CallsBeyondThoseThatMayWaitAreRefused) {
  auto config = test_config();
  config.grpc.threads = 1;
  config.grpc.max_waiting_calls = 1;
  TestDaemon daemon(config);
  std::promise<void> release;
  const auto released = release.get_future().share();
  daemon.service().set_snapshot_listener([released] { released.wait(); });
  daemon.map_walls(1);  // the mapper hangs behind it, and a reset waits for it
  std::vector<std::future<grpc::Status>> resets;
  for (int i = 0; i < 3; ++i) {  // one is worked at, one waits
    resets.push_back(std::async(std::launch::async, [&daemon] {
      v1::ResetResponse response;
      return daemon.admin()->Reset(new_context().get(), {}, &response);
    }));
  }
  ASSERT_TRUE(daemon.handle_until([&] { return daemon.counter("grpc.calls.failed.resource_exhausted") >= 1; }));
  release.set_value();
  int refused = 0;
  for (auto& reset : resets) {
    const auto status = reset.get();
    if (status.ok()) continue;
    ++refused;
    expect_error(status, StatusCode::RESOURCE_EXHAUSTED, "1 calls wait already (grpc.max_waiting_calls)");
  }
  EXPECT_GE(refused, 1);
}

TEST(Admin, SaveSaysThatThereIsNoStore) {
  TestDaemon daemon;
  v1::SaveResponse response;
  expect_error(daemon.admin()->Save(new_context().get(), {}, &response), StatusCode::FAILED_PRECONDITION,
               "the map has no file: planemapd --map FILE, or store.path, gives it one");
}

TEST(HealthOfTheServer, IsServingUntilItStops) {
  TestDaemon daemon;
  const auto health = Health::NewStub(daemon.channel());
  for (const char* name : {"", "planemap.v1.PlaneMap", "planemap.v1.Admin"}) {
    HealthCheckRequest request;
    request.set_service(name);
    HealthCheckResponse response;
    ASSERT_TRUE(health->Check(new_context().get(), request, &response).ok()) << name;
    EXPECT_EQ(response.status(), HealthCheckResponse::SERVING) << name;
  }
  HealthCheckRequest unknown;
  unknown.set_service("planemap.v1.Nothing");
  HealthCheckResponse response;
  EXPECT_EQ(health->Check(new_context().get(), unknown, &response).error_code(), StatusCode::NOT_FOUND);

  const auto context = new_context();
  HealthCheckRequest request;
  request.set_service("planemap.v1.PlaneMap");
  const auto watch = health->Watch(context.get(), request);
  ASSERT_TRUE(watch->Read(&response));
  EXPECT_EQ(response.status(), HealthCheckResponse::SERVING);
  daemon.server().stop();
  ASSERT_TRUE(watch->Read(&response));
  EXPECT_EQ(response.status(), HealthCheckResponse::NOT_SERVING);
}

TEST(HealthOfTheServer, IsWhatTheServiceSaysOfItself) {
  TestDaemon daemon;
  const auto health = Health::NewStub(daemon.channel());
  for (const bool is_serving : {false, true}) {
    daemon.server().set_serving(is_serving);
    for (const char* name : {"", "planemap.v1.PlaneMap", "planemap.v1.Admin"}) {
      HealthCheckRequest request;
      request.set_service(name);
      HealthCheckResponse response;
      ASSERT_TRUE(health->Check(new_context().get(), request, &response).ok()) << name;
      EXPECT_EQ(response.status() == HealthCheckResponse::SERVING, is_serving) << name;
    }
  }
}

TEST(Reflection, TellsServicesAndFiles) {
  using test::ReflectionRequest;
  using test::ReflectionResponse;
  TestDaemon daemon;
  const auto channel = daemon.channel();
  const auto context = new_context();
  const grpc::internal::RpcMethod method("/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo",
                                         grpc::internal::RpcMethod::BIDI_STREAMING);
  const std::unique_ptr<grpc::ClientReaderWriter<ReflectionRequest, ReflectionResponse>> stream(
      grpc::internal::ClientReaderWriterFactory<ReflectionRequest, ReflectionResponse>::Create(channel.get(), method,
                                                                                               context.get()));
  ReflectionRequest request;
  request.set_list_services("*");
  ReflectionResponse response;
  ASSERT_TRUE(stream->Write(request));
  ASSERT_TRUE(stream->Read(&response));
  std::set<std::string> names;
  for (const auto& service : response.services().service()) names.insert(service.name());
  for (const char* name : {"planemap.v1.PlaneMap", "planemap.v1.Admin", "grpc.health.v1.Health"}) {
    EXPECT_EQ(names.count(name), 1u) << name;
  }
  request.set_file_containing_symbol("planemap.v1.PlaneMap");
  ASSERT_TRUE(stream->Write(request));
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_GE(response.files().file_descriptor_proto_size(), 1);
  stream->WritesDone();
  EXPECT_TRUE(stream->Finish().ok());
}

}  // namespace
}  // namespace planemap::service
