#include "serve/grpc/grpc_server.hpp"

#include <grpc/support/log.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <mutex>
#include <utility>

#include "codec/proto_status_codec.hpp"
#include "common/clock.hpp"
#include "config/listen_address.hpp"
#include "serve/grpc/admin_service.hpp"
#include "serve/grpc/connection_gate.hpp"
#include "serve/grpc/credentials.hpp"
#include "serve/grpc/pages.hpp"
#include "serve/grpc/plane_map_service.hpp"

namespace planemap::service {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

/// Calls that are being answered get so long to end.
constexpr seconds kGrace(1);
/// Threads of gRPC's own, which the reflection service holds while it is asked.
constexpr int kMaxGrpcThreads = 16;

int in_ms(milliseconds time) {
  return static_cast<int>(time.count());
}

/// Connections whose peer has gone without a word must not hold their place for ever.
void set_connection_options(grpc::ServerBuilder& builder, const GrpcConfig& config) {
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, config.max_streams_per_connection);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, in_ms(seconds(10)));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, in_ms(minutes(10)));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, in_ms(seconds(30)));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, in_ms(seconds(10)));
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, in_ms(seconds(5)));
  builder.SetMaxReceiveMessageSize(config.max_request_bytes);
  builder.SetMaxSendMessageSize(2 * static_cast<int>(kMaxMessageBytes));
  builder.SetResourceQuota(grpc::ResourceQuota("planemapd").SetMaxThreads(kMaxGrpcThreads));
  builder.SetSyncServerOption(grpc::ServerBuilder::NUM_CQS, 1);
  builder.SetSyncServerOption(grpc::ServerBuilder::MAX_POLLERS, 1);
}

/// What gRPC would write to standard error. Clients can bring it to say a lot: it is for those who look for it.
void log_of_grpc(gpr_log_func_args* line) {
  spdlog::debug("gRPC: {} ({}:{})", line->message, line->file, line->line);
}

void set_up_grpc() {
  static std::once_flag once;
  std::call_once(once, [] {
    gpr_set_log_function(log_of_grpc);
    grpc::EnableDefaultHealthCheckService(true);
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  });
}

Expected<CallGuard> guard_of(const GrpcConfig& config) {
  return config.token_file.empty() ? CallGuard() : CallGuard::from_file(config.token_file);
}

}  // namespace

class GrpcServer::Impl {
 public:
  Impl(const ServiceConfig& config, MappingService& mapping, StatusBoard board, Counters& counters, CallGuard guard,
       std::unique_ptr<ConnectionGate> gate)
      : mapping_(mapping),
        address_(*parse_listen_address(config.grpc.listen)),
        board_(std::move(board)),
        guard_(std::move(guard)),
        pool_(static_cast<std::size_t>(config.grpc.threads), static_cast<std::size_t>(config.grpc.max_waiting_calls)),
        desk_{guard_, pool_, counters, config.grpc.max_streams},
        hub_(desk_, config.grpc.heartbeat_s),
        keeper_(config, mapping, [this](const auto& index) { hub_.on_index(index); }),
        plane_map_(desk_, keeper_, hub_, config.map.frame, [this] { return status(); }),
        admin_(desk_, mapping),
        gate_(std::move(gate)) {
    hub_.set_keeper(keeper_);
  }
  ~Impl() { stop(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  bool serve(const GrpcConfig& config, const std::shared_ptr<grpc::ServerCredentials>& credentials) {
    grpc::ServerBuilder builder;
    set_connection_options(builder, config);
    builder.RegisterService(&plane_map_);
    builder.RegisterService(&admin_);
    using Type = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
    acceptor_ = builder.experimental().AddExternalConnectionAcceptor(Type::FROM_FD, credentials);
    server_ = builder.BuildAndStart();
    if (!server_) return false;
    set_serving(true);
    gate_->start([this](int listener, int descriptor) {
      grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
      connection.listener_fd = listener;
      connection.fd = descriptor;
      acceptor_->HandleNewConnection(&connection);
    });
    return true;
  }

  void stop() {
    if (!server_) return;
    server_->GetHealthCheckService()->Shutdown();  // first: who watches the health is told
    gate_->stop();
    hub_.stop();
    server_->Shutdown(std::chrono::system_clock::now() + kGrace);
    server_->Wait();
    pool_.stop();
    keeper_.stop();
    server_.reset();
  }

  void set_serving(bool is_serving) {
    auto* health = server_->GetHealthCheckService();
    for (const char* name : {"", v1::PlaneMap::service_full_name(), v1::Admin::service_full_name()}) {
      health->SetServingStatus(name, is_serving);
    }
  }
  void wake() { keeper_.wake(); }
  std::uint16_t port() const { return gate_->port(); }
  std::string address() const {
    const bool is_v6 = address_.host.find(':') != std::string::npos;
    return (is_v6 ? "[" + address_.host + "]" : address_.host) + ":" + std::to_string(port());
  }

 private:
  v1::GetStatusResponse status() {
    const std::lock_guard lock(board_mutex_);
    return to_proto(board_.status(steady_now_s(), utime_now()), mapping_.snapshot()->utime(), mapping_.is_paused());
  }

  MappingService& mapping_;
  const ListenAddress address_;
  std::mutex board_mutex_;
  StatusBoard board_;
  const CallGuard guard_;
  WorkerPool pool_;
  CallDesk desk_;
  WatchHub hub_;
  IndexKeeper keeper_;
  PlaneMapService plane_map_;
  AdminService admin_;
  std::unique_ptr<ConnectionGate> gate_;
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
  std::unique_ptr<grpc::Server> server_;
};

Expected<std::unique_ptr<GrpcServer>> GrpcServer::start(const ServiceConfig& config, MappingService& mapping,
                                                        StatusBoard board, Counters& counters) {
  set_up_grpc();
  const auto address = parse_listen_address(config.grpc.listen);
  if (!address) return fail("grpc.listen: " + address.error().message);
  if (!address->is_loopback() && config.grpc.tls_certificate.empty()) {
    return fail("grpc.listen: " + config.grpc.listen + " can be reached from other machines: it needs TLS");
  }
  const auto credentials = server_credentials(config.grpc);
  if (!credentials) return tl::make_unexpected(credentials.error());
  auto guard = guard_of(config.grpc);
  if (!guard) return tl::make_unexpected(guard.error());
  auto gate = ConnectionGate::open(*address, static_cast<std::size_t>(config.grpc.max_connections), counters);
  if (!gate) return tl::make_unexpected(gate.error());
  auto impl = std::make_unique<Impl>(config, mapping, std::move(board), counters, std::move(*guard), std::move(*gate));
  if (!impl->serve(config.grpc, *credentials))
    return fail("grpc: the server could not be started; log.level: debug says more");
  return std::unique_ptr<GrpcServer>(new GrpcServer(std::move(impl)));
}

GrpcServer::GrpcServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

GrpcServer::~GrpcServer() = default;

std::uint16_t GrpcServer::port() const {
  return impl_->port();
}

std::string GrpcServer::address() const {
  return impl_->address();
}

void GrpcServer::set_serving(bool is_serving) {
  impl_->set_serving(is_serving);
}

void GrpcServer::wake() {
  impl_->wake();
}

void GrpcServer::stop() {
  impl_->stop();
}

}  // namespace planemap::service
