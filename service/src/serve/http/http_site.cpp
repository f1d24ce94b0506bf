#include "serve/http/http_site.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <charconv>
#include <sstream>
#include <utility>

#include "common/clock.hpp"
#include "config/map_gravity.hpp"
#include "export/formats.hpp"
#include "export/status_json.hpp"
#include "serve/http/assets.hpp"
#include "serve/http/cells_blob.hpp"
#include "service.hpp"

namespace planemap::service {
namespace {

constexpr const char* kJson = "application/json";
constexpr const char* kBinary = "application/octet-stream";
constexpr double kUnusedS = 30.0;
constexpr double kScanWantedS = 10.0;  // pages that ask for scans do it more often

/// A whole number without a sign.
std::optional<std::uint64_t> number_in(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

HttpAnswer answer_of_report(const HealthReport& report) {
  HttpAnswer answer = answer_of("text/plain; charset=utf-8", (report.is_good ? "ok" : report.reason) + "\n");
  answer.status = report.is_good ? 200 : 503;
  return answer;
}

struct Export {
  const char* name;
  const char* content_type;
  void (*write)(const ExportMap&, std::ostream&);
};

constexpr std::array kExports = {
    Export{"planes.json", kJson, write_planes_json}, Export{"planes.ply", kBinary, write_planes_ply},
    Export{"planes.obj", "model/obj", write_planes_obj}, Export{"planes.svg", "image/svg+xml", write_floor_plan_svg}};

/// What is behind a prefix; empty where the text does not begin so.
std::string_view behind(std::string_view text, std::string_view prefix) {
  return text.starts_with(prefix) ? text.substr(prefix.size()) : std::string_view();
}

}  // namespace

HttpSite::HttpSite(const ServiceConfig& config, Service& service)
    : service_(service),
      map_config_(config.map),
      live_(config.mapper.sensor),
      feed_(config, service.mapping(), service.plane_book()),
      board_(service.status_board()) {
  service_.mapping().set_scan_listener([this](const MappedScan& mapped) {
    live_.on_mapped(mapped);
    metrics_.on_mapped(mapped);
  });
}

HttpSite::~HttpSite() {
  service_.mapping().set_scan_listener({});
}

std::optional<HttpAnswer> HttpSite::quick_answer(const HttpRequest& request) const {
  if (request.path == "/healthz") return answer_of_report(service_.health().liveness(steady_now_s()));
  if (request.path == "/readyz") return answer_of_report(service_.health().readiness(steady_now_s()));
  return std::nullopt;
}

HttpAnswer HttpSite::answer(const HttpRequest& request) {
  const std::string_view path = request.path;
  if (path == "/api/v1/planes") return planes(request);
  if (const auto id = behind(path, "/api/v1/plane/"); !id.empty()) return plane(id);
  if (path == "/api/v1/cells") return compressed(cells(request), request);
  if (path == "/api/v1/scan") return scan();
  if (path == "/api/v1/path") return compressed(answer_of(kJson, live_.path_json()), request);
  if (path == "/api/v1/status") return answer_of(kJson, status_json(status()) + "\n");
  if (path == "/metrics") return compressed(metrics(), request);
  if (path == "/api/v1/licenses") return license_answer(request);
  if (const auto name = behind(path, "/api/v1/export/"); !name.empty()) return compressed(export_of(name), request);
  if (auto asset = asset_answer(request)) return std::move(*asset);
  return error_answer(404, "there is nothing at " + request.path);
}

HttpAnswer HttpSite::planes(const HttpRequest& request) {
  const auto sheet = feed_.current();
  HttpAnswer answer;
  answer.content_type = kJson;
  answer.etag = sheet->etag();
  {
    const std::lock_guard lock(document_mutex_);
    if (document_etag_ != answer.etag) {
      document_ = std::make_shared<const std::string>(sheet->planes_document());
      document_etag_ = answer.etag;
    }
    answer.body = document_;
  }
  answer = unless_known(std::move(answer), request);
  return compressed(std::move(answer), request);
}

HttpAnswer HttpSite::plane(std::string_view id_text) {
  const auto id = number_in(id_text);
  if (!id || *id == kNoPlane) {
    return error_answer(400, fmt::format("'{}' is no plane's id: a whole number from 1 on", id_text));
  }
  const auto sheet = feed_.current();
  if (const std::string* json = sheet->plane_json(*id)) return answer_of(kJson, *json + "\n");
  const auto lookup = sheet->queries().plane(*id);
  if (lookup && lookup->fate == PlaneFate::kMerged && lookup->lineage.size() > 1) {
    const PlaneId into = lookup->lineage.back();
    HttpAnswer answer = answer_of(
        kJson, fmt::format("{{\"error\":\"plane {} was merged into plane {}\",\"mergedInto\":{}}}\n", *id, into, into));
    answer.status = 404;
    return answer;
  }
  const bool is_gone = lookup && lookup->fate == PlaneFate::kGone;
  return error_answer(
      404, is_gone ? fmt::format("plane {} is no more", *id) : fmt::format("there is no plane {} in the map", *id));
}

HttpAnswer HttpSite::cells(const HttpRequest& request) {
  std::optional<std::uint64_t> since;
  const std::string since_text = request.parameter("since");
  if (!since_text.empty()) {
    since = number_in(since_text);
    if (!since) return error_answer(400, "since must be a revision, a whole number, or left out");
  }
  const auto sheet = feed_.current();
  // A reader of another epoch's cells may ask for a revision that this one has, too.
  const std::string epoch_text = request.parameter("epoch");
  if (!epoch_text.empty() && number_in(epoch_text) != sheet->snapshot().epoch()) since.reset();
  return answer_of(kBinary, cells_blob(*sheet, since));
}

HttpAnswer HttpSite::scan() {
  live_.want_scans(kScanWantedS);
  HttpAnswer answer;
  answer.content_type = kBinary;
  answer.body = live_.scan_blob();
  if (!answer.body) answer.status = 204;
  return answer;
}

HttpAnswer HttpSite::export_of(std::string_view name) {
  for (const Export& format : kExports) {
    if (name != format.name) continue;
    const auto sheet = feed_.current();
    std::ostringstream out;
    format.write(export_map_of(sheet->queries(), map_config_.frame, gravity_of(map_config_)), out);
    HttpAnswer answer = answer_of(format.content_type, std::move(out).str());
    answer.more_headers.emplace_back("Content-Disposition", fmt::format("attachment; filename=\"{}\"", name));
    return answer;
  }
  return error_answer(404, fmt::format("'{}' cannot be exported: there are planes.json, planes.ply, planes.obj and "
                                       "planes.svg",
                                       name));
}

planemap_lcm::status_t HttpSite::status() {
  const std::lock_guard lock(board_mutex_);
  return board_.status(steady_now_s(), utime_now());
}

HttpAnswer HttpSite::metrics() {
  const double now_s = steady_now_s();
  const ClientCounts clients = client_counts_ ? client_counts_() : ClientCounts{};
  const MetricSources sources{status(),
                              service_.mapping().stats(now_s),
                              service_.snapshot(),
                              service_.health().liveness(now_s).is_good,
                              service_.health().readiness(now_s).is_good,
                              clients.connections,
                              clients.event_streams};
  return answer_of("text/plain; version=0.0.4; charset=utf-8", metrics_.text(sources));
}

EventNews HttpSite::news(bool with_status) {
  live_.want_scans(kScanWantedS);  // who watches may want to see the scan, and is not to wait for the next but one
  EventNews news;
  news.sheet = feed_.current();
  if (const auto pose = live_.last_pose()) {
    const Eigen::Vector3d& p = pose->T_world_sensor.translation();
    const Eigen::Quaterniond q(pose->T_world_sensor.linear());
    news.pose = std::make_shared<const std::string>(
        event_text("pose", fmt::format(R"({{"utime":{},"position":[{},{},{}],"orientation":[{},{},{},{}]}})",
                                       pose->utime, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z())));
    news.pose_utime = pose->utime;
  }
  if (with_status) news.status = std::make_shared<const std::string>(event_text("status", status_json(status())));
  return news;
}

void HttpSite::tidy_up() {
  feed_.forget_after(kUnusedS);
}

}  // namespace planemap::service
