"""The way to a server: its address, TLS, token."""

from __future__ import annotations

import copy
import re
from pathlib import Path
from typing import Any, Callable, TypeVar, Union

import grpc

from .errors import PlanemapError, error_of

DEFAULT_SERVER = "127.0.0.1:7670"
PathLike = Union[str, Path]

_ADDRESS = re.compile(r"^(\[[0-9A-Fa-f:.%]+\]|[A-Za-z0-9._-]+)(?::(\d{1,5}))?$")
_LOOPBACK = re.compile(r"^(localhost|127(\.\d+){3}|\[::1\])$")
_OPTIONS = (
    ("grpc.enable_http_proxy", 0),  # a service on the robot or beside it, not behind an office's proxies
    ("grpc.use_local_subchannel_pool", 1),  # a connection of its own
    # A cable that was pulled out says nothing: without these TCP goes on trying for a quarter of an hour.
    ("grpc.keepalive_time_ms", 10000),
    ("grpc.keepalive_timeout_ms", 5000),
    ("grpc.http2.max_pings_without_data", 0),
    ("grpc.initial_reconnect_backoff_ms", 100),
    ("grpc.max_reconnect_backoff_ms", 500),
)

Result = TypeVar("Result")


def _address(server: str) -> tuple[str, str]:
    match = _ADDRESS.match(server)
    port = int(match.group(2) or 7670) if match else 0
    if not match or not 1 <= port <= 65535:
        raise ValueError(f"{server!r} is no address of a server: it must be HOST, HOST:PORT or [IPv6]:PORT")
    return match.group(1), f"{match.group(1)}:{port}"


def _text(name: str, file: PathLike | None) -> bytes | None:
    if file is None:
        return None
    text = Path(file).read_bytes()  # the error names the file
    if b"-----BEGIN " not in text:
        raise ValueError(f"{name}: {file}: is not in PEM")
    return text


class Channel:
    """A connection that is made when it is first used, and again when it was cut off."""

    def __init__(
        self,
        server: str,
        token: str | None,
        tls: bool,
        ca_file: PathLike | None,
        certificate_file: PathLike | None,
        key_file: PathLike | None,
        server_name: str | None,
    ) -> None:
        host, self.server = _address(server)
        if (certificate_file is None) != (key_file is None):
            raise ValueError("certificate_file, key_file: each needs the other")
        self.has_tls = tls or ca_file is not None or certificate_file is not None
        if token is not None and not re.fullmatch(r"[!-~]+", token):
            raise ValueError("token: must be of printable ASCII characters, without blanks")
        if token is not None and not self.has_tls and not _LOOPBACK.match(host):
            raise ValueError(
                f"token: would go to {self.server} for everybody to read; it is sent over TLS (ca_file=...) "
                "or to the loopback only"
            )
        self.metadata = [("authorization", f"Bearer {token}")] if token is not None else []
        self._options: list[tuple[str, Any]] = list(_OPTIONS)
        self._credentials: grpc.ChannelCredentials | None = None
        if self.has_tls:
            self._credentials = grpc.ssl_channel_credentials(
                _text("ca_file", ca_file), _text("key_file", key_file), _text("certificate_file", certificate_file)
            )
            if server_name is not None:
                self._options.append(("grpc.ssl_target_name_override", server_name))
        self.is_closed = False
        self.channel = self._open()

    def again(self) -> Channel:
        """The same way to the same server, over a new connection. One that was cut off connects again by itself, but not
        before it has waited, and only while a call is polled: a watch took up to eight seconds."""
        other = copy.copy(self)
        other.channel = other._open()
        return other

    def _open(self) -> grpc.Channel:
        if self._credentials is None:
            return grpc.insecure_channel(self.server, self._options)
        return grpc.secure_channel(self.server, self._credentials, self._options)

    def close(self) -> None:
        self.is_closed = True
        self.channel.close()

    def error_of(self, error: grpc.RpcError, timeout_s: float) -> PlanemapError:
        return error_of(error, self.server, self.has_tls, timeout_s)

    def call(self, method: Callable[..., Result], request: Any, timeout_s: float) -> Result:
        """Makes a call that brings one message."""
        try:
            return method(request, timeout=timeout_s, metadata=self.metadata)
        except grpc.RpcError as error:
            raise self.error_of(error, timeout_s) from error
