#pragma once

#include <map>
#include <planemap/expected.hpp>
#include <string>
#include <string_view>

namespace planemap::service {

/// What a caller may do; the greater includes the less.
enum class Scope { kNone, kRead, kAdmin };

/// Why a call is not let in.
enum class Denial { kNone, kUnauthenticated, kPermissionDenied };

struct Verdict {
  Denial denial = Denial::kNone;
  std::string message;  ///< for the caller; names no token
};

/// Who may call what. With tokens, each call needs one of its scope, wherever it comes from; without, anybody who can
/// reach the server may read, and callers on loopback may do the rest. Immutable.
class CallGuard {
 public:
  CallGuard() = default;  ///< without tokens
  /// Reads a file of tokens: lines of a scope (read or admin) and a token of at least 16 printable characters; empty
  /// lines and such that begin with # are passed over. Errors name the line and never the token.
  static Expected<CallGuard> from_file(const std::string& name);

  /// @param authorization  the call's metadata of that name ("Bearer ..."); empty: it has none
  /// @param peer           as gRPC names it, for instance "ipv4:127.0.0.1:4711"
  Verdict check(Scope needed, std::string_view authorization, const std::string& peer) const;

 private:
  Scope scope_of(std::string_view token) const;

  std::map<std::string, Scope> scopes_;  ///< by token; empty: none is asked for
};

/// Whether the peer is on this machine's loopback.
bool is_loopback_peer(const std::string& peer);

}  // namespace planemap::service
