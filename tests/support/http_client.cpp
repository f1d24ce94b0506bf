#include "support/http_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <sstream>
#include <system_error>
#include <utility>

namespace planemap {

using Clock = std::chrono::steady_clock;

TcpClient::TcpClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
  const int error = errno;
  ::close(socket_);
  throw std::system_error(error, std::generic_category(), "port " + std::to_string(port));
}

TcpClient::TcpClient(TcpClient&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), received_(std::move(other.received_)), is_closed_(other.is_closed_) {}

TcpClient::~TcpClient() {
  if (socket_ >= 0) ::close(socket_);
}

bool TcpClient::send(const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const auto count = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

/// Something more. @return false: there will be nothing, or not in time
bool TcpClient::receive(Clock::time_point deadline) {
  if (is_closed_) return false;
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
  pollfd polled{socket_, POLLIN, 0};
  if (::poll(&polled, 1, static_cast<int>(std::max<std::int64_t>(0, left))) <= 0) return false;
  std::array<char, 65536> bytes{};
  const auto count = ::recv(socket_, bytes.data(), bytes.size(), 0);
  is_closed_ = count <= 0;
  if (!is_closed_) received_.append(bytes.data(), static_cast<std::size_t>(count));
  return !is_closed_;
}

std::string TcpClient::read_until(const std::string& text, std::chrono::milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  std::size_t searched = 0;
  auto found = received_.find(text);
  while (found == std::string::npos) {
    searched = received_.size() > text.size() ? received_.size() - text.size() : 0;
    if (!receive(deadline)) return std::exchange(received_, {});
    found = received_.find(text, searched);
  }
  std::string result = received_.substr(0, found + text.size());
  received_.erase(0, found + text.size());
  return result;
}

std::string TcpClient::read_bytes(std::size_t bytes, std::chrono::milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (received_.size() < bytes && receive(deadline)) {
  }
  std::string result = received_.substr(0, bytes);
  received_.erase(0, result.size());
  return result;
}

bool TcpClient::is_closed_within(std::chrono::milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (receive(deadline)) received_.clear();
  return is_closed_;
}

std::string HttpReply::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? std::string() : found->second;
}

HttpReply read_reply(TcpClient& client, bool has_body) {
  HttpReply reply;
  std::istringstream head(client.read_until("\r\n\r\n"));
  std::string version;
  std::string line;
  head >> version >> reply.status;
  std::getline(head, line);
  while (std::getline(head, line)) {
    const auto colon = line.find(": ");
    if (colon == std::string::npos) continue;
    std::string name = line.substr(0, colon);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    reply.headers[name] = line.substr(colon + 2, line.size() - colon - 3);
  }
  if (!has_body || reply.status == 0) return reply;
  const std::string length = reply.header("content-length");
  if (!length.empty()) reply.body = client.read_bytes(std::stoul(length));
  return reply;
}

HttpReply http_get(std::uint16_t port, const std::string& target, const std::string& headers) {
  TcpClient client(port);
  client.send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers + "\r\n");
  return read_reply(client);
}

std::string gunzipped(const std::string& body) {
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) return {};
  std::string out;
  std::array<char, 65536> piece{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(body.data()));  // zlib does not write there
  stream.avail_in = static_cast<uInt>(body.size());
  int result = Z_OK;
  while (result == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    result = inflate(&stream, Z_NO_FLUSH);
    out.append(piece.data(), piece.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return result == Z_STREAM_END ? out : std::string();
}

}  // namespace planemap
