#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace planemap::service {

/// What a client asks, as far as it matters here: GET or HEAD, without a body.
struct HttpRequest {
  std::string path;   ///< decoded; begins with /
  std::string query;  ///< behind the ?, as it came
  std::string if_none_match;
  bool accepts_gzip = false;

  /// A parameter of the query; empty where it is missing.
  std::string parameter(const std::string& name) const;
};

/// What it gets.
struct HttpAnswer {
  unsigned status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body;  ///< nullptr: none
  std::string etag;                         ///< in quotes; empty: none
  bool is_gzip = false;                     ///< the body is compressed
  bool may_be_kept = false;                 ///< by caches, for ever; else they ask each time
  std::vector<std::pair<std::string, std::string>> more_headers;
};

/// An answer of a body.
HttpAnswer answer_of(std::string content_type, std::string body);
/// {"error": sentence}.
HttpAnswer error_answer(unsigned status, const std::string& sentence);
/// The same answer, or 304 without a body where the client has it already.
HttpAnswer unless_known(HttpAnswer answer, const HttpRequest& request);
/// The same answer, compressed where the client takes that and it pays.
HttpAnswer compressed(HttpAnswer answer, const HttpRequest& request);

/// The status line and all headers. @param keeps_alive  the connection goes on
std::string head_of(const HttpAnswer& answer, bool keeps_alive);
/// Headers that every answer has, for those that are not written by head_of().
std::string common_headers();

}  // namespace planemap::service
