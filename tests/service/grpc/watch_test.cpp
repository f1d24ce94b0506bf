// Watch: what a client is told, and when, beside the map itself.

#include <future>
#include <map>

#include "test_daemon.hpp"

namespace planemap::service {
namespace {

using grpc::StatusCode;
using v1::SnapshotNeeded;

/// One call of Watch.
class Watch {
 public:
  Watch(v1::PlaneMap::Stub& stub, std::uint64_t epoch, std::uint64_t since, double heartbeat_s = 3600.0) {
    v1::WatchRequest request;
    request.set_epoch(epoch);
    request.set_since_revision(since);
    request.set_heartbeat_s(heartbeat_s);
    reader_ = stub.Watch(context_.get(), request);
  }
  ~Watch() {
    if (is_over_) return;
    context_->TryCancel();
    finish();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// The next event; an empty one after the stream's end.
  v1::WatchEvent next() {
    v1::WatchEvent event;
    if (!reader_->Read(&event)) event.Clear();
    return event;
  }
  grpc::Status finish() {
    is_over_ = true;
    for (v1::WatchEvent event; reader_->Read(&event);) continue;
    return reader_->Finish();
  }

 private:
  std::unique_ptr<grpc::ClientContext> context_ = new_context();
  std::unique_ptr<grpc::ClientReader<v1::WatchEvent>> reader_;
  bool is_over_ = false;
};

/// A client's map: planes by id.
using Planes = std::map<std::uint64_t, std::string>;

void take_in(Planes& planes, const v1::Delta& delta) {
  for (const auto& plane : delta.changed()) planes[plane.id()] = plane.SerializeAsString();
  for (const auto& plane : delta.removed()) planes.erase(plane.id());
}

class WatchTest : public testing::Test {
 protected:
  void SetUp() override { daemon_.map_walls(4); }
  std::uint64_t revision() { return daemon_.service().snapshot()->revision(); }
  std::pair<Planes, std::uint64_t> snapshot() {
    const auto [pages, status] = read_all(*stub_->GetSnapshot(new_context().get(), {}));
    EXPECT_TRUE(status.ok()) << status.error_message();
    Planes planes;
    for (const auto& page : pages) {
      for (const auto& plane : page.planes()) planes[plane.id()] = plane.SerializeAsString();
    }
    return {planes, pages.at(0).map().revision()};
  }
  void expect_snapshot_needed(std::uint64_t epoch, std::uint64_t since, SnapshotNeeded::Reason reason,
                              const std::string& words) {
    Watch watch(*stub_, epoch, since);
    const auto event = watch.next();
    ASSERT_TRUE(event.has_snapshot_needed()) << event.ShortDebugString();
    EXPECT_EQ(event.snapshot_needed().reason(), reason);
    EXPECT_EQ(event.snapshot_needed().message(), words);
    EXPECT_EQ(event.map().epoch(), 1234u);
    EXPECT_EQ(event.map().revision(), revision());
  }

