#pragma once

#include <grpcpp/grpcpp.h>
#include <planemap/v1/map.pb.h>

#include <chrono>
#include <memory>
#include <planemap/client/query_types.hpp>
#include <variant>

#include "grpc_channel.hpp"

namespace planemap::client {

/// One call of Watch. Events are read on the caller's thread, one at a time: what is not asked for stays with the
/// server, which puts changes together for slow readers.
class WatchStream {
 public:
  using Clock = std::chrono::steady_clock;
  struct Nothing {};  ///< nothing came in time

  /// Begins the call. @param known  what the caller has; epoch 0: nothing
  WatchStream(GrpcChannel& channel, const MapVersion& known);
  ~WatchStream();
  WatchStream(const WatchStream&) = delete;
  WatchStream& operator=(const WatchStream&) = delete;

  /// The next event, which is valid until the next call; or how the call ended, after which there is no more to ask.
  std::variant<Nothing, const v1::WatchEvent*, grpc::Status> next(Clock::time_point until);

 private:
  enum class Step : char { kStarted, kRead, kFinished };
  void* tag(Step step) { return &tags_[static_cast<std::size_t>(step)]; }

  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::ClientAsyncReader<v1::WatchEvent>> reader_;
  v1::WatchEvent event_;
  grpc::Status status_;
  char tags_[3] = {};
  bool is_reading_ = false;  ///< a read is under way, or its event not yet told
  bool is_started_ = false;
};

}  // namespace planemap::client
