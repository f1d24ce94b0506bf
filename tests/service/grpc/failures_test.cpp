// What calls end with where the service itself cannot answer: the words, whichever way the answer comes.

#include <cstddef>
#include <future>
#include <stdexcept>

#include "mapping/map_keeper.hpp"
#include "serve/grpc/calls.hpp"
#include "serve/grpc/index_keeper.hpp"
#include "serve/grpc/plane_map_service.hpp"
#include "serve/grpc/watch_hub.hpp"
#include "test_daemon.hpp"

namespace planemap::service {
namespace {

using grpc::StatusCode;

/// Serves something on a free port of the loopback.
template <class Service>
class Door {
 public:
  explicit Door(Service& service) {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service);
    server_ = builder.BuildAndStart();
    if (!server_) throw std::runtime_error("cannot listen");
    stub_ = v1::PlaneMap::NewStub(
        grpc::CreateChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials()));
  }
  ~Door() { server_->Shutdown(std::chrono::system_clock::now()); }
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  v1::PlaneMap::Stub& stub() { return *stub_; }

 private:
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::PlaneMap::Stub> stub_;
};

std::int64_t counted(const Counters& counters, const std::string& name) {
  const auto values = counters.values();
  const auto found = values.find(name);
  return found == values.end() ? 0 : found->second;
}

/// The service whose index cannot be made, and whose status cannot be told.
class WithoutAnIndex : public testing::Test {
 protected:
  WithoutAnIndex() { keeper_.stop(); }

  Counters counters_;
  MappingService mapping_{ServiceConfig{}, 1, counters_, [] {}};
  const CallGuard guard_;
  WorkerPool pool_{1, 10};
  CallDesk desk_{guard_, pool_, counters_, 10};
  WatchHub hub_{desk_, 10.0};
  IndexKeeper keeper_{ServiceConfig{}, mapping_, [](const auto&) {}};
  PlaneMapService service_{desk_, keeper_, hub_, "world",
                           []() -> v1::GetStatusResponse { throw std::runtime_error("no status today"); }};
  Door<PlaneMapService> door_{service_};
};

TEST_F(WithoutAnIndex, EachCallSaysThatTheMapIsNotReady) {
  v1::PlaneMap::Stub& stub = door_.stub();
  const auto expect_not_ready = [](const grpc::Status& status) {
    expect_error(status, StatusCode::UNAVAILABLE, "the map is not ready to be asked");
  };
  v1::GetPlaneRequest plane;
  plane.set_plane_id(1);
  v1::GetPlaneResponse plane_response;
  expect_not_ready(stub.GetPlane(new_context().get(), plane, &plane_response));
  v1::GetFloorPlanResponse floor_plan;
  expect_not_ready(stub.GetFloorPlan(new_context().get(), {}, &floor_plan));
  v1::NearestPlanesResponse near;
  expect_not_ready(stub.NearestPlanes(new_context().get(), {}, &near));
  v1::CastRaysResponse hits;
  expect_not_ready(stub.CastRays(new_context().get(), {}, &hits));
  expect_not_ready(read_all(*stub.GetSnapshot(new_context().get(), {})).second);
  expect_not_ready(read_all(*stub.GetCells(new_context().get(), {})).second);
  expect_not_ready(read_all(*stub.QueryRegion(new_context().get(), {})).second);
  EXPECT_EQ(counted(counters_, "grpc.calls.failed.unavailable"), 7);
}

TEST_F(WithoutAnIndex, WhatIsThrownIsToldAndCounted) {
  v1::GetStatusResponse status;
  expect_error(door_.stub().GetStatus(new_context().get(), {}, &status), StatusCode::INTERNAL,
               "the service could not answer: no status today");
  EXPECT_EQ(counted(counters_, "grpc.calls.failed.internal"), 1);
}

/// Answers in pages that cannot all be made.
class BrokenPages final : public v1::PlaneMap::CallbackService {
 public:
  explicit BrokenPages(CallDesk& desk) : desk_(desk) {}

