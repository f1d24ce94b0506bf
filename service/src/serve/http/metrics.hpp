#pragma once

#include <cstddef>
#include <memory>
#include <planemap/snapshot.hpp>
#include <planemap_lcm/status_t.hpp>
#include <string>

#include "mapping/mapping_service.hpp"

namespace planemap::service {

/// What metrics are made of, at one instant.
struct MetricSources {
  planemap_lcm::status_t status;
  MappingStats mapping;
  std::shared_ptr<const MapSnapshot> snapshot;
  bool is_live = true;
  bool is_ready = true;
  std::size_t http_connections = 0;
  std::size_t event_streams = 0;
};

/// How the service is, for Prometheus (docs/http.md has the table). Safe from any thread.
class Metrics {
 public:
  Metrics();
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// On the mapper's thread: the times of a scan and of its stages.
  void on_mapped(const MappedScan& mapped);
  /// In Prometheus' text format, version 0.0.4.
  std::string text(const MetricSources& sources) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planemap::service
