#include "config/listen_address.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <charconv>

namespace planemap::service {

bool is_loopback_number(const std::string& host) {
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6{};
  if (inet_pton(AF_INET6, host.c_str(), &v6) != 1) return false;
  const auto* byte = static_cast<const std::uint8_t*>(v6.s6_addr);
  if (std::all_of(byte, byte + 10, [](std::uint8_t b) { return b == 0; }) && byte[10] == 0xff && byte[11] == 0xff) {
    return byte[12] == 127;
  }
  return std::all_of(byte, byte + 15, [](std::uint8_t b) { return b == 0; }) && byte[15] == 1;
}

bool ListenAddress::is_loopback() const {
  return host == "localhost" || is_loopback_number(host);
}

Expected<ListenAddress> parse_listen_address(const std::string& text) {
  const auto wrong = [&](const std::string& why) {
    return fail("'" + text + "' is no HOST:PORT: " + why + " (for instance 127.0.0.1:7670 or [::1]:7670)");
  };
  const auto colon = text.rfind(':');
  if (colon == std::string::npos) return wrong("it has no port");
  std::string host = text.substr(0, colon);
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string::npos) {
    return wrong("an IPv6 number needs brackets");
  }
  if (host.empty()) return wrong("it has no host");
  const char* begin = text.data() + colon + 1;
  const char* end = text.data() + text.size();
  ListenAddress address{std::move(host), 0};
  const auto [stop, error] = std::from_chars(begin, end, address.port);
  if (error != std::errc{} || stop != end) return wrong("the port must be a number from 0 to 65535");
  return address;
}

}  // namespace planemap::service
