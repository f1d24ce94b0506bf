#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace planemap {

/// One TCP connection to this machine's loopback, as a client that is under no obligation to behave.
class TcpClient {
 public:
  /// @throws std::system_error if nobody listens there
  explicit TcpClient(std::uint16_t port);
  ~TcpClient();
  TcpClient(const TcpClient&) = delete;
  TcpClient& operator=(const TcpClient&) = delete;
  TcpClient(TcpClient&& other) noexcept;
  TcpClient& operator=(TcpClient&&) = delete;

  /// @return false: the server has closed
  bool send(const std::string& text);
  /// What comes until the text has come, from the first byte that was not given out yet; all there is where the server
  /// closes or the limit passes before.
  std::string read_until(const std::string& text, std::chrono::milliseconds limit = std::chrono::seconds(30));
  /// So many bytes, or fewer where the server closes or the limit passes.
  std::string read_bytes(std::size_t bytes, std::chrono::milliseconds limit = std::chrono::seconds(30));
  /// Whether the server closes within the limit; what it sends until then is thrown away.
  bool is_closed_within(std::chrono::milliseconds limit);

 private:
  bool receive(std::chrono::steady_clock::time_point deadline);

  int socket_ = -1;
  std::string received_;
  bool is_closed_ = false;
};

struct HttpReply {
  int status = 0;                              ///< 0: there was no answer
  std::map<std::string, std::string> headers;  ///< names in small letters
  std::string body;

  std::string header(const std::string& name) const;
};

/// An answer with Content-Length, or to the end of the connection. @param has_body  false for HEAD
HttpReply read_reply(TcpClient& client, bool has_body = true);
/// GET on a connection of its own. @param headers  whole lines with \r\n
HttpReply http_get(std::uint16_t port, const std::string& target, const std::string& headers = {});
/// What zlib makes of a gzip body; empty: it is none.
std::string gunzipped(const std::string& body);

}  // namespace planemap
