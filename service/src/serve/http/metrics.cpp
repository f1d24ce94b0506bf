#include "serve/http/metrics.hpp"

#include <malloc.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <planemap/block.hpp>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "common/version.hpp"

namespace planemap::service {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

/// Seconds: a stage takes from 10 us to some tens of milliseconds, a scan that the robot waits for up to a second.
const prometheus::Histogram::BucketBoundaries kBuckets = {0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01,
                                                          0.025,  0.05,    0.1,    0.25,  0.5,    1.0,   2.5};

/// The families that are made anew for each answer.
class Families {
 public:
  Families& family(MetricType type, const char* name, const char* help) {
    families_.push_back({name, help, type, {}});
    return *this;
  }
  Families& gauge(const char* name, const char* help) { return family(MetricType::Gauge, name, help); }
  Families& counter(const char* name, const char* help) { return family(MetricType::Counter, name, help); }
  /// One more value of the family that was begun last.
  Families& value(double value, Labels labels = {}) {
    ClientMetric metric;
    metric.label = std::move(labels);
    metric.gauge.value = value;
    metric.counter.value = value;
    families_.back().metric.push_back(std::move(metric));
    return *this;
  }
  std::vector<MetricFamily> take() { return std::move(families_); }

 private:
  std::vector<MetricFamily> families_;
};

using Counts = std::vector<std::pair<std::string, double>>;

/// What is behind a prefix.
Counts below(const planemap_lcm::status_t& status, std::string_view prefix) {
  Counts counts;
  for (const auto& counter : status.counters) {
    if (!counter.name.starts_with(prefix)) continue;
    counts.emplace_back(counter.name.substr(prefix.size()), static_cast<double>(counter.value));
  }
  return counts;
}

double count_of(const planemap_lcm::status_t& status, std::string_view name) {
  for (const auto& counter : status.counters) {
    if (counter.name == name) return static_cast<double>(counter.value);
  }
  return 0.0;
}

/// Counters that have a metric of their own.
bool is_told_elsewhere(const std::string& name) {
  for (const char* prefix : {"scans.", "points.", "http.requests.", "lcm.kernel_drops", "grpc.connections.open"}) {
    if (name.starts_with(prefix)) return true;
  }
  return false;
}

/// Of the blocks and cells of a snapshot.
double bytes_of(const MapSnapshot& snapshot) {
  constexpr std::size_t kPlaceBytes = 2;
  std::size_t bytes = 0;
  for (const auto& block : snapshot.blocks()) bytes += sizeof(Block) + block->capacity() * (sizeof(Cell) + kPlaceBytes);
  return static_cast<double>(bytes);
}

/// 0 where /proc cannot be read.
double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double size_pages = 0.0;
  double resident_pages = 0.0;
  file >> size_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// What the program holds of the allocator's memory, without what that keeps for later.
double heap_used_bytes() {
  const struct mallinfo2 heap = mallinfo2();
  return static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd);
}

void add_scans(const MetricSources& sources, Families& families) {
  const auto& status = sources.status;
  families.counter("planemap_scans_received_total", "Scans that came in; all others of planemap_scans add up to them")
      .value(count_of(status, "scans.received"));
  families.counter("planemap_scans_total", "Scans by what became of them: mapped, dropped or rejected, and why");
  families.value(count_of(status, "scans.mapped"), {{"outcome", "mapped"}, {"reason", ""}});
  for (const char* outcome : {"dropped", "rejected"}) {
    for (const auto& [reason, count] : below(status, std::string("scans.") + outcome + ".")) {
      families.value(count, {{"outcome", outcome}, {"reason", reason}});
    }
  }
  families.gauge("planemap_scans_waiting", "Scans that wait for a pose or for the mapper")
      .value(count_of(status, "scans.waiting"));
  families.gauge("planemap_queue_scans", "Scans that wait for the mapper")
      .value(static_cast<double>(sources.mapping.queued));
  families.gauge("planemap_queue_capacity_scans", "Scans that may wait for the mapper (queue.scans)")
      .value(static_cast<double>(sources.mapping.queue_capacity));
  families.gauge("planemap_last_scan_timestamp_seconds", "Time of the last mapped scan by its own clock; 0: none yet")
      .value(1e-6 * static_cast<double>(sources.mapping.last_scan_utime));
  families.counter("planemap_points_total", "Points of mapped scans by what became of them");
  for (const auto& [outcome, count] : below(status, "points.")) {
    if (outcome != "total") families.value(count, {{"outcome", outcome}});
  }
}

