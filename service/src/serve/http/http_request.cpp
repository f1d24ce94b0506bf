#include "serve/http/http_request.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/verb.hpp>
#include <cctype>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include "config/listen_address.hpp"

namespace planemap::service {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// %41 becomes A. Empty where a % is not followed by two digits, or a control character comes out.
std::optional<std::string> decoded(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      unsigned value = 0;
      const char* digits = text.data() + i + 1;
      if (i + 2 >= text.size()) return std::nullopt;
      if (std::from_chars(digits, digits + 2, value, 16).ptr != digits + 2) return std::nullopt;
      c = static_cast<char>(value);
      i += 2;
    }
    if (static_cast<unsigned char>(c) < 0x20) return std::nullopt;
    out += c;
  }
  return out;
}

/// The name in a Host header, without port and brackets, in small letters.
std::string host_name_of(std::string_view host) {
  if (!host.empty() && host.front() == '[') {
    host = host.substr(1, host.find(']') - 1);
  } else {
    host = host.substr(0, host.find(':'));
  }
  std::string name(host);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

bool names_this_machine(std::string_view host) {
  const std::string name = host_name_of(host);
  return name == "localhost" || is_loopback_number(name);
}

bool accepts_gzip(const HttpHeader& header) {
  const http::ext_list codings{header[http::field::accept_encoding]};
  return std::any_of(codings.begin(), codings.end(), [](const auto& coding) {
    if (!beast::iequals(coding.first, "gzip")) return false;
    // "gzip;q=0" says no.
    return std::none_of(coding.second.begin(), coding.second.end(), [](const auto& parameter) {
      return beast::iequals(parameter.first, "q") && parameter.second.find_first_not_of("0.") == std::string::npos;
    });
  });
}

/// A path for a sentence: short.
std::string shortened(std::string_view text) {
  constexpr std::size_t kMost = 60;
  return fmt::format("{}{}", text.substr(0, kMost), text.size() > kMost ? "..." : "");
}

}  // namespace

HttpAnswer method_refused(const HttpHeader& header) {
  HttpAnswer answer = error_answer(
      405, fmt::format("{} is not taken here: the interface is read only, by GET and HEAD; change the map over gRPC",
                       shortened(view_of(header.method_string()))));
  answer.more_headers.emplace_back("Allow", "GET, HEAD");
  return answer;
}

tl::expected<HttpRequest, HttpAnswer> checked_request(const HttpHeader& header, bool is_loopback) {
  const auto refuse = [](unsigned status, const std::string& sentence) {
    return tl::make_unexpected(error_answer(status, sentence));
  };
  if (header.method() != http::verb::get && header.method() != http::verb::head) {
    return tl::make_unexpected(method_refused(header));
  }
  const std::string_view target = view_of(header.target());
  if (target.size() > kMaxTargetBytes) {
    return refuse(414, fmt::format("the URL is {} bytes long, {} are taken", target.size(), kMaxTargetBytes));
  }
  if (header.count(http::field::host) > 1) return refuse(400, "the request has more than one Host header");
  const std::string_view host = view_of(header[http::field::host]);
  if (host.empty() && header.version() >= 11) return refuse(400, "the request has no Host header");
  if (is_loopback && !host.empty() && !names_this_machine(host)) {
    return refuse(400,
                  fmt::format("the Host header names {}, and this server answers to localhost, 127.0.0.1 and [::1] "
                              "only: a page from elsewhere must not read the map by way of a name that leads here",
                              shortened(host)));
  }
  if (target.empty() || target.front() != '/')
    return refuse(400, "the request's target must be a path that begins with /");
  const auto question = target.find('?');
  const auto path = decoded(target.substr(0, question));
  if (!path) return refuse(400, "the URL's path has a wrong % sequence or a control character");
  HttpRequest request;
  request.path = *path;
  if (question != std::string_view::npos) request.query = std::string(target.substr(question + 1));
  request.if_none_match = std::string(view_of(header[http::field::if_none_match]));
  request.accepts_gzip = accepts_gzip(header);
  return request;
}

}  // namespace planemap::service
