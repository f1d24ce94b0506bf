// A mirror over gRPC, through all that may happen to its stream.
#include <gtest/gtest.h>

#include <planemap/client/grpc_map_admin.hpp>
#include <planemap/client/grpc_map_client.hpp>
#include <vector>

#include "fake_grpc_service.hpp"
#include "support/grpc_door.hpp"
#include "support/room_service.hpp"

namespace planemap::client {
namespace {

using std::chrono::milliseconds;
using Kind = Error::Kind;

constexpr milliseconds kLong(30000);

GrpcClientOptions quick() {
  GrpcClientOptions options;
  options.heartbeat = milliseconds(100);
  options.connect_after = milliseconds(20);
  return options;
}

std::unique_ptr<GrpcMapClient> client_of(const std::string& server, const GrpcClientOptions& options = quick()) {
  auto client = GrpcMapClient::connect(server, options);
  if (!client) throw std::runtime_error(client.error().message);
  return std::move(*client);
}

/// The next change, whatever comes in between.
MapChange next_change(MapWatch& watch) {
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    const auto change = watch.next(milliseconds(500));
    if (change && !change->empty()) return *change;
    if (std::chrono::steady_clock::now() - begin > kLong) throw std::runtime_error("no change came");
  }
}

void expect_same(const Map& mirror, const Map& map) {
  EXPECT_EQ(mirror.epoch, map.epoch);
  EXPECT_EQ(mirror.revision, map.revision);
  EXPECT_EQ(mirror.frame, map.frame);
  ASSERT_EQ(mirror.planes.size(), map.planes.size());
  for (std::size_t i = 0; i < map.planes.size(); ++i) {
    EXPECT_EQ(mirror.planes[i].id, map.planes[i].id);
    EXPECT_EQ(mirror.planes[i].revision, map.planes[i].revision);
    EXPECT_EQ(mirror.planes[i].covariance, map.planes[i].covariance);
  }
}

void expect_newest(MapClient& client, MapWatch& watch) {
  const auto map = client.snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  while (watch.map().revision < map->revision) ASSERT_FALSE(next_change(watch).empty());
  expect_same(watch.map(), *map);
}

TEST(GrpcMapWatch, GoesOnAfterItWasCutOff) {
  RoomService room;
  room.look_at_floor();
  auto door = std::make_unique<GrpcDoor>(room.service(), room.config());
  const std::string address = door->address();
  const auto client = client_of(address);
  const auto watch = client->watch();
  EXPECT_TRUE(next_change(*watch).new_map);
  door = nullptr;
  const auto cut_off = watch->next(milliseconds(200));
  ASSERT_TRUE(cut_off) << "it is soon to say so: " << cut_off.error().message;
  EXPECT_TRUE(cut_off->empty());
  EXPECT_EQ(watch->map().planes.size(), 1u) << "the mirror stays";
  room.look_at_wall(0.0);
  door = std::make_unique<GrpcDoor>(room.service(), room.config(), address);
  const MapChange change = next_change(*watch);
  EXPECT_FALSE(change.new_map);
  EXPECT_FALSE(change.caught_up) << "the server knows what has changed since";
  EXPECT_EQ(change.added.size(), 1u);
  expect_newest(*client, *watch);
}

TEST(GrpcMapWatch, TakesTheMapOfARestartedDaemon) {
  std::string address;
  std::unique_ptr<GrpcMapClient> client;
  std::unique_ptr<MapWatch> watch;
  {
    RoomService room;
    room.look_around();
    const GrpcDoor door(room.service(), room.config());
    address = door.address();
    client = client_of(address);
    watch = client->watch();
    EXPECT_EQ(next_change(*watch).epoch, 1234);
    EXPECT_EQ(watch->map().planes.size(), 3u);
  }
  RoomService room(RoomService::default_config(), /*epoch=*/5678);
  room.look_at_floor();
  const GrpcDoor door(room.service(), room.config(), address);
  const MapChange change = next_change(*watch);
  EXPECT_TRUE(change.new_map);
  EXPECT_EQ(change.epoch, 5678);
  EXPECT_EQ(change.since_revision, -1);
  EXPECT_EQ(change.added.size(), 1u);
  expect_newest(*client, *watch);
}

TEST(GrpcMapWatch, TakesAMapThatBeginsAnew) {
  RoomService room;
  room.look_around();
  const GrpcDoor door(room.service(), room.config());
  const auto client = client_of(door.address());
  const auto watch = client->watch();
  EXPECT_TRUE(next_change(*watch).new_map);
  const auto epoch = GrpcMapAdmin(*GrpcConnection::open(door.address())).reset(kLong);
  ASSERT_TRUE(epoch) << epoch.error().message;
  const MapChange change = next_change(*watch);
  EXPECT_TRUE(change.new_map);
  EXPECT_EQ(change.epoch, *epoch);
  EXPECT_TRUE(watch->map().planes.empty());
}

TEST(GrpcMapWatch, NobodyIsSaidToBeThereOnlyAfterAWhile) {
  std::string address;
  std::unique_ptr<GrpcMapClient> client;
  std::unique_ptr<MapWatch> watch;
  {
    RoomService room;
    room.look_at_floor();
    const GrpcDoor door(room.service(), room.config());
    address = door.address();
    auto options = quick();
    options.silent_after = milliseconds(400);
    client = client_of(address, options);
    watch = client->watch();
    EXPECT_TRUE(next_change(*watch).new_map);
  }
  const auto gone = watch->next(kLong);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().kind, Kind::kUnreachable);
  EXPECT_NE(gone.error().message.find("no planemapd can be reached at " + address), std::string::npos)
      << gone.error().message;
  EXPECT_EQ(watch->map().planes.size(), 1u) << "the mirror stays";
  const auto polled = watch->next(milliseconds(0));
  EXPECT_TRUE(polled) << polled.error().message;
}