void add_map(const MetricSources& sources, Families& families) {
  const MapSnapshot& snapshot = *sources.snapshot;
  const auto gauge = [&](const char* name, const char* help, auto value) {
    families.gauge(name, help).value(static_cast<double>(value));
  };
  gauge("planemap_map_planes", "Planes of the map", snapshot.planes().size());
  gauge("planemap_map_cells", "Stored cells", snapshot.cell_count());
  gauge("planemap_map_blocks", "Stored blocks of 8x8x8 cells", snapshot.block_count());
  gauge("planemap_map_bytes", "Memory of the map's blocks and cells, counted", bytes_of(snapshot));
  gauge("planemap_map_revision", "Grows by one with each change of the planes", snapshot.revision());
  gauge("planemap_map_epoch", "Names this life of the map", snapshot.epoch());
}

void add_service(const MetricSources& sources, double started_at_s, Families& families) {
  const auto& status = sources.status;
  families.gauge("planemap_live", "1: the mapper makes progress").value(sources.is_live);
  families.gauge("planemap_ready", "1: questions are taken").value(sources.is_ready);
  families.gauge("planemap_paused", "1: scans are dropped on demand").value(sources.mapping.is_paused);
  families.gauge("planemap_clients", "Connections by protocol; http_events are those of http that are told of changes");
  families.value(count_of(status, "grpc.connections.open"), {{"protocol", "grpc"}});
  families.value(static_cast<double>(sources.http_connections), {{"protocol", "http"}});
  families.value(static_cast<double>(sources.event_streams), {{"protocol", "http_events"}});
  families.counter("planemap_http_requests_total", "Answers over HTTP by status");
  for (const auto& [code, count] : below(status, "http.requests.")) families.value(count, {{"code", code}});
  families.counter("planemap_lcm_kernel_drops_total", "Datagrams that the kernel dropped: the receive buffer was full")
      .value(count_of(status, "lcm.kernel_drops"));
  families.counter("planemap_events_total", "All other counters of planemap status, by name");
  for (const auto& counter : status.counters) {
    if (is_told_elsewhere(counter.name)) continue;
    families.value(static_cast<double>(counter.value), {{"event", counter.name}});
  }
  families.gauge("planemap_uptime_seconds", "Since the start of the server").value(steady_now_s() - started_at_s);
  families.gauge("planemap_build_info", "1; the version is its label").value(1.0, {{"version", version()}});
  families
      .gauge("planemap_heap_used_bytes", "Memory that the program holds, without what the allocator keeps for later")
      .value(heap_used_bytes());
  families.gauge("process_resident_memory_bytes", "Memory of the process").value(resident_bytes());
}

}  // namespace

class Metrics::Impl {
 public:
  Impl() {
    auto& family = prometheus::BuildHistogram()
                       .Name("planemap_stage_seconds")
                       .Help("Time of each stage of a scan")
                       .Register(registry_);
    for (std::size_t i = 0; i < kStageCount; ++i) {
      stages_[i] = &family.Add({{"stage", name_of(static_cast<Stage>(i))}}, kBuckets);
    }
  }
  void on_mapped(const MappedScan& mapped) {
    for (std::size_t i = 0; i < kStageCount; ++i) stages_[i]->Observe(1e-3 * mapped.stage_ms[i]);
    scan_.Observe(1e-3 * mapped.scan_ms);
  }
  std::string text(const MetricSources& sources) const {
    Families families;
    add_scans(sources, families);
    add_map(sources, families);
    add_service(sources, started_at_s_, families);
    auto all = families.take();
    for (auto& family : registry_.Collect()) all.push_back(std::move(family));
    std::ostringstream out;
    prometheus::TextSerializer().Serialize(out, all);
    return std::move(out).str();
  }

 private:
  prometheus::Registry registry_;
  std::array<prometheus::Histogram*, kStageCount> stages_{};
  prometheus::Histogram& scan_ = prometheus::BuildHistogram()
                                     .Name("planemap_scan_seconds")
                                     .Help("Time for a scan, from the queue to its snapshot")
                                     .Register(registry_)
                                     .Add({}, kBuckets);
  double started_at_s_ = steady_now_s();
};

Metrics::Metrics() : impl_(std::make_unique<Impl>()) {}

Metrics::~Metrics() = default;

void Metrics::on_mapped(const MappedScan& mapped) {
  impl_->on_mapped(mapped);
}

std::string Metrics::text(const MetricSources& sources) const {
  return impl_->text(sources);
}

}  // namespace planemap::service
