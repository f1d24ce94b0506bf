#pragma once

#include <bot_core/pose_t.hpp>
#include <cstdint>
#include <planemap_lcm/depth_scan_t.hpp>
#include <planemap_lcm/request_t.hpp>
#include <string>
#include <vector>

namespace planemap::system_test {

using Bytes = std::vector<std::uint8_t>;

/// A depth image of a wall two metres ahead, 160x120 pixels.
planemap_lcm::depth_scan_t wall_scan(std::int64_t utime, std::int32_t seq);

/// The body at the origin, looking along the world's axes.
bot_core::pose_t still_pose(std::int64_t utime);

/// A request for the status, answered on PLANEMAP_REPLY_TEST.
planemap_lcm::request_t status_request(std::int64_t request_id);

/// The message as it travels.
template <class Message>
Bytes bytes_of(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// The bytes with a big-endian number written over them.
Bytes with_number(Bytes bytes, std::size_t at, std::int32_t number);

/// Sends datagrams as they are to LCM's group and port, past the LCM library.
class RawSender {
 public:
  RawSender();
  ~RawSender();
  RawSender(const RawSender&) = delete;
  RawSender& operator=(const RawSender&) = delete;
  void send(const Bytes& datagram);

 private:
  int socket_;
};

/// One whole message in one datagram, as the LCM library sends it.
Bytes short_datagram(const std::string& channel, const Bytes& message, std::uint32_t sequence);

/// One fragment of a message; the first one brings the channel.
struct Fragment {
  std::uint32_t sequence = 0;
  std::uint32_t message_size = 0;
  std::uint32_t offset = 0;
  std::uint16_t number = 0;
  std::uint16_t count = 0;
};
Bytes fragment_datagram(const Fragment& fragment, const std::string& channel, const Bytes& payload);

}  // namespace planemap::system_test
