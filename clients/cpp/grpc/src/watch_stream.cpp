#include "watch_stream.hpp"

#include <algorithm>

namespace planemap::client {
namespace {

/// gRPC takes the system's clock; what it may leap by is not counted.
std::chrono::system_clock::time_point system_time(WatchStream::Clock::time_point time) {
  const auto left = std::max(time - WatchStream::Clock::now(), WatchStream::Clock::duration::zero());
  return std::chrono::system_clock::now() + std::chrono::ceil<std::chrono::microseconds>(left);
}

}  // namespace

WatchStream::WatchStream(GrpcChannel& channel, const MapVersion& known) {
  v1::WatchRequest request;
  request.set_epoch(static_cast<std::uint64_t>(known.epoch));
  request.set_since_revision(static_cast<std::uint64_t>(known.revision));
  request.set_heartbeat_s(std::chrono::duration<double>(channel.options().heartbeat).count());
  channel.prepare(context_);
  reader_ = channel.plane_map().AsyncWatch(&context_, request, &queue_, tag(Step::kStarted));
}

WatchStream::~WatchStream() {
  context_.TryCancel();
  queue_.Shutdown();
  void* step = nullptr;
  bool ok = false;
  while (queue_.Next(&step, &ok)) {  // what was under way must end before the call goes
  }
}

std::variant<WatchStream::Nothing, const v1::WatchEvent*, grpc::Status> WatchStream::next(Clock::time_point until) {
  if (is_started_ && !is_reading_) {
    is_reading_ = true;
    reader_->Read(&event_, tag(Step::kRead));
  }
  for (;;) {
    void* step = nullptr;
    bool ok = false;
    if (queue_.AsyncNext(&step, &ok, system_time(until)) != grpc::CompletionQueue::GOT_EVENT) return Nothing{};
    if (step == tag(Step::kFinished)) return status_;
    if (!ok) {
      reader_->Finish(&status_, tag(Step::kFinished));
    } else if (step == tag(Step::kStarted)) {
      is_started_ = is_reading_ = true;
      reader_->Read(&event_, tag(Step::kRead));
    } else {
      is_reading_ = false;
      return &event_;
    }
  }
}

}  // namespace planemap::client
