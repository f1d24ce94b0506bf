#include "serve/http/http_message.hpp"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "serve/http/gzip.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kLeastCompressedBytes = 1024;
constexpr int kFast = 1;  // of zlib's levels: half of the best one's saving for a tenth of its time

const char* reason_of(unsigned status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 413:
      return "Content Too Large";
    case 414:
      return "URI Too Long";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Internal Server Error";
  }
}

}  // namespace

std::string HttpRequest::parameter(const std::string& name) const {
  std::string_view rest = query;
  while (!rest.empty()) {
    const auto end = rest.find('&');
    const std::string_view pair = rest.substr(0, end);
    const auto equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name) return std::string(pair.substr(equals + 1));
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  return {};
}

HttpAnswer answer_of(std::string content_type, std::string body) {
  HttpAnswer answer;
  answer.content_type = std::move(content_type);
  answer.body = std::make_shared<const std::string>(std::move(body));
  return answer;
}

HttpAnswer error_answer(unsigned status, const std::string& sentence) {
  // What a client sent may be in the sentence, and need not be UTF-8.
  const nlohmann::json json = {{"error", sentence}};
  HttpAnswer answer =
      answer_of("application/json", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  answer.status = status;
  return answer;
}

HttpAnswer unless_known(HttpAnswer answer, const HttpRequest& request) {
  const bool is_known = answer.status == 200 && !answer.etag.empty() &&
                        (request.if_none_match == "*" || request.if_none_match.find(answer.etag) != std::string::npos);
  if (!is_known) return answer;
  answer.status = 304;
  answer.body = nullptr;
  answer.is_gzip = false;
  return answer;
}

HttpAnswer compressed(HttpAnswer answer, const HttpRequest& request) {
  if (!request.accepts_gzip || answer.is_gzip || !answer.body || answer.body->size() < kLeastCompressedBytes) {
    return answer;
  }
  std::string packed = gzip(*answer.body, kFast);
  if (packed.empty() || packed.size() >= answer.body->size()) return answer;
  answer.body = std::make_shared<const std::string>(std::move(packed));
  answer.is_gzip = true;
  return answer;
}

std::string common_headers() {
  return "Server: planemapd\r\n"
         "Content-Security-Policy: default-src 'self'\r\n"
         "X-Content-Type-Options: nosniff\r\n"
         "Cross-Origin-Resource-Policy: same-origin\r\n"
         "Referrer-Policy: no-referrer\r\n";
}

std::string head_of(const HttpAnswer& answer, bool keeps_alive) {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\n{}Connection: {}\r\n", answer.status, reason_of(answer.status),
                                 common_headers(), keeps_alive ? "keep-alive" : "close");
  head += answer.may_be_kept ? "Cache-Control: public, max-age=31536000, immutable\r\n" : "Cache-Control: no-cache\r\n";
  head += "Vary: Accept-Encoding\r\n";
  if (!answer.etag.empty()) head += fmt::format("ETag: {}\r\n", answer.etag);
  for (const auto& [name, value] : answer.more_headers) head += fmt::format("{}: {}\r\n", name, value);
  const bool has_no_body_ever = answer.status == 204 || answer.status == 304;
  if (!has_no_body_ever) {
    head += fmt::format("Content-Type: {}\r\nContent-Length: {}\r\n", answer.content_type,
                        answer.body ? answer.body->size() : 0);
    if (answer.is_gzip) head += "Content-Encoding: gzip\r\n";
  }
  return head + "\r\n";
}

}  // namespace planemap::service
