#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace planemap::service {

/// Datagrams that the kernel threw away because the receive buffer of one of this process's UDP sockets was full.
class KernelDrops {
 public:
  /// Since the sockets were opened; the greatest count so far where /proc cannot be read.
  std::int64_t count();

 private:
  std::int64_t last_ = 0;
};

/// Sum of the drops of the sockets with the given inodes.
/// @param table  text of /proc/net/udp
std::int64_t udp_drops(std::string_view table, const std::set<std::uint64_t>& inodes);

/// What to do if the kernel gives less receive buffer than is asked for; empty: nothing.
/// @param url            as given to LCM
/// @param rmem_max_text  text of /proc/sys/net/core/rmem_max; empty: not known
std::string receive_buffer_advice(const std::string& url, const std::string& rmem_max_text);

}  // namespace planemap::service
