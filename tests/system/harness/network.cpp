#include "harness/network.hpp"

#include <sched.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace planemap::system_test {
namespace {

long g_greatest_receive_buffer = 0;

bool write_file(const char* path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  return static_cast<bool>(file);
}

void run(const char* command) {
  if (std::system(command) != 0) throw std::runtime_error(std::string("failed: ") + command);
}

/// Not root: a user namespace in which we are root comes with it.
std::string unshare_as_user() {
  const std::string user = std::to_string(getuid());
  const std::string group = std::to_string(getgid());
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return std::strerror(errno);
  if (!write_file("/proc/self/setgroups", "deny")) return "cannot write /proc/self/setgroups";
  if (!write_file("/proc/self/uid_map", "0 " + user + " 1")) return "cannot write /proc/self/uid_map";
  if (!write_file("/proc/self/gid_map", "0 " + group + " 1")) return "cannot write /proc/self/gid_map";
  return "";
}

}  // namespace

const char* const kLcmUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152";

std::string enter_own_network() {
  std::ifstream("/proc/sys/net/core/rmem_max") >> g_greatest_receive_buffer;
  std::string problem;
  if (geteuid() == 0) {
    if (unshare(CLONE_NEWNET) != 0) problem = std::strerror(errno);
  } else {
    problem = unshare_as_user();
  }
  if (!problem.empty()) return "no network namespace of our own: " + problem;
  if (std::system("ip link set lo up") != 0) return "'ip link set lo up' failed in a network namespace of our own";
  return "";
}

void add_multicast_route() {
  run("ip link set lo multicast on");
  run("ip route replace 224.0.0.0/4 dev lo");
}

void remove_multicast_route() {
  run("ip route del 224.0.0.0/4 dev lo");
}

void lose_datagrams(int percent) {
  run("nft 'add table inet loss; delete table inet loss'");
  if (percent == 0) return;
  const std::string rule = "udp dport 7667 numgen random mod 100 < " + std::to_string(percent) + " drop";
  run(("nft 'add table inet loss; add chain inet loss in { type filter hook input priority 0; }; "
       "add rule inet loss in " +
       rule + "'")
          .c_str());
}

void cut_off_tcp(int port) {
  mend_tcp();
  const std::string way = std::to_string(port) + " drop";
  run(("nft 'add table inet cut; add chain inet cut in { type filter hook input priority 0; }; add rule inet cut in "
       "tcp "
       "dport " +
       way + "; add rule inet cut in tcp sport " + way + "'")
          .c_str());
}

void mend_tcp() {
  run("nft 'add table inet cut; delete table inet cut'");
}

long greatest_receive_buffer() {
  return g_greatest_receive_buffer;
}

}  // namespace planemap::system_test