TEST(GrpcMapWatch, HeartbeatsSayThatTheServiceLives) {
  RoomService room;
  room.look_at_floor();
  const GrpcDoor door(room.service(), room.config());
  auto options = quick();
  options.silent_after = milliseconds(1000);
  const auto client = client_of(door.address(), options);
  const auto watch = client->watch();
  EXPECT_TRUE(next_change(*watch).new_map);
  const auto quiet = watch->next(milliseconds(2500));  // 2.5 times as long as silence is borne
  ASSERT_TRUE(quiet) << quiet.error().message;
  EXPECT_TRUE(quiet->empty());
}

TEST(GrpcMapWatch, AServerThatSaysNothingIsAskedAgain) {
  FakeGrpcService fake;
  auto options = quick();
  options.silent_after = milliseconds(200);
  const auto client = client_of(fake.address(), options);
  const auto watch = client->watch();
  for (int i = 0; i < 2; ++i) {
    const auto silent = watch->next(milliseconds(1000));
    ASSERT_FALSE(silent);
    EXPECT_EQ(silent.error().kind, Kind::kUnreachable);
    EXPECT_EQ(silent.error().message, "nothing was heard of a planemap service at " + fake.address() + " for 0.2 s");
  }
  EXPECT_GE(fake.watches(), 2);
}

TEST(GrpcMapWatch, CanBePolled) {
  RoomService room;
  room.look_at_floor();
  const GrpcDoor door(room.service(), room.config());
  const auto client = client_of(door.address());
  const auto watch = client->watch();
  const auto begin = std::chrono::steady_clock::now();
  bool is_there = false;
  while (!is_there && std::chrono::steady_clock::now() - begin < kLong) {
    const auto change = watch->next(milliseconds(0));
    is_there = change && change->new_map;
  }
  EXPECT_TRUE(is_there);
}

TEST(GrpcMapWatch, IsOpenedAgainWhereAServiceThatEndsCancelsIt) {
  FakeGrpcService fake;
  fake.end_with({grpc::StatusCode::CANCELLED, "of its own"});
  const auto client = client_of(fake.address());
  const auto watch = client->watch();
  const auto silent = watch->next(milliseconds(500));
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().kind, Kind::kUnreachable);
  EXPECT_EQ(silent.error().message, "the service at " + fake.address() + " ended the call (of its own)");
  EXPECT_GE(fake.watches(), 2);
}

v1::WatchEvent event_at(std::uint64_t revision) {
  v1::WatchEvent event;
  event.mutable_map()->set_epoch(7);
  event.mutable_map()->set_revision(revision);
  return event;
}

v1::WatchEvent delta_page(std::uint64_t since, std::uint64_t revision, std::uint32_t page, bool last,
                          std::uint64_t plane) {
  v1::WatchEvent event = event_at(revision);
  event.mutable_delta()->set_since_revision(since);
  event.mutable_delta()->set_page(page);
  event.mutable_delta()->set_last(last);
  *event.mutable_delta()->add_changed() = sound_plane();
  event.mutable_delta()->mutable_changed(0)->set_id(plane);
  return event;
}

/// A server whose map has plane 1 at revision 3, and that says first that this must be asked for.
class ToldWatch : public testing::Test {
 protected:
  void say(std::vector<v1::WatchEvent> events) {
    v1::SnapshotPage& page = fake_.add_page();
    page.set_last(true);
    *page.add_planes() = sound_plane();
    v1::WatchEvent first = event_at(3);
    first.mutable_snapshot_needed()->set_reason(v1::SnapshotNeeded::REASON_NO_STATE);
    events.insert(events.begin(), first);
    fake_.say(std::move(events));
    client_ = client_of(fake_.address());
    watch_ = client_->watch();
    EXPECT_TRUE(next_change(*watch_).new_map);
  }

  FakeGrpcService fake_;
  std::unique_ptr<GrpcMapClient> client_;
  std::unique_ptr<MapWatch> watch_;
};

TEST_F(ToldWatch, ADeltaOfManyPagesIsOneChange) {
  say({delta_page(3, 5, 0, false, 2), delta_page(3, 5, 1, true, 4)});
  const MapChange change = next_change(*watch_);
  EXPECT_EQ(change.since_revision, 3);
  EXPECT_EQ(change.revision, 5);
  EXPECT_EQ(change.added, (std::vector<std::int64_t>{2, 4}));
  EXPECT_EQ(watch_->map().planes.size(), 3u);
}

TEST_F(ToldWatch, WhatIsKnownAlreadyIsPassedOver) {
  say({delta_page(2, 3, 0, true, 9), delta_page(3, 4, 0, true, 2)});
  const MapChange change = next_change(*watch_);
  EXPECT_EQ(change.revision, 4);
  EXPECT_EQ(change.added, (std::vector<std::int64_t>{2}));
}

TEST_F(ToldWatch, ADeltaThatIsNotSoundIsSaidToBe) {
  say({delta_page(3, 4, 1, true, 2)});  // its first page is missing
  const auto change = watch_->next(kLong);
  ASSERT_FALSE(change);
  EXPECT_EQ(change.error().kind, Kind::kMalformed);
  EXPECT_EQ(change.error().message, "the service's answer cannot be used: a delta is not sound");
}

}  // namespace
}  // namespace planemap::client
