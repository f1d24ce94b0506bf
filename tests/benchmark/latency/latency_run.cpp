#include "latency/latency_run.hpp"

#include <time.h>

#include <algorithm>
#include <bot_core/pose_t.hpp>
#include <chrono>
#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <planemap_lcm/depth_scan_t.hpp>
#include <planemap_lcm/planes_t.hpp>
#include <planemap_lcm/status_t.hpp>
#include <stdexcept>
#include <support/process.hpp>
#include <support/temporary_folder.hpp>
#include <thread>

#include "latency/sender.hpp"

namespace planemap::benchmark {

namespace {

using std::chrono::steady_clock;

/// Hears scans, poses, deltas and the status. Arrivals are those of the kernel (SO_TIMESTAMP of a message's last
/// datagram), so it does not matter how soon this thread runs.
class Listener {
 public:
  explicit Listener(const std::string& url) : lcm_(url) {
    if (!lcm_.good()) throw std::runtime_error("LCM does not start with " + url);
    for (const char* channel : {"PLANEMAP_SCAN", "POSE", "PLANEMAP_DELTA", "PLANEMAP_STATUS"}) {
      lcm_.subscribe(channel, &Listener::on_message, this)->setQueueCapacity(0);
    }
  }

  /// Until the condition holds, or the time is up; looked at after each message, and every 20 ms.
  template <class Condition>
  bool listen_until(const Condition& condition, std::chrono::milliseconds limit) {
    const auto end = steady_clock::now() + limit;
    while (!condition()) {
      if (steady_clock::now() >= end) return false;
      lcm_.handleTimeout(20);
    }
    return true;
  }

  const LatencyMeter& meter() const { return meter_; }
  const std::optional<planemap_lcm::status_t>& status() const { return status_; }

 private:
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    // Of scans and poses the time is enough, and it comes first: after the fingerprint, big-endian.
    if (channel == "PLANEMAP_SCAN") return meter_.scan_arrived(utime_of(*buffer), buffer->recv_utime);
    if (channel == "POSE") return meter_.pose_arrived(utime_of(*buffer), buffer->recv_utime);
    if (channel == "PLANEMAP_STATUS") {
      planemap_lcm::status_t status;
      if (status.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) > 0) status_ = std::move(status);
      return;
    }
    planemap_lcm::planes_t delta;
    if (delta.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) <= 0) return;
    meter_.page_arrived(delta.utime, delta.revision, delta.page, delta.page_count, buffer->recv_utime);
  }

  static std::int64_t utime_of(const lcm::ReceiveBuffer& buffer) {
    constexpr std::uint32_t kFingerprintBytes = 8;
    if (buffer.data_size < 2 * kFingerprintBytes) return 0;
    const auto* bytes = static_cast<const std::uint8_t*>(buffer.data) + kFingerprintBytes;
    std::uint64_t value = 0;
    for (int i = 0; i < 8; ++i) value = value << 8U | bytes[i];
    return static_cast<std::int64_t>(value);
  }

  lcm::LCM lcm_;
  LatencyMeter meter_;
  std::optional<planemap_lcm::status_t> status_;
};

/// What a process has taken of its cores so far, seconds; 0 where that is not known.
double cpu_seconds(pid_t pid) {
  clockid_t clock = 0;
  timespec time{};
  if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<std::string> command_of(const LatencyConfig& config) {
  std::vector<std::string> command = config.daemon;
  const auto set = [&](const std::string& setting) {
    command.emplace_back("--set");
    command.push_back(setting);
  };
  command.insert(command.end(), {"--lcm-url", config.url});
  set("publish.status_period_s=0.1");
  set("grpc.listen=");
  set("http.listen=");
  set("pose.exact_s=0");  // a pose is only before or after a scan, so it is known which one the daemon waits for
  for (const std::string& setting : config.settings) set(setting);
  return command;
}

LatencyResult result_of(const Listener& listener) {
  LatencyResult result;
  result.heard = listener.meter().scans();
  result.deltas = listener.meter().deltas();
  result.scans = listener.meter().latencies();
  const planemap_lcm::status_t& status = *listener.status();
  for (const auto& counter : status.counters) result.counters[counter.name] = counter.value;
  result.scan_ms_p50 = status.scan_ms_p50;
  result.scan_ms_max = status.scan_ms_max;
  result.planes = status.plane_count;
  return result;
}

}  // namespace

std::int64_t LatencyResult::counter(const std::string& name) const {
  const auto found = counters.find(name);
  return found == counters.end() ? 0 : found->second;
}

std::int64_t LatencyResult::counters_beginning(const std::string& prefix) const {
  std::int64_t sum = 0;
  for (const auto& [name, value] : counters) {
    if (name.starts_with(prefix)) sum += value;
  }
  return sum;
}

LatencyResult run_latency(const LatencyConfig& config, const std::vector<sources::Frame>& frames) {
  using std::chrono_literals::operator""s;
  const TemporaryFolder scratch;
  Sender sender(config, frames);
  Listener listener(config.url);
  Process daemon(command_of(config), scratch / "planemapd.log");
  const auto fail_if_ended = [&] {
    if (!daemon.running()) throw std::runtime_error("planemapd ended; it said:\n" + daemon.output());
  };
  if (!listener.listen_until([&] { return listener.status().has_value() || !daemon.running(); }, 20s) ||
      !daemon.running()) {
    throw std::runtime_error("planemapd did not come up; it said:\n" + daemon.output());
  }
  const double cpu_begin_s = cpu_seconds(daemon.pid());
  const auto begin = steady_clock::now();
  sender.start();
  listener.listen_until([&] { return sender.is_done() || !daemon.running(); }, std::chrono::hours(48));
  fail_if_ended();
  const double seconds = std::chrono::duration<double>(steady_clock::now() - begin).count();
  const double cpu_s = cpu_seconds(daemon.pid()) - cpu_begin_s;
  // What is under way still arrives, and the status that counts it; what was lost does not.
  listener.listen_until([&] { return listener.meter().is_up_to_date(); }, 30s);
  const std::int64_t last_status = listener.status()->utime;
  const auto has_settled = [&] {
    if (listener.status()->utime <= last_status) return false;
    const auto& counters = listener.status()->counters;
    return std::none_of(counters.begin(), counters.end(),
                        [](const auto& counter) { return counter.name == "scans.waiting" && counter.value != 0; });
  };
  listener.listen_until(has_settled, 30s);
  fail_if_ended();
  LatencyResult result = result_of(listener);
  result.sent = sender.sent();
  result.late = sender.late();
  result.daemon_cpu = cpu_s / seconds;
  return result;
}

}  // namespace planemap::benchmark