  TestDaemon daemon_;
  std::unique_ptr<v1::PlaneMap::Stub> stub_ = daemon_.stub();
};

TEST_F(WatchTest, BeginsWithAHeartbeatWhereNothingHasChanged) {
  Watch watch(*stub_, 1234, revision());
  const auto event = watch.next();
  EXPECT_TRUE(event.has_heartbeat()) << event.ShortDebugString();
  EXPECT_EQ(event.map().revision(), revision());
}

TEST_F(WatchTest, SaysWhenASnapshotIsNeeded) {
  expect_snapshot_needed(0, 0, SnapshotNeeded::REASON_NO_STATE, "no epoch was named; take a snapshot");
  expect_snapshot_needed(77, 1, SnapshotNeeded::REASON_OTHER_EPOCH,
                         "epoch 77 is not the map's, which is 1234; take a snapshot");
  const auto unknown = revision() + 1000;
  expect_snapshot_needed(1234, unknown, SnapshotNeeded::REASON_REVISION_UNKNOWN,
                         "revision " + std::to_string(unknown) + " is unknown: the map is at " +
                             std::to_string(revision()) + "; take a snapshot");
}

TEST_F(WatchTest, ALateWatcherGetsWhatHasChangedSinceItsSnapshot) {
  auto [planes, since] = snapshot();
  daemon_.map_walls(6, 1600);
  ASSERT_GT(revision(), since);
  Watch watch(*stub_, 1234, since);
  const auto event = watch.next();
  ASSERT_TRUE(event.has_delta()) << event.ShortDebugString();
  EXPECT_EQ(event.delta().since_revision(), since);
  EXPECT_TRUE(event.delta().last());
  EXPECT_EQ(event.map().revision(), revision());
  take_in(planes, event.delta());
  EXPECT_EQ(planes, snapshot().first);
}

TEST_F(WatchTest, ChangesComeAsTheyHappen) {
  auto [planes, since] = snapshot();
  Watch watch(*stub_, 1234, since);
  ASSERT_TRUE(watch.next().has_heartbeat());
  for (const auto depth_mm : std::initializer_list<std::uint16_t>{1300, 1600, 1900}) {
    daemon_.map_walls(4, depth_mm);
    while (since < revision()) {
      const auto event = watch.next();
      ASSERT_TRUE(event.has_delta()) << event.ShortDebugString();
      EXPECT_EQ(event.delta().since_revision(), since);
      take_in(planes, event.delta());
      since = event.map().revision();
    }
    EXPECT_EQ(planes, snapshot().first);
  }
}

TEST_F(WatchTest, SaysThatANewMapHasBegun) {
  Watch watch(*stub_, 1234, revision());
  ASSERT_TRUE(watch.next().has_heartbeat());
  v1::ResetResponse reset;
  ASSERT_TRUE(daemon_.admin()->Reset(new_context().get(), {}, &reset).ok());
  auto event = watch.next();
  ASSERT_TRUE(event.has_snapshot_needed()) << event.ShortDebugString();
  EXPECT_EQ(event.snapshot_needed().reason(), SnapshotNeeded::REASON_NEW_MAP);
  EXPECT_EQ(event.map().epoch(), reset.epoch());
  daemon_.map_walls(4);
  event = watch.next();  // the stream goes on
  ASSERT_TRUE(event.has_delta()) << event.ShortDebugString();
  EXPECT_EQ(event.map().epoch(), reset.epoch());
}

TEST_F(WatchTest, ARestartedDaemonIsOfAnotherEpoch) {
  const auto since = revision();
  Watch watch(*stub_, 1234, since);
  ASSERT_TRUE(watch.next().has_heartbeat());
  daemon_.server().stop();
  expect_error(watch.finish(), StatusCode::UNAVAILABLE, "planemapd is ending");
  TestDaemon next(test_config(), 5678);
  const auto stub = next.stub();
  Watch again(*stub, 1234, since);
  const auto event = again.next();
  ASSERT_TRUE(event.has_snapshot_needed());
  EXPECT_EQ(event.snapshot_needed().reason(), SnapshotNeeded::REASON_OTHER_EPOCH);
  EXPECT_EQ(event.map().epoch(), 5678u);
}

TEST_F(WatchTest, HeartbeatsComeWhileNothingChanges) {
  Watch watch(*stub_, 1234, revision(), 0.1);
  for (int i = 0; i < 3; ++i) {
    const auto event = watch.next();
    EXPECT_TRUE(event.has_heartbeat()) << event.ShortDebugString();
    EXPECT_EQ(event.map().revision(), revision());
  }
}

TEST_F(WatchTest, HeartbeatsOutOfRangeAreRefused) {
  expect_error(Watch(*stub_, 1234, 0, 0.01).finish(), StatusCode::INVALID_ARGUMENT,
               "heartbeat_s: 0.01 is out of range (allowed: 0.1 to 3600, or 0 for the server's 5)");
}

TEST_F(WatchTest, ASlowReaderGetsManyRevisionsInOne) {
  grpc::ChannelArguments narrow;  // the client's own buffer takes next to nothing
  narrow.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 1);
  narrow.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  const auto stub = daemon_.stub(narrow);
  auto [planes, since] = snapshot();
  Watch watch(*stub, 1234, since);
  ASSERT_TRUE(watch.next().has_heartbeat());
  constexpr int kScans = 300;
  const auto begin = since;
  for (int i = 0; i < kScans; ++i) daemon_.map_walls(1, static_cast<std::uint16_t>(900 + 10 * (i % 100)));
  const auto end = revision();
  ASSERT_GT(end, begin + 100);
  int events = 0;
  for (; since < end; ++events) {
    const auto event = watch.next();
    ASSERT_TRUE(event.has_delta()) << event.ShortDebugString();
    EXPECT_EQ(event.delta().since_revision(), since);  // nothing is left out
    take_in(planes, event.delta());
    since = event.map().revision();
  }
  EXPECT_LT(events, static_cast<int>(end - begin) / 4);
  EXPECT_EQ(planes, snapshot().first);
}

TEST_F(WatchTest, FiftyWatchersAllSeeTheSame) {
  const auto [planes_before, since] = snapshot();
  std::vector<std::unique_ptr<v1::PlaneMap::Stub>> stubs;
  std::vector<std::unique_ptr<Watch>> watches;
  for (int i = 0; i < 50; ++i) {
    stubs.push_back(daemon_.stub());
    watches.push_back(std::make_unique<Watch>(*stubs.back(), 1234, since));
    ASSERT_TRUE(watches.back()->next().has_heartbeat());
  }
  daemon_.map_walls(6, 1500);
  const auto expected = snapshot().first;
  ASSERT_NE(expected, planes_before);
  for (auto& watch : watches) {
    Planes planes = planes_before;
    for (auto at = since; at < revision();) {
      const auto event = watch->next();
      ASSERT_TRUE(event.has_delta()) << event.ShortDebugString();
      take_in(planes, event.delta());
      at = event.map().revision();
    }
    EXPECT_EQ(planes, expected);
  }
}

}  // namespace
}  // namespace planemap::service
