"""A mirror of the map that is kept up to date."""

from __future__ import annotations

import queue
import threading
import time
from dataclasses import dataclass, field
from types import TracebackType
from typing import TYPE_CHECKING, Any, Iterator, Union

import grpc

from planemap.v1 import map_pb2

from . import decode
from .errors import AnswerIncomplete, PlanemapError, Unreachable
from .types import Map, Plane, RemovedPlane, Version

if TYPE_CHECKING:
    from .client import Client

_CONNECT_AFTER_S = 0.2  # a stream that was cut off
_LEAST_HEARTBEAT_S = 0.1

_Event = Union[map_pb2.WatchEvent, grpc.RpcError, None]


@dataclass(frozen=True)
class Change:
    """What has changed in the mirrored map."""

    version: Version
    new_map: bool = False
    """The first one, or one of another epoch: its ids mean other planes than those before."""
    added: list[int] = field(default_factory=list)
    changed: list[int] = field(default_factory=list)
    removed: list[RemovedPlane] = field(default_factory=list)

    def __bool__(self) -> bool:
        return bool(self.new_map or self.added or self.changed or self.removed)


class _Stream:
    """One call of Watch, read by a thread of its own. What is not taken stays with the server, which puts the changes
    of many revisions together for slow readers."""

    def __init__(self, call: Any) -> None:
        self._call = call
        self._events: queue.Queue[_Event] = queue.Queue(maxsize=1)
        self._is_over = False
        threading.Thread(target=self._read, name="planemap-watch", daemon=True).start()

    def next(self, timeout_s: float) -> _Event:
        """An event; how the call failed; None: it ended. Raises queue.Empty where nothing came in time."""
        return self._events.get(timeout=max(timeout_s, 0.001))

    def close(self) -> None:
        self._is_over = True
        self._call.cancel()
        while not self._events.empty():  # the reader may wait for room
            self._events.get_nowait()

    def _read(self) -> None:
        end: _Event = None
        try:
            for event in self._call:
                self._events.put(event)
                if self._is_over:
                    return
        except grpc.RpcError as error:
            end = error
        if not self._is_over:
            self._events.put(end)


class _ClientClosed(ValueError):
    pass


