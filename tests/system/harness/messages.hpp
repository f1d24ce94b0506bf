#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "support/messages.hpp"

namespace planemap::system_test {

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
