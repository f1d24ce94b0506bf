#include "sink.hpp"

#include <cerrno>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <utility>

namespace planemap::kinect_bridge {
namespace {

std::string errno_text(int error) {
  return error == 0 ? std::string("unknown error") : std::strerror(error);
}

class LcmSink final : public Sink {
 public:
  explicit LcmSink(const std::string& url) : url_(url), lcm_(url) {}
  bool good() { return lcm_.good(); }

  Expected<void> put(const std::string& channel, std::int64_t /*utime*/, std::span<const std::uint8_t> bytes) override {
    errno = 0;
    if (lcm_.publish(channel, bytes.data(), static_cast<unsigned int>(bytes.size())) == 0) return {};
    return fail(channel + ": " + std::to_string(bytes.size()) + " bytes could not be sent over " + url_ + ": " +
                errno_text(errno));
  }

 private:
  std::string url_;
  lcm::LCM lcm_;
};

class LogSink final : public Sink {
 public:
  explicit LogSink(std::string path) : path_(std::move(path)), log_(path_, "w") {}
  bool good() const { return log_.good(); }

  Expected<void> put(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> bytes) override {
    bytes_.assign(bytes.begin(), bytes.end());  // LCM's event takes no pointer to const
    lcm::LogEvent event{};
    event.timestamp = utime;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(bytes_.size());
    event.data = bytes_.data();
    errno = 0;
    if (log_.writeEvent(&event) == 0) return {};
    return fail(path_ + ": can't be written: " + errno_text(errno));
  }

 private:
  std::string path_;
  lcm::LogFile log_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

Expected<std::unique_ptr<Sink>> open_lcm_sink(const std::string& url) {
  auto sink = std::make_unique<LcmSink>(url);
  if (sink->good()) return sink;
  std::string why = "LCM can't be used with '" + url + "'";
  if (url.starts_with("udpm:")) {
    why +=
        ": is it a multicast address, and does this machine have a route for it? For programs on this machine alone, "
        "as root: ip link set lo up; ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo";
  } else {
    why += ": is it spelled right, as in udpm://239.255.76.67:7667?ttl=0, and what it names running?";
  }
  return fail(why);
}

Expected<std::unique_ptr<Sink>> open_log_sink(const std::string& path) {
  errno = 0;
  auto sink = std::make_unique<LogSink>(path);
  if (!sink->good()) return fail(path + ": can't be written: " + errno_text(errno));
  return sink;
}

}  // namespace planemap::kinect_bridge
