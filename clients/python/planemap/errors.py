"""What can go wrong. Each message is a sentence that says what to do."""

from __future__ import annotations

import grpc


class PlanemapError(Exception):
    """A question got no answer that can be used."""


class Unreachable(PlanemapError):
    """Nobody answered: no planemapd listens there, or it did not answer in time."""


class Refused(PlanemapError):
    """The service answered with an error: an argument is wrong, or the map lacks what was asked for."""


class Denied(PlanemapError):
    """Who asks may not: a token is missing, unknown, or of too small a scope."""


class AnswerIncomplete(PlanemapError):
    """Only a part of the answer came, or the map changed faster than it could be asked for."""


class MalformedAnswer(PlanemapError):
    """The answer contradicts itself; does something else than a planemapd listen there?"""


class Gone(PlanemapError):
    """The service does not keep the map of the answers before any more; the client's calls start over then."""


_REFUSALS = (
    grpc.StatusCode.INVALID_ARGUMENT,
    grpc.StatusCode.FAILED_PRECONDITION,
    grpc.StatusCode.NOT_FOUND,
    grpc.StatusCode.RESOURCE_EXHAUSTED,
    grpc.StatusCode.UNIMPLEMENTED,
)


def error_of(error: grpc.RpcError, server: str, has_tls: bool, timeout_s: float) -> PlanemapError:
    """The exception for a call that failed."""
    code, said = error.code(), error.details()
    if code == grpc.StatusCode.UNAVAILABLE:
        hint = ""
        if not has_tls and "onnection refused" not in said:
            hint = "; if it speaks TLS, name the authority that signed its certificate (ca_file=...)"
        return Unreachable(
            f"no planemapd can be reached at {server}{' over TLS' if has_tls else ''} ({said}){hint}; "
            "is planemapd running, with grpc.listen there?"
        )
    if code == grpc.StatusCode.CANCELLED:  # by the service: a gRPC server that ends does so with what is left
        return Unreachable(f"the service at {server} ended the call ({said})")
    if code == grpc.StatusCode.DEADLINE_EXCEEDED:
        return Unreachable(f"no answer came from {server} within {timeout_s:g} s; a larger timeout_s waits longer")
    if code in (grpc.StatusCode.UNAUTHENTICATED, grpc.StatusCode.PERMISSION_DENIED):
        return Denied(f"the service refused the request: {said} (connect(..., token=...))")
    if code == grpc.StatusCode.ABORTED:
        return Gone(f"the service began anew: {said}")
    if code in _REFUSALS:
        return Refused(f"the service refused the request: {said}")
    return MalformedAnswer(f"the call to {server} failed: {said} ({code}); is a planemapd listening there?")
