#include "serve/grpc/call_guard.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "config/listen_address.hpp"

namespace planemap::service {
namespace {

constexpr std::size_t kLeastTokenChars = 16;
constexpr std::string_view kBearer = "Bearer ";

/// Takes the same time wherever the two differ.
bool are_equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

const char* name_of(Scope scope) {
  return scope == Scope::kAdmin ? "admin" : "read";
}

}  // namespace

bool is_loopback_peer(const std::string& peer) {
  const auto begin = peer.find(':');
  const auto end = peer.rfind(':');
  if (begin == std::string::npos || end <= begin) return false;
  std::string host = peer.substr(begin + 1, end - begin - 1);
  // gRPC writes the brackets of IPv6 numbers as in a URL.
  for (const char* bracket : {"%5B", "%5D", "[", "]"}) {
    if (const auto at = host.find(bracket); at != std::string::npos) host.erase(at, std::strlen(bracket));
  }
  return is_loopback_number(host);
}

Expected<CallGuard> CallGuard::from_file(const std::string& name) {
  std::ifstream file(name);
  if (!file) return fail(fmt::format("grpc.token_file: {}: cannot be read: {}", name, std::strerror(errno)));
  CallGuard guard;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words(line);
    std::string scope;
    std::string token;
    std::string more;
    words >> scope >> token >> more;
    if (scope.empty() || scope.front() == '#') continue;
    const auto wrong = [&](const std::string& what) {
      return fail(fmt::format("grpc.token_file: {}:{}: {}", name, number, what));
    };
    if (scope != "read" && scope != "admin") return wrong("a line must begin with a scope: read or admin");
    if (token.empty() || !more.empty()) return wrong("a line must have a scope and one token");
    const bool is_plain = std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (token.size() < kLeastTokenChars || !is_plain) {
      return wrong(fmt::format("a token must have {} printable ASCII characters or more", kLeastTokenChars));
    }
    if (!guard.scopes_.emplace(token, scope == "admin" ? Scope::kAdmin : Scope::kRead).second) {
      return wrong("this token stands in an earlier line, too");
    }
  }
  if (guard.scopes_.empty()) return fail(fmt::format("grpc.token_file: {}: has no token", name));
  return guard;
}

Scope CallGuard::scope_of(std::string_view token) const {
  Scope scope = Scope::kNone;
  for (const auto& [known, known_scope] : scopes_) {
    if (are_equal(known, token)) scope = known_scope;
  }
  return scope;
}

Verdict CallGuard::check(Scope needed, std::string_view authorization, const std::string& peer) const {
  if (scopes_.empty()) {
    if (needed < Scope::kAdmin || is_loopback_peer(peer)) return {};
    return {
        Denial::kPermissionDenied,
        "this call needs a token of scope admin, and the server has none (grpc.token_file); without tokens it is for "
        "callers on the server's loopback"};
  }
  if (authorization.empty()) {
    return {Denial::kUnauthenticated,
            fmt::format("this call needs a token of scope {}: send 'authorization: Bearer TOKEN'", name_of(needed))};
  }
  const bool is_bearer = authorization.substr(0, kBearer.size()) == kBearer;
  const Scope scope = is_bearer ? scope_of(authorization.substr(kBearer.size())) : Scope::kNone;
  if (scope == Scope::kNone) return {Denial::kUnauthenticated, "the token is not known"};
  if (scope < needed) {
    return {Denial::kPermissionDenied,
            fmt::format("the token is of scope {}, this call needs {}", name_of(scope), name_of(needed))};
  }
  return {};
}

}  // namespace planemap::service
