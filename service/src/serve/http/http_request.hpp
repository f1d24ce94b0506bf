#pragma once

#include <boost/beast/http/fields.hpp>
#include <boost/beast/http/message.hpp>
#include <planemap/expected.hpp>

#include "serve/http/http_message.hpp"

namespace planemap::service {

using HttpHeader = boost::beast::http::request_header<>;

/// What comes in is bounded: the whole of a request's line and headers, and its target alone.
constexpr std::size_t kMaxHeadBytes = 8192;
constexpr std::size_t kMaxTargetBytes = 2048;

/// Why a request is not even looked at: the answer; or the request.
/// @param is_loopback  the server is for this machine alone: then the Host must name this machine, since a page from
///                     elsewhere could have its own name lead here (DNS rebinding)
tl::expected<HttpRequest, HttpAnswer> checked_request(const HttpHeader& header, bool is_loopback);

/// Only GET and HEAD.
HttpAnswer method_refused(const HttpHeader& header);

}  // namespace planemap::service
