#include "grpc_channel.hpp"

#include <algorithm>
#include <utility>

#include "deadline.hpp"

namespace planemap::client {
namespace {

using grpc::StatusCode;
using Kind = Error::Kind;

tl::unexpected<Error> unusable(std::string message) {
  return tl::make_unexpected(Error{Kind::kNoNetwork, std::move(message)});
}

bool is_pem(const std::string& text) {
  return text.find("-----BEGIN ") != std::string::npos;
}

/// gRPC itself would say of such options that the server cannot be reached.
Expected<void> check(const GrpcClientOptions& options, const ServerAddress& address) {
  if (!options.ca.empty() && !is_pem(options.ca)) return unusable("ca: holds no certificate in PEM");
  if (options.client_certificate.empty() != options.client_key.empty()) {
    return unusable("client_certificate, client_key: each needs the other");
  }
  if (!options.client_key.empty() && !(is_pem(options.client_certificate) && is_pem(options.client_key))) {
    return unusable("client_certificate, client_key: are not both in PEM");
  }
  const auto is_printable = [](char c) { return c > ' ' && c <= '~'; };
  if (!std::all_of(options.token.begin(), options.token.end(), is_printable)) {
    return unusable("token: must be of printable ASCII characters, without blanks");
  }
  if (!options.token.empty() && !options.has_tls() && !address.is_loopback()) {
    return unusable("token: would go to " + address.text() +
                    " for everybody to read; it is sent over TLS or to the loopback only (name the authority, ca)");
  }
  return {};
}

std::shared_ptr<grpc::ChannelCredentials> credentials_of(const GrpcClientOptions& options) {
  if (!options.has_tls()) return grpc::InsecureChannelCredentials();
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = options.ca;
  tls.pem_private_key = options.client_key;
  tls.pem_cert_chain = options.client_certificate;
  return grpc::SslCredentials(tls);
}

/// What gRPC said, and what is often behind it.
std::string unreachable_how(const GrpcClientOptions& options, const std::string& said) {
  if (options.has_tls()) return " over TLS (" + said + ")";
  const bool was_answered = said.find("onnection refused") == std::string::npos;
  return " (" + said + (was_answered ? "); if it speaks TLS, name its authority" : ")");
}

std::shared_ptr<grpc::Channel> channel_to(const ServerAddress& address, const GrpcClientOptions& options) {
  grpc::ChannelArguments arguments;
  // A service on the robot or beside it: not to be looked for through the proxies of an office.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own
  // A cable that was pulled out says nothing: without these TCP goes on trying for a quarter of an hour.
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 10000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5000);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 500);
  if (options.has_tls() && !options.server_name.empty()) arguments.SetSslTargetNameOverride(options.server_name);
  return grpc::CreateCustomChannel(address.text(), credentials_of(options), arguments);
}

}  // namespace

GrpcChannel::GrpcChannel(ServerAddress address, GrpcClientOptions options)
    : address_(std::move(address)), options_(std::move(options)) {
  const auto channel = channel_to(address_, options_);
  plane_map_ = v1::PlaneMap::NewStub(channel);
  admin_ = v1::Admin::NewStub(channel);
}

std::shared_ptr<GrpcChannel> GrpcChannel::connect_again() const {
  return std::make_shared<GrpcChannel>(address_, options_);
}

void GrpcChannel::prepare(grpc::ClientContext& context) const {
  if (!options_.token.empty()) context.AddMetadata("authorization", "Bearer " + options_.token);
}

void GrpcChannel::prepare(grpc::ClientContext& context, std::chrono::milliseconds timeout) const {
  prepare(context);
  context.set_deadline(std::chrono::system_clock::now() + timeout);
}

Error GrpcChannel::error_of(const grpc::Status& status, std::chrono::milliseconds timeout) const {
  const std::string& said = status.error_message();
  switch (status.error_code()) {
    case StatusCode::UNAVAILABLE:
      return {Kind::kUnreachable, "no planemapd can be reached at " + server() + unreachable_how(options_, said)};
    // Nobody but the service cancels calls that are told of here: a gRPC server that ends does so with what is left.
    case StatusCode::CANCELLED:
      return {Kind::kUnreachable, "the service at " + server() + " ended the call (" + said + ")"};
    case StatusCode::DEADLINE_EXCEEDED:
      return {Kind::kUnreachable, "no answer came from " + server() + " within " + seconds_text(timeout)};
    case StatusCode::UNAUTHENTICATED:
    case StatusCode::PERMISSION_DENIED:
      return {Kind::kDenied, "the service refused the request: " + said};
    case StatusCode::UNIMPLEMENTED:
      return {Kind::kRefused, "the service cannot do that: " + said};
    case StatusCode::ABORTED:
      return {Kind::kGone, "the service began anew: " + said};
    case StatusCode::INVALID_ARGUMENT:
    case StatusCode::FAILED_PRECONDITION:
    case StatusCode::NOT_FOUND:
    case StatusCode::RESOURCE_EXHAUSTED:
      return {Kind::kRefused, "the service refused the request: " + said};
    default:
      return {Kind::kMalformed, "the call to " + server() + " failed: " + said + " (gRPC status " +
                                    std::to_string(static_cast<int>(status.error_code())) +
                                    "); is a planemapd listening there?"};
  }
}

Expected<GrpcConnection> GrpcConnection::open(const std::string& server, const GrpcClientOptions& options) {
  auto address = parse_server_address(server);
  if (!address) return tl::make_unexpected(address.error());
  if (auto good = check(options, *address); !good) return tl::make_unexpected(good.error());
  return GrpcConnection(std::make_shared<GrpcChannel>(std::move(*address), options));
}

}  // namespace planemap::client
