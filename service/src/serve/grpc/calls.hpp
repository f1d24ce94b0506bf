#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/counters.hpp"
#include "serve/grpc/call_guard.hpp"
#include "serve/worker_pool.hpp"

namespace planemap::service {

/// What all calls go through: who may call, room, counters. Outlives them.
struct CallDesk {
  const CallGuard& guard;
  WorkerPool& pool;
  Counters& counters;
  const int max_streams;
  std::atomic<int> streams = 0;

  /// OK, or why the caller is not let in.
  grpc::Status admit(const grpc::CallbackServerContext& context, Scope needed);
  /// OK and one more stream, which leave_stream() gives back; or why there is no room.
  grpc::Status enter_stream();
  void leave_stream() { --streams; }
  /// Counts how a call ended (grpc.calls.ok, grpc.calls.failed.<code>), and gives the status back.
  grpc::Status counted(grpc::Status status);
};

/// What a call ends with where as many as may wait already.
grpc::Status no_room(const WorkerPool& pool);
/// What a call ends with where the service itself failed; the log says so, too.
grpc::Status internal_error(const std::exception& cause);

/// One answer to one request, worked out on the pool.
/// @param work  fills the response; runs on a thread of the pool, unless the caller has gone by then
grpc::ServerUnaryReactor* answer(CallDesk& desk, grpc::CallbackServerContext* context, Scope needed,
                                 std::function<grpc::Status()> work);

/// An answer in pages. The next one is made on the pool when the one before is on its way, so that a slow reader costs
/// one page; the reactor deletes itself when the call is over.
template <class Page>
class PageReactor : public grpc::ServerWriteReactor<Page> {
 public:
  /// Fills the next page, which comes empty, and says whether it is the last.
  using Next = std::function<bool(Page&)>;
  /// Looks at the request, and gives what makes the pages, or fills the status. On the pool, like Next.
  using Begin = std::function<Next(grpc::Status&)>;

  static grpc::ServerWriteReactor<Page>* start(CallDesk& desk, grpc::CallbackServerContext* context, Begin begin) {
    auto* reactor = new PageReactor(desk, context);
    grpc::Status status = desk.admit(*context, Scope::kRead);
    if (status.ok()) {
      status = desk.enter_stream();
      reactor->is_in_ = status.ok();
    }
    if (status.ok() && !desk.pool.try_post([reactor, begin = std::move(begin)] { reactor->open(begin); })) {
      status = no_room(desk.pool);
    }
    if (!status.ok()) reactor->end(std::move(status));
    return reactor;
  }

  void OnWriteDone(bool ok) override {
    if (!ok || is_last_) return end(ok ? grpc::Status::OK : grpc::Status::CANCELLED);
    desk_.pool.post([this] { make_page(); });
  }
  void OnDone() override { delete this; }
  void OnCancel() override {}  // a write that is on its way fails, and the next page is not made

 private:
  PageReactor(CallDesk& desk, grpc::CallbackServerContext* context) : desk_(desk), context_(context) {}
  ~PageReactor() override {
    if (is_in_) desk_.leave_stream();
  }

  void open(const Begin& begin) {
    if (context_->IsCancelled()) return end(grpc::Status::CANCELLED);
    grpc::Status status;
    try {
      next_ = begin(status);
    } catch (const std::exception& e) {
      status = internal_error(e);
    }
    if (!status.ok()) return end(std::move(status));
    make_page();
  }
  void make_page() {
    if (context_->IsCancelled()) return end(grpc::Status::CANCELLED);
    page_.Clear();
    try {
      is_last_ = next_(page_);
    } catch (const std::exception& e) {
      return end(internal_error(e));
    }
    this->StartWrite(&page_);
  }
  void end(grpc::Status status) { this->Finish(desk_.counted(std::move(status))); }

  CallDesk& desk_;
  grpc::CallbackServerContext* context_;
  Next next_;
  Page page_;
  bool is_in_ = false;
  bool is_last_ = false;
};

}  // namespace planemap::service
