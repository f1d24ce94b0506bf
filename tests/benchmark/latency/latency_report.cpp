#include "latency/latency_report.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/machine.hpp"
#include "common/quantile.hpp"

namespace planemap::benchmark {

namespace {

constexpr double kBoundMs = 33.0;
constexpr double kAimMs = 15.0;

std::vector<double> times(const LatencyResult& result, double ScanLatency::*member) {
  std::vector<double> all;
  all.reserve(result.scans.size());
  for (const ScanLatency& scan : result.scans) all.push_back(scan.*member);
  return all;
}

struct Quantiles {
  double median_ms, p95_ms, p99_ms, max_ms;
};

Quantiles quantiles(const std::vector<double>& ms) {
  return {median(ms), quantile(ms, 0.95), quantile(ms, 0.99), quantile(ms, 1.0)};
}

nlohmann::ordered_json json_of(const Quantiles& q) {
  return {{"median", q.median_ms}, {"p95", q.p95_ms}, {"p99", q.p99_ms}, {"max", q.max_ms}};
}

std::string row_of(const char* words, const Quantiles& q) {
  return fmt::format("{:<42} {:7.2f} {:7.2f} {:7.2f} {:7.2f}\n", words, q.median_ms, q.p95_ms, q.p99_ms, q.max_ms);
}

std::size_t count_together(const LatencyResult& result) {
  return static_cast<std::size_t>(
      std::count_if(result.scans.begin(), result.scans.end(), [](const ScanLatency& scan) { return !scan.alone; }));
}

}  // namespace

std::vector<LatencyBound> latency_bounds(const LatencyResult& result) {
  const auto lost = static_cast<double>(result.sent) - static_cast<double>(result.counter("scans.mapped"));
  const double unanswered = static_cast<double>(result.sent) - static_cast<double>(result.scans.size());
  return {{"p99Ms", "scan and pose to delta, p99, ms", quantile(times(result, &ScanLatency::delta_ms), 0.99), kBoundMs,
           kAimMs},
          {"notMapped", "scans that were sent and not mapped", lost, 0.0, 0.0},
          {"notMeasured", "scans that no delta was heard for", unanswered, 0.0, 0.0}};
}

std::string latency_table(const LatencyConfig& config, const LatencyResult& result) {
  std::string text = fmt::format(
      "{:.0f} scans/s, {}, {:.0f} poses/s; the daemon took {:.0f} % of its core, and {:.1f} ms for a scan "
      "(median of its last 100; the longest {:.1f}); {} planes\n\n",
      config.rate_hz, config.compressed ? "zlib" : "raw", config.pose_rate_hz, 100.0 * result.daemon_cpu,
      result.scan_ms_p50, result.scan_ms_max, result.planes);
  text += "                                            median     p95     p99     max   ms\n";
  text += row_of("later of scan and pose to the delta", quantiles(times(result, &ScanLatency::delta_ms)));
  text += row_of("the scan's wait for its pose (not counted)", quantiles(times(result, &ScanLatency::wait_ms)));
  text += fmt::format(
      "\nscans: {} sent ({} late), {} heard here, {} received, {} mapped, {} dropped, {} rejected\n"
      "deltas: {}; {} scans are in one with a later scan\n\n",
      result.sent, result.late, result.heard, result.counter("scans.received"), result.counter("scans.mapped"),
      result.counters_beginning("scans.dropped."), result.counters_beginning("scans.rejected."), result.deltas,
      count_together(result));
  for (const LatencyBound& bound : latency_bounds(result)) {
    text += fmt::format("{:<42} {:7.2f}  <= {:.0f}, aim {:.0f}  {}\n", bound.words, bound.value, bound.most, bound.aim,
                        bound.held() ? "held" : "missed");
  }
  return text;
}

std::string latency_json(const LatencyConfig& config, const LatencyResult& result) {
  nlohmann::ordered_json report;
  report["latencyMs"] = json_of(quantiles(times(result, &ScanLatency::delta_ms)));
  report["poseWaitMs"] = json_of(quantiles(times(result, &ScanLatency::wait_ms)));
  report["scans"] = {{"sent", result.sent},
                     {"late", result.late},
                     {"heard", result.heard},
                     {"received", result.counter("scans.received")},
                     {"mapped", result.counter("scans.mapped")},
                     {"dropped", result.counters_beginning("scans.dropped.")},
                     {"rejected", result.counters_beginning("scans.rejected.")},
                     {"measured", result.scans.size()},
                     {"together", count_together(result)}};
  report["deltas"] = result.deltas;
  report["planes"] = result.planes;
  report["daemon"] = {
      {"core", result.daemon_cpu}, {"scanMsP50", result.scan_ms_p50}, {"scanMsMax", result.scan_ms_max}};
  for (const LatencyBound& bound : latency_bounds(result)) {
    report["bounds"][bound.name] = {
        {"value", bound.value}, {"most", bound.most}, {"aim", bound.aim}, {"held", bound.held()}};
  }
  report["rateHz"] = config.rate_hz;
  report["poseRateHz"] = config.pose_rate_hz;
  report["encoding"] = config.compressed ? "zlib" : "raw";
  report["machine"] = json_of(this_machine());
  return report.dump(2);
}

}  // namespace planemap::benchmark
