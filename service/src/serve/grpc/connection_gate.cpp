#include "serve/grpc/connection_gate.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "mapping/mapping_service.hpp"

namespace planemap::service {
namespace {

constexpr int kBacklog = 128;
constexpr double kWarnPeriodS = 5.0;
constexpr const char* kNoDescriptor = "no file descriptor is left (raise the limit of open files)";

std::uint16_t port_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

void set_port(sockaddr* address, std::uint16_t port) {
  if (address->sa_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6*>(address)->sin6_port = htons(port);
  } else {
    reinterpret_cast<sockaddr_in*>(address)->sin_port = htons(port);
  }
}

/// A listening socket. @return -1: errno says why not
int listening_socket(const addrinfo& info) {
  const int descriptor = socket(info.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return -1;
  const int on = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);  // no waiting for connections of the life before
  if (info.ai_family == AF_INET6) setsockopt(descriptor, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
  if (bind(descriptor, info.ai_addr, info.ai_addrlen) == 0 && listen(descriptor, kBacklog) == 0) return descriptor;
  const int error = errno;
  close(descriptor);
  errno = error;
  return -1;
}

int open_spare() {
  return open("/dev/null", O_RDONLY | O_CLOEXEC);
}

}  // namespace

ConnectionGate::ConnectionGate(std::size_t max_connections, Counters& counters)
    : max_connections_(max_connections), counters_(counters), repeats_(kWarnPeriodS) {}

Expected<std::unique_ptr<ConnectionGate>> ConnectionGate::open(const ListenAddress& address,
                                                               std::size_t max_connections, Counters& counters) {
  std::unique_ptr<ConnectionGate> gate(new ConnectionGate(max_connections, counters));
  if (auto listens = gate->listen_on(address); !listens) return tl::make_unexpected(listens.error());
  gate->wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  gate->spare_ = open_spare();
  if (gate->wake_ < 0 || gate->spare_ < 0) return fail("grpc.listen: no file descriptor is left");
  return gate;
}

Expected<void> ConnectionGate::listen_on(const ListenAddress& address) {
  const std::string text = address.host + " port " + std::to_string(address.port);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
  if (error != 0) return fail("grpc.listen: " + address.host + " cannot be resolved: " + gai_strerror(error));
  std::string why;
  for (const addrinfo* info = found; info != nullptr; info = info->ai_next) {
    if (port_ != 0) set_port(info->ai_addr, port_);  // a name's other numbers get the port that the first one found
    const int listener = listening_socket(*info);
    if (listener < 0) {
      why = std::strerror(errno);
      if (errno == EADDRINUSE) break;
      continue;
    }
    listeners_.push_back(listener);
    port_ = port_of(listener);
    why.clear();
  }
  freeaddrinfo(found);
  if (!listeners_.empty() && why.empty()) return {};
  return fail("grpc.listen: cannot listen on " + text + ": " + why);
}

ConnectionGate::~ConnectionGate() {
  stop();
  for (const int descriptor : connections_) close(descriptor);
  for (const int descriptor : {wake_, spare_}) {
    if (descriptor >= 0) close(descriptor);
  }
}

void ConnectionGate::start(HandOn hand_on) {
  hand_on_ = std::move(hand_on);
  thread_ = std::thread([this] { run(); });
}

void ConnectionGate::stop() {
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    // Cannot fail: the counter is far from its end.
    if (write(wake_, &one, sizeof one) != sizeof one) spdlog::error("the gate could not be woken");
    thread_.join();
  }
  for (const int listener : listeners_) close(listener);
  listeners_.clear();
}

void ConnectionGate::run() {
  std::vector<pollfd> polled;
  while (true) {
    polled.assign(1, pollfd{wake_, POLLIN, 0});
    for (const int listener : listeners_) polled.push_back({listener, POLLIN, 0});
    for (const int connection : connections_) polled.push_back({connection, 0, 0});  // its end is told unasked
    if (poll(polled.data(), polled.size(), -1) < 0 && errno != EINTR) {
      say("poll", std::string("connections cannot be waited for: ") + std::strerror(errno));
      continue;
    }
    if (polled[0].revents != 0) return;
    std::vector<int> open_connections;
    open_connections.reserve(connections_.size());
    for (auto at = polled.begin() + 1 + static_cast<std::ptrdiff_t>(listeners_.size()); at != polled.end(); ++at) {
      if (at->revents != 0) {
        close(at->fd);
      } else {
        open_connections.push_back(at->fd);
      }
    }
    connections_.swap(open_connections);
    counters_.set("grpc.connections.open", static_cast<std::int64_t>(connections_.size()));
    for (std::size_t i = 0; i < listeners_.size(); ++i) {
      if (polled[1 + i].revents != 0) accept_from(listeners_[i]);
    }
  }
}

void ConnectionGate::accept_from(int listener) {
  const int connection = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (connection < 0) {
    if (errno != EMFILE && errno != ENFILE) return;  // the client has gone again
    refuse("descriptors", kNoDescriptor);
    // Else the client would wait, and poll() would not.
    close(spare_);
    const int refused = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (refused >= 0) close(refused);
    spare_ = open_spare();
    return;
  }
  const bool is_full = connections_.size() >= max_connections_;
  const int watched = is_full ? -1 : fcntl(connection, F_DUPFD_CLOEXEC, 0);
  if (watched < 0) {
    if (is_full) {
      refuse("full", "there are " + std::to_string(connections_.size()) +
                         " connections (grpc.max_connections = " + std::to_string(max_connections_) + ")");
    } else {
      refuse("descriptors", kNoDescriptor);
    }
    close(connection);
    return;
  }
  const int on = 1;
  setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  connections_.push_back(watched);
  counters_.set("grpc.connections.open", static_cast<std::int64_t>(connections_.size()));
  counters_.add("grpc.connections.accepted");
  hand_on_(listener, connection);
}

/// Call it before the client can know.
void ConnectionGate::refuse(const char* kind, const std::string& why) {
  counters_.add("grpc.connections.refused");
  say(kind, "a client was refused: " + why);
}

void ConnectionGate::say(const char* kind, const std::string& text) {
  const int count = repeats_.pass(kind, steady_now_s());
  if (count > 0) spdlog::warn("gRPC: {}{}", text, repeats_text(count));
}

}  // namespace planemap::service