class Watch:
    """Made by Client.watch(). Used by one thread."""

    def __init__(self, client: Client, silent_after_s: float) -> None:
        self._client = client
        self._own: Client | None = None  # once it was cut off: over a connection of its own
        self._silent_after_s = silent_after_s
        self._map: Map | None = None
        self._stream: _Stream | None = None
        self._open_at = self._heard_at = self._listened_at = time.monotonic()
        self._coming: list[map_pb2.WatchEvent] = []
        self._cut_off: PlanemapError | None = None

    def __enter__(self) -> Watch:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Ends the call; the mirror stays."""
        self._drop_stream()
        self._close_own()

    @property
    def map(self) -> Map:
        """The map as it was last heard of."""
        if self._map is None:
            raise LookupError("there is no map yet: the first change that next() gives brings it")
        return self._map

    def __iter__(self) -> Iterator[Change]:
        """Each change, until the client is closed."""
        while True:
            try:
                change = self.next(self._silent_after_s)
            except _ClientClosed:
                return
            if change is not None:
                yield change

    def next(self, timeout_s: float) -> Change | None:
        """Waits for the next change and applies it; the first is the whole map. None: nothing has changed in time,
        though the service lives. Raises Unreachable where nothing was heard of it; the mirror stays, and next() may be
        called on."""
        begin = time.monotonic()
        deadline = begin + timeout_s
        if begin - self._listened_at >= self._silent_after_s:  # what came in between is still to be read
            self._heard_at = begin
        while True:
            change = self._step(min(deadline, self._heard_at + self._silent_after_s))
            self._listened_at = now = time.monotonic()
            if change:
                return change
            if now - self._heard_at >= self._silent_after_s:
                self._connect_again()
                self._heard_at = now  # the next call may wait as long again
                raise self._silence(self._silent_after_s)
            if now >= deadline:
                if self._map is None:
                    raise self._silence(timeout_s)
                return None

    def _silence(self, time_s: float) -> PlanemapError:
        return self._cut_off or Unreachable(
            f"nothing was heard of a planemap service at {self._client._channel.server} for {time_s:g} s"
        )

    def _drop_stream(self) -> None:
        if self._stream is not None:
            self._stream.close()
        self._stream = None
        self._coming = []
        self._open_at = time.monotonic() + _CONNECT_AFTER_S

    def _close_own(self) -> None:
        own, self._own = self._own, None
        if own is not None:
            own.close()

    def _connect_again(self) -> None:
        self._drop_stream()
        self._close_own()
        self._own = self._client._again()

    def _step(self, until: float) -> Change | None:
        if self._client._channel.is_closed:
            self.close()
            raise _ClientClosed("the client of this watch is closed")
        if self._stream is None:
            now = time.monotonic()
            if now < self._open_at:
                time.sleep(max(0.0, min(until, self._open_at) - now))
                return None
            self._open()
        assert self._stream is not None
        try:
            event = self._stream.next(until - time.monotonic())
        except queue.Empty:
            return None
        if event is None or isinstance(event, grpc.RpcError):
            self._take_end(event)
            return None
        self._heard_at = time.monotonic()
        self._cut_off = None
        return self._take(event)

    def _open(self) -> None:
        heartbeat_s = max(_LEAST_HEARTBEAT_S, min(1.0, self._silent_after_s / 4.0))
        request = map_pb2.WatchRequest(heartbeat_s=heartbeat_s)
        if self._map is not None:
            request.epoch, request.since_revision = self._map.version.epoch, self._map.version.revision
        client = self._own or self._client
        self._stream = _Stream(client._map.Watch(request, metadata=client._channel.metadata))

    def _take_end(self, error: grpc.RpcError | None) -> None:
        self._drop_stream()
        channel = self._client._channel
        if channel.is_closed:
            return
        reason = Unreachable(f"{channel.server} ended the watch") if error is None else channel.error_of(error, 0.0)
        if not isinstance(reason, Unreachable):
            raise reason
        self._connect_again()
        self._cut_off = reason

    def _take(self, event: map_pb2.WatchEvent) -> Change | None:
        if event.HasField("delta"):
            return self._take_delta(event)
        return self._take_snapshot() if event.HasField("snapshot_needed") else None

    def _take_snapshot(self) -> Change | None:
        self._coming = []
        try:
            fresh = (self._own or self._client).snapshot()
        except (Unreachable, AnswerIncomplete) as error:  # a new stream asks for it again
            self._connect_again()
            self._cut_off = error
            return None
        old, self._map = self._map, fresh
        self._heard_at = time.monotonic()
        if old is None or old.version.epoch != fresh.version.epoch:
            return Change(fresh.version, True, added=[plane.id for plane in fresh.planes])
        before = {plane.id: plane.revision for plane in old.planes}
        after = {plane.id: plane.revision for plane in fresh.planes}
        return Change(
            fresh.version,
            added=sorted(after.keys() - before.keys()),
            changed=[id for id in sorted(after.keys() & before.keys()) if after[id] != before[id]],
            removed=[RemovedPlane(id, 0) for id in sorted(before.keys() - after.keys())],
        )

    def _take_delta(self, event: map_pb2.WatchEvent) -> Change | None:
        if event.delta.page != len(self._coming):
            self._drop_stream()
            raise decode.malformed("a delta")
        self._coming.append(event)
        if not event.delta.last:
            return None
        pages, self._coming = self._coming, []
        version, known = decode.version_of(event.map), self._map
        if known is None or version.epoch != known.version.epoch or event.delta.since_revision > known.version.revision:
            return self._take_snapshot()  # it does not connect to what is known
        if version.revision <= known.version.revision:
            return None
        planes: dict[int, Plane] = {plane.id: plane for plane in known.planes}
        removed = [decode.removed_of(gone) for page in pages for gone in page.delta.removed if gone.id in planes]
        for gone in removed:
            del planes[gone.id]
        news = [decode.plane_of(plane) for page in pages for plane in page.delta.changed]
        added = [plane.id for plane in news if plane.id not in planes]
        changed = [plane.id for plane in news if plane.id in planes]
        planes.update((plane.id, plane) for plane in news)
        self._map = Map(version, known.frame, known.cell_size_m, sorted(planes.values(), key=lambda plane: plane.id))
        return Change(version, added=added, changed=changed, removed=removed)
