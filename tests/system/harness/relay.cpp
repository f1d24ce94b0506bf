#include "harness/relay.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stop_token>
#include <system_error>
#include <utility>

namespace planemap::system_test {
namespace {

constexpr std::uint16_t kNearPort = 7667;
constexpr std::uint16_t kFarPort = 7668;
constexpr const char* kGroup = "239.255.76.67";
constexpr int kMostHeldBack = 8;
constexpr int kWaitMs = 5;  // with nothing to carry: then what is held back goes

void check(int result, const char* what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
}

sockaddr_in address_of(const char* host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  inet_pton(AF_INET, host, &address.sin_addr);
  return address;
}

int listening_socket(std::uint16_t port) {
  const int listener = socket(AF_INET, SOCK_DGRAM, 0);
  check(listener, "socket");
  const int on = 1;
  const int buffer_bytes = 4 << 20;
  check(setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on), "SO_REUSEADDR");
  setsockopt(listener, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
  const sockaddr_in address = address_of(kGroup, port);
  check(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), "bind");
  ip_mreq group{};
  inet_pton(AF_INET, kGroup, &group.imr_multiaddr);
  check(setsockopt(listener, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group), "IP_ADD_MEMBERSHIP");
  return listener;
}

}  // namespace

const char* const kFarLcmUrl = "udpm://239.255.76.67:7668?ttl=0&recv_buf_size=2097152";

Relay::Relay(const Mischief& mischief) : mischief_(mischief), sender_(socket(AF_INET, SOCK_DGRAM, 0)) {
  check(sender_, "socket");
  const std::uint8_t ttl = 0;
  check(setsockopt(sender_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl), "IP_MULTICAST_TTL");
  const sockaddr_in any = address_of("0.0.0.0", 0);
  check(bind(sender_, reinterpret_cast<const sockaddr*>(&any), sizeof any), "bind");
  sockaddr_in own{};
  socklen_t size = sizeof own;
  check(getsockname(sender_, reinterpret_cast<sockaddr*>(&own), &size), "getsockname");
  sender_port_ = ntohs(own.sin_port);
  ways_.push_back({listening_socket(kNearPort), kFarPort, {}});
  ways_.push_back({listening_socket(kFarPort), kNearPort, {}});
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Relay::~Relay() {
  thread_.request_stop();
  thread_.join();
  close(sender_);
  for (const Way& way : ways_) close(way.from);
}

void Relay::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    pollfd ready[2] = {{ways_[0].from, POLLIN, 0}, {ways_[1].from, POLLIN, 0}};
    const bool is_quiet = poll(ready, 2, kWaitMs) <= 0;
    for (std::size_t i = 0; i < 2; ++i) {
      if ((ready[i].revents & POLLIN) != 0) carry(ways_[i]);
      if (is_quiet) release(ways_[i], /*all=*/true);
    }
  }
}

void Relay::carry(Way& way) {
  Datagram datagram(65536);
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const auto bytes = recvfrom(way.from, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
  if (bytes <= 0 || ntohs(from.sin_port) == sender_port_) return;  // what it sent itself
  datagram.resize(static_cast<std::size_t>(bytes));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  if (share(random_) < mischief_.late) {
    ++delayed_;
    way.held.push_back({datagram, 1 + static_cast<int>(random_() % kMostHeldBack)});
    return;
  }
  send(way, datagram);
  if (share(random_) < mischief_.twice) {
    ++doubled_;
    send(way, datagram);
  }
  release(way, /*all=*/false);
}

void Relay::send(const Way& way, const Datagram& datagram) {
  const sockaddr_in address = address_of(kGroup, way.to_port);
  sendto(sender_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  ++carried_;
}

void Relay::release(Way& way, bool all) {
  std::vector<Held> still_held;
  for (Held& held : way.held) {
    if (all || --held.others_first <= 0) {
      send(way, held.datagram);
    } else {
      still_held.push_back(std::move(held));
    }
  }
  way.held = std::move(still_held);
}

}  // namespace planemap::system_test