  grpc::ServerWriteReactor<v1::SnapshotPage>* GetSnapshot(grpc::CallbackServerContext* context,
                                                          const v1::GetSnapshotRequest*) override {
    using Reactor = PageReactor<v1::SnapshotPage>;
    return Reactor::start(desk_, context, [](grpc::Status&) -> Reactor::Next { throw std::runtime_error("no begin"); });
  }
  grpc::ServerWriteReactor<v1::CellsPage>* GetCells(grpc::CallbackServerContext* context,
                                                    const v1::GetCellsRequest*) override {
    using Reactor = PageReactor<v1::CellsPage>;
    return Reactor::start(desk_, context, [](grpc::Status&) -> Reactor::Next {
      return [made = 0](v1::CellsPage& page) mutable {
        if (++made > 1) throw std::runtime_error("no second page");
        page.set_frame("world");
        return false;
      };
    });
  }

 private:
  CallDesk& desk_;
};

class PagesThatFail : public testing::Test {
 protected:
  Counters counters_;
  const CallGuard guard_;
  WorkerPool pool_{1, 1};
  CallDesk desk_{guard_, pool_, counters_, 10};
  BrokenPages service_{desk_};
  Door<BrokenPages> door_{service_};
};

TEST_F(PagesThatFail, SayWhy) {
  const auto [none, at_begin] = read_all(*door_.stub().GetSnapshot(new_context().get(), {}));
  expect_error(at_begin, StatusCode::INTERNAL, "the service could not answer: no begin");
  EXPECT_TRUE(none.empty());
  const auto [pages, later] = read_all(*door_.stub().GetCells(new_context().get(), {}));
  expect_error(later, StatusCode::INTERNAL, "the service could not answer: no second page");
  EXPECT_EQ(pages.size(), 1u);
  EXPECT_EQ(counted(counters_, "grpc.calls.failed.internal"), 2);
}

TEST_F(PagesThatFail, FindNoRoomWhereOthersWait) {
  std::promise<void> begun;
  std::promise<void> release;
  pool_.post([&] {
    begun.set_value();
    release.get_future().wait();
  });
  begun.get_future().wait();
  pool_.post([] {});  // it waits, and one may
  expect_error(read_all(*door_.stub().GetSnapshot(new_context().get(), {})).second, StatusCode::RESOURCE_EXHAUSTED,
               "1 calls wait already (grpc.max_waiting_calls); ask again later");
  release.set_value();
}

TEST(FloorPlans, ThatFitInNoMessageAreRefused) {
  v1::GetFloorPlanResponse response;
  auto& ring = *response.add_free_floor()->mutable_outer();
  for (int i = 0; i < 1000; ++i) ring.add_uv_m(1.0F);
  EXPECT_TRUE(checked_size(response).ok());
  for (int i = 0; i < 300'000; ++i) ring.add_uv_m(1.0F);
  const std::size_t bytes = response.ByteSizeLong();
  expect_error(checked_size(response), StatusCode::RESOURCE_EXHAUSTED,
               "the floor plan takes " + std::to_string(bytes) + " bytes (at most 1048576); ask with a filter");
  EXPECT_EQ(response.ByteSizeLong(), 0u);
}

TEST(Admin, AResetWhoseMapCannotBeSavedSaysSo) {
  class FullDisk final : public MapKeeper {
   public:
    Expected<void> save(std::chrono::steady_clock::duration) override { return fail("the disk is full"); }
    std::string problem() const override { return "the disk is full"; }
  };
  TestDaemon daemon;
  FullDisk disk;
  daemon.service().mapping().set_keeper(&disk);
  v1::SaveResponse saved;
  expect_error(daemon.admin()->Save(new_context().get(), {}, &saved), StatusCode::FAILED_PRECONDITION,
               "the disk is full");
  v1::ResetResponse response;
  expect_error(daemon.admin()->Reset(new_context().get(), {}, &response), StatusCode::FAILED_PRECONDITION,
               "a new map has begun, but its file still holds the old one, which is tried on: the disk is full");
  EXPECT_GT(daemon.service().snapshot()->epoch(), 1234u);
  daemon.service().mapping().set_keeper(nullptr);
}

}  // namespace
}  // namespace planemap::service
