#include "harness/messages.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace planemap::system_test {
namespace {

constexpr std::uint32_t kShortMagic = 0x4c433032;     // "LC02"
constexpr std::uint32_t kFragmentMagic = 0x4c433033;  // "LC03"

void put(Bytes& bytes, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

void put16(Bytes& bytes, std::uint16_t number) {
  bytes.push_back(static_cast<std::uint8_t>(number >> 8));
  bytes.push_back(static_cast<std::uint8_t>(number));
}

void put(Bytes& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.push_back(0);
}

}  // namespace

Bytes with_number(Bytes bytes, std::size_t at, std::int32_t number) {
  if (at + 4 > bytes.size()) throw std::out_of_range("with_number: behind the end of the message");
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(number) >> (24 - 8 * i));
  }
  return bytes;
}

RawSender::RawSender() : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
  if (socket_ < 0) throw std::system_error(errno, std::generic_category(), "socket");
  const std::uint8_t ttl = 0;
  setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
}

RawSender::~RawSender() {
  close(socket_);
}

void RawSender::send(const Bytes& datagram) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);
  inet_pton(AF_INET, "239.255.76.67", &address.sin_addr);
  const auto sent =
      sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  if (sent != static_cast<ssize_t>(datagram.size())) {
    throw std::system_error(errno, std::generic_category(), "sendto");
  }
}

Bytes short_datagram(const std::string& channel, const Bytes& message, std::uint32_t sequence) {
  Bytes datagram;
  put(datagram, kShortMagic);
  put(datagram, sequence);
  put(datagram, channel);
  datagram.insert(datagram.end(), message.begin(), message.end());
  return datagram;
}

Bytes fragment_datagram(const Fragment& fragment, const std::string& channel, const Bytes& payload) {
  Bytes datagram;
  put(datagram, kFragmentMagic);
  put(datagram, fragment.sequence);
  put(datagram, fragment.message_size);
  put(datagram, fragment.offset);
  put16(datagram, fragment.number);
  put16(datagram, fragment.count);
  if (fragment.number == 0) put(datagram, channel);
  datagram.insert(datagram.end(), payload.begin(), payload.end());
  return datagram;
}

}  // namespace planemap::system_test
