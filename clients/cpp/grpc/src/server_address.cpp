#include "server_address.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace planemap::client {
namespace {

constexpr const char* kDefaultPort = "7670";

bool is_port(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number >= 1 && number <= 65535;
}

bool is_host(std::string_view text) {
  const auto may_be = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-' ||
           c == '_' || c == ':' || c == '%';
  };
  return !text.empty() && std::all_of(text.begin(), text.end(), may_be);
}

}  // namespace

std::string ServerAddress::text() const {
  return (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + port;
}

bool ServerAddress::is_loopback() const {
  return host == "localhost" || host == "::1" ||
         (host.rfind("127.", 0) == 0 && host.find_first_not_of("0123456789.") == std::string::npos);
}

Expected<ServerAddress> parse_server_address(const std::string& server) {
  ServerAddress address{server, kDefaultPort};
  const auto colons = std::count(server.begin(), server.end(), ':');
  if (const auto bracket = server.find(']'); server.rfind('[', 0) == 0 && bracket != std::string::npos) {
    address.host = server.substr(1, bracket - 1);
    if (bracket + 1 < server.size()) address.port = server[bracket + 1] == ':' ? server.substr(bracket + 2) : "";
  } else if (colons == 1) {
    address.host = server.substr(0, server.find(':'));
    address.port = server.substr(server.find(':') + 1);
  }
  if (is_host(address.host) && is_port(address.port)) return address;
  return tl::make_unexpected(Error{Error::Kind::kNoNetwork, "'" + server.substr(0, 200) +
                                                                "' is no address of a server: it must be HOST, "
                                                                "HOST:PORT or [IPv6]:PORT, with a port of 1 to 65535"});
}

}  // namespace planemap::client
