#include "serve/http/http_site.hpp"

namespace planemap::service {
namespace {

HttpAnswer answer_of_report(const HealthReport& report) {
  HttpAnswer answer = answer_of("text/plain; charset=utf-8", (report.is_good ? "ok" : report.reason) + "\n");
  answer.status = report.is_good ? 200 : 503;
  return answer;
}

}  // namespace

std::optional<HttpAnswer> HttpSite::quick_answer(const HttpRequest& request) const {
  if (request.path == "/healthz") return answer_of_report(health_.liveness(steady_now_s()));
  if (request.path == "/readyz") return answer_of_report(health_.readiness(steady_now_s()));
  return std::nullopt;
}

HttpAnswer HttpSite::answer(const HttpRequest& request) {
  return error_answer(404, "there is nothing at " + request.path);
}

}  // namespace planemap::service
