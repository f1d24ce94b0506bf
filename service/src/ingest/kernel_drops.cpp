#include "ingest/kernel_drops.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

namespace planemap::service {
namespace {

std::optional<std::uint64_t> to_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end == text.data()) return std::nullopt;
  return value;
}

/// Inodes of this process's sockets, from links such as "socket:[12345]".
std::set<std::uint64_t> socket_inodes() {
  constexpr std::string_view kPrefix = "socket:[";
  std::set<std::uint64_t> inodes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const std::string target = std::filesystem::read_symlink(entry.path(), error).string();
    if (target.rfind(kPrefix, 0) != 0) continue;
    if (const auto inode = to_number(std::string_view(target).substr(kPrefix.size()))) inodes.insert(*inode);
  }
  return inodes;
}

std::string read_text(const char* path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

std::int64_t KernelDrops::count() {
  last_ = std::max(last_, udp_drops(read_text("/proc/net/udp"), socket_inodes()));
  return last_;
}

std::int64_t udp_drops(std::string_view table, const std::set<std::uint64_t>& inodes) {
  // sl local_address rem_address st tx_queue:rx_queue tr:tm->when retrnsmt uid timeout inode ref pointer drops
  constexpr std::size_t kInode = 9;
  constexpr std::size_t kDrops = 12;
  std::istringstream lines{std::string(table)};
  std::string line;
  std::int64_t drops = 0;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::vector<std::string> columns;
    for (std::string word; words >> word;) columns.push_back(std::move(word));
    if (columns.size() <= kDrops) continue;
    const auto inode = to_number(columns[kInode]);
    const auto count = to_number(columns[kDrops]);
    if (inode && count && inodes.count(*inode) > 0) drops += static_cast<std::int64_t>(*count);
  }
  return drops;
}

std::string receive_buffer_advice(const std::string& url, const std::string& rmem_max_text) {
  constexpr std::string_view kOption = "recv_buf_size=";
  const auto option = url.find(kOption);
  if (url.rfind("udpm", 0) != 0 || option == std::string::npos) return {};
  const auto wanted = to_number(std::string_view(url).substr(option + kOption.size()));
  const auto given = to_number(rmem_max_text);
  if (!wanted || !given || *given >= *wanted) return {};
  return fmt::format(
      "the kernel gives a receive buffer of {} bytes at most, {} are wanted: large scans will be lost. As root: "
      "sysctl -w net.core.rmem_max={}",
      *given, *wanted, *wanted);
}

}  // namespace planemap::service
