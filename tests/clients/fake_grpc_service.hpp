#pragma once

#include <grpcpp/grpcpp.h>
#include <planemap/v1/planemap_service.grpc.pb.h>

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace planemap::client {

/// A plane with nothing wrong with it.
inline v1::Plane sound_plane() {
  v1::Plane plane;
  plane.set_id(1);
  plane.mutable_normal()->set_z(1.0);
  for (int i = 0; i < 10; ++i) plane.add_covariance(0.0);
  auto& ring = *plane.mutable_outline()->add_polygons()->mutable_outer();
  for (const float value : {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 1.0F}) ring.add_uv_m(value);
  return plane;
}

/// A server on a port of its own that says what it is told to: for what a real one does not do.
class FakeGrpcService final : public v1::PlaneMap::Service {
 public:
  FakeGrpcService() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    if (!server_) throw std::runtime_error("FakeGrpcService: it cannot listen");
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~FakeGrpcService() override {
    release_calls();
    server_->Shutdown(std::chrono::system_clock::now());
  }

  const std::string& address() const { return address_; }

  /// A page of the snapshot, of epoch 7, revision 3; the first is number 0.
  v1::SnapshotPage& add_page() {
    v1::SnapshotPage page;
    page.mutable_map()->set_epoch(7);
    page.mutable_map()->set_revision(3);
    page.set_frame("world");
    page.set_page(static_cast<std::uint32_t>(pages_.size()));
    pages_.push_back(page);
    return pages_.back();
  }
  void clear_pages() { pages_.clear(); }
  /// Calls are not answered until they are released.
  void hold_calls() { is_holding_ = true; }
  void hold_calls_after_pages() { is_holding_after_pages_ = true; }
  void release_calls() {
    const std::lock_guard lock(mutex_);
    is_holding_ = is_holding_after_pages_ = false;
    released_.notify_all();
  }
  /// NearestPlanes answers with a greater revision each time: whatever is asked for, or where no map is named.
  void change_with_each_answer() { is_changing_ = true; }
  void keep_maps_that_are_named() { is_keeping_ = is_changing_ = true; }
  /// The next NearestPlanes that names a map is told that it has gone.
  void forget_map() { has_forgotten_ = true; }
  /// Points and revision of each answer of NearestPlanes.
  std::vector<std::pair<int, std::uint64_t>> batches() {
    const std::lock_guard lock(mutex_);
    return batches_;
  }
  /// What Watch says to each caller before it falls silent.
  void say(std::vector<v1::WatchEvent> events) { events_ = std::move(events); }
  int watches() const { return watches_; }
  /// Each GetStatus, and each Watch after what it was to say, ends so.
  void end_with(grpc::Status status) { end_ = std::move(status); }

  grpc::Status GetStatus(grpc::ServerContext*, const v1::GetStatusRequest*, v1::GetStatusResponse* response) override {
    hold(is_holding_);
    response->mutable_map()->set_epoch(7);
    return end_.value_or(grpc::Status::OK);
  }
  grpc::Status GetSnapshot(grpc::ServerContext*, const v1::GetSnapshotRequest*,
                           grpc::ServerWriter<v1::SnapshotPage>* writer) override {
    hold(is_holding_);
    for (const auto& page : pages_) writer->Write(page);
    hold(is_holding_after_pages_);
    return grpc::Status::OK;
  }
  grpc::Status QueryRegion(grpc::ServerContext*, const v1::QueryRegionRequest*,
                           grpc::ServerWriter<v1::RegionPage>*) override {
    hold(is_holding_);
    return grpc::Status::OK;
  }
  grpc::Status NearestPlanes(grpc::ServerContext*, const v1::NearestPlanesRequest* request,
                             v1::NearestPlanesResponse* response) override {
    if (!is_changing_) return grpc::Status::OK;
    if (request->has_map() && has_forgotten_.exchange(false)) return {grpc::StatusCode::ABORTED, "map: is gone"};
    response->mutable_map()->set_epoch(7);
    response->mutable_map()->set_revision(++revision_);
    if (is_keeping_ && request->has_map()) *response->mutable_map() = request->map();
    const std::lock_guard lock(mutex_);
    batches_.emplace_back(request->points_size(), response->map().revision());
    for (int i = 0; i < request->points_size(); ++i) response->add_results();
    return grpc::Status::OK;
  }
  grpc::Status Watch(grpc::ServerContext* context, const v1::WatchRequest*,
                     grpc::ServerWriter<v1::WatchEvent>* writer) override {
    ++watches_;
    for (const auto& event : events_) writer->Write(event);
    if (end_) return *end_;
    std::unique_lock lock(mutex_);
    while (!context->IsCancelled()) released_.wait_for(lock, std::chrono::milliseconds(5));
    return grpc::Status::CANCELLED;
  }

 private:
  void hold(const std::atomic<bool>& is_held) {
    std::unique_lock lock(mutex_);
    released_.wait(lock, [&] { return !is_held; });
  }

  std::mutex mutex_;
  std::condition_variable released_;
  std::atomic<bool> is_holding_ = false;
  std::atomic<bool> is_holding_after_pages_ = false;
  std::atomic<bool> is_changing_ = false;
  std::atomic<bool> is_keeping_ = false;
  std::atomic<bool> has_forgotten_ = false;
  std::atomic<std::uint64_t> revision_ = 0;
  std::vector<std::pair<int, std::uint64_t>> batches_;
  std::atomic<int> watches_ = 0;
  std::vector<v1::SnapshotPage> pages_;
  std::vector<v1::WatchEvent> events_;
  std::optional<grpc::Status> end_;  ///< set before anybody calls
  std::string address_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace planemap::client
