"""The client: questions to a map, answers as arrays."""

from __future__ import annotations

import operator
import time
from types import TracebackType
from typing import Any, Callable, Iterator, TypeVar

import grpc
import numpy as np
from numpy.typing import ArrayLike

from planemap.v1 import admin_service_pb2, admin_service_pb2_grpc, filter_pb2, map_pb2
from planemap.v1 import planemap_service_pb2, planemap_service_pb2_grpc, queries_pb2

from . import decode
from .channel import DEFAULT_SERVER, Channel, PathLike
from .errors import AnswerIncomplete, Gone, Unreachable
from .shapes import Shape
from .types import (
    Cells,
    Floats,
    FloorPlan,
    Map,
    NearestPlanes,
    PlaneFate,
    PlaneFilter,
    PlaneInfo,
    RayHits,
    RegionContents,
    Status,
    Version,
)
from .watch import Watch

_MOST_NEAREST_PLANES = 5000  # of a call: points times count
_MOST_RAYS = 2000
_MOST_UINT64 = 2**64 - 1

Item = TypeVar("Item")


def connect(
    server: str = DEFAULT_SERVER,
    *,
    token: str | None = None,
    tls: bool = False,
    ca_file: PathLike | None = None,
    certificate_file: PathLike | None = None,
    key_file: PathLike | None = None,
    server_name: str | None = None,
    timeout_s: float = 5.0,
) -> Client:
    """A client of the planemapd that listens at `server` (HOST, HOST:PORT or [IPv6]:PORT) for gRPC.

    token: sent with each call; over TLS or to the loopback only.
    tls: speak TLS, by the authorities that this system trusts; ca_file (PEM) names others and implies it.
    certificate_file, key_file: PEM, shown to a server that asks for them.
    server_name: what the server's certificate is for, if that is not HOST.
    timeout_s: how long each call may take.

    Nothing is sent yet: whether somebody listens shows with the first call. Raises ValueError for an address or an
    option that cannot be used, OSError for a file that cannot be read.
    """
    if not timeout_s > 0.0:
        raise ValueError(f"timeout_s: must be greater than 0, is {timeout_s:g}")
    return Client(Channel(server, token, tls, ca_file, certificate_file, key_file, server_name), timeout_s)


def _filter(given: PlaneFilter | None) -> filter_pb2.PlaneFilter:
    message = filter_pb2.PlaneFilter()
    if given is None:
        return message
    for name in given.classes:
        if name not in decode.CLASSES:
            raise ValueError(f"filter.classes: {name!r} is no class ({', '.join(decode.CLASSES)})")
        message.classes.append(decode.CLASSES.index(name))
    message.min_area_m2 = given.min_area_m2
    if given.max_normal_deviation_rad is not None:
        message.max_normal_deviation_rad = given.max_normal_deviation_rad
    if given.seen_since_utime is not None:
        message.seen_since_utime = _whole(given.seen_since_utime, "filter.seen_since_utime", -(2**63), 2**63 - 1)
    message.epoch = _whole(given.epoch, "filter.epoch", 0, _MOST_UINT64)
    return message


def _numbers(values: ArrayLike, name: str) -> Floats:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: must be an array of numbers: {error}") from error


def _broadcast(values: ArrayLike, name: str, shape: tuple[int, ...]) -> Floats:
    numbers = _numbers(values, name)
    try:
        return np.broadcast_to(numbers, shape)
    except ValueError as error:
        raise ValueError(f"{name}: must be of shape {shape} or fit it, is of shape {numbers.shape}") from error


def _whole(value: int, name: str, low: int, high: int) -> int:
    try:
        number = operator.index(value)
    except TypeError as error:
        raise ValueError(f"{name}: must be a whole number, is {value!r}") from error
    if not low <= number <= high:
        raise ValueError(f"{name}: must be {low} to {high}, is {number}")
    return number


def _rows(values: ArrayLike, name: str) -> Floats:
    rows = _numbers(values, name)
    if rows.ndim != 2 or rows.shape[1] != 3 or rows.shape[0] == 0:
        raise ValueError(f"{name}: must be of shape (n, 3) with n >= 1, is of shape {rows.shape}")
    return rows


class Client:
    """Made by connect(). Calls raise the exceptions of planemap.errors, and ValueError for arguments whose shape is
    wrong. May be used by several threads."""

    def __init__(self, channel: Channel, timeout_s: float) -> None:
        self._channel = channel
        self._timeout_s = timeout_s
        # gRPC's plugin writes no types.
        self._map: Any = planemap_service_pb2_grpc.PlaneMapStub(channel.channel)  # type: ignore[no-untyped-call]
        self._admin: Any = admin_service_pb2_grpc.AdminStub(channel.channel)  # type: ignore[no-untyped-call]

    def _again(self) -> Client:
        """The same over a new connection."""
        return Client(self._channel.again(), self._timeout_s)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connection; watches end, and further calls raise ValueError."""
        self._channel.close()

    def status(self) -> Status:
        """How the service is."""
        return decode.status_of(self._call(self._map.GetStatus, planemap_service_pb2.GetStatusRequest()))

    def snapshot(self, filter: PlaneFilter | None = None) -> Map:
        """All planes of one revision."""
        request = map_pb2.GetSnapshotRequest(filter=_filter(filter))
        pages = list(self._pages(self._map.GetSnapshot, request))
        planes = [decode.plane_of(plane) for page in pages for plane in page.planes]
        return Map(decode.version_of(pages[0].map), pages[0].frame, pages[0].cell_size_m, planes)

    def cells(self, filter: PlaneFilter | None = None, plane_ids: ArrayLike = ()) -> Cells:
        """The dense cells; of these planes alone, where any are named (10,000 at most)."""
        ids = [_whole(id, "plane_ids", 1, _MOST_UINT64) for id in np.atleast_1d(np.asarray(plane_ids)).tolist()]
        request = map_pb2.GetCellsRequest(filter=_filter(filter), plane_ids=ids)
        pages = list(self._pages(self._map.GetCells, request))
        cells = [cell for page in pages for cell in page.cells]
        return decode.cells_of(cells, decode.version_of(pages[0].map), pages[0].frame, pages[0].cell_size_m)

    def nearest(
        self,
        points_m: ArrayLike,
        *,
        sigma_m: ArrayLike | None = None,
        covariance_m2: ArrayLike | None = None,
        count: int = 1,
        max_distance_m: float | None = None,
        filter: PlaneFilter | None = None,
    ) -> NearestPlanes:
        """The planes whose surfaces are nearest to points (n, 3); up to `count` for each, all of one revision.

        sigma_m: standard deviation of the points in every direction; one for all, or (n,). None: they are exact.
        covariance_m2: instead of it, (3, 3) for all, or (n, 3, 3).
        """
        points = _rows(points_m, "points_m")
        count = _whole(count, "count", 1, 1000)
        if sigma_m is not None and covariance_m2 is not None:
            raise ValueError("sigma_m, covariance_m2: give one of them, not both")
        sigmas = _broadcast(0.0 if sigma_m is None else sigma_m, "sigma_m", (len(points),))
        uppers = None
        if covariance_m2 is not None:
            covariances = _broadcast(covariance_m2, "covariance_m2", (len(points), 3, 3))
            if not np.allclose(covariances, np.swapaxes(covariances, 1, 2), rtol=1e-9, atol=0.0, equal_nan=True):
                raise ValueError("covariance_m2: is not symmetric")
            uppers = covariances[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]

        def ask(
            begin: int, end: int, map: map_pb2.MapVersion | None
        ) -> tuple[map_pb2.MapVersion, list[queries_pb2.NearPlanes]]:
            request = queries_pb2.NearestPlanesRequest(
                count=count, filter=_filter(filter), map=map, more_follow=end < len(points)
            )
            if max_distance_m is not None:
                request.max_distance_m = max_distance_m
            for i in range(begin, end):
                point = request.points.add()
                point.point_m.x, point.point_m.y, point.point_m.z = points[i]
                if uppers is None:
                    point.sigma_m = sigmas[i]
                else:
                    point.covariance_m2.extend(uppers[i])
            response = self._call(self._map.NearestPlanes, request)
            return response.map, list(response.results)

        version, results = self._in_parts(ask, len(points), _MOST_NEAREST_PLANES // count)
        return decode.nearest_of(results, count, version)

    def cast(
        self,
        origins_m: ArrayLike,
        directions: ArrayLike,
        *,
        max_range_m: ArrayLike | None = None,
        planes: bool = True,
        cells: bool = True,
        filter: PlaneFilter | None = None,
    ) -> RayHits:
        """The first plane and the first dense cell on rays, all of one revision.

        origins_m, directions: (n, 3) or (1, 3) for all; directions are of any length but 0.
        max_range_m: one for all, or (n,); None: any.
        """
        origins, ways = _rows(origins_m, "origins_m"), _rows(directions, "directions")
        n = max(len(origins), len(ways))
        origins, ways = _broadcast(origins, "origins_m", (n, 3)), _broadcast(ways, "directions", (n, 3))
        ranges = None
        if max_range_m is not None:
            ranges = _broadcast(max_range_m, "max_range_m", (n,))

        def ask(
            begin: int, end: int, map: map_pb2.MapVersion | None
        ) -> tuple[map_pb2.MapVersion, list[queries_pb2.RayHits]]:
            request = queries_pb2.CastRaysRequest(
                skip_planes=not planes,
                skip_cells=not cells,
                filter=_filter(filter),
                map=map,
                more_follow=end < n,
            )
            for i in range(begin, end):
                ray = request.rays.add()
                ray.origin_m.x, ray.origin_m.y, ray.origin_m.z = origins[i]
                ray.direction.x, ray.direction.y, ray.direction.z = ways[i]
                if ranges is not None:
                    ray.max_range_m = ranges[i]
            response = self._call(self._map.CastRays, request)
            return response.map, list(response.hits)

        version, hits = self._in_parts(ask, n, _MOST_RAYS)
        return decode.hits_of(hits, version)

    def region(
        self, shape: Shape, *, polygons: bool = False, cells: bool = False, filter: PlaneFilter | None = None
    ) -> RegionContents:
        """What is in a part of space: planes; on demand what of their surfaces is inside, and the dense cells."""
        request = queries_pb2.QueryRegionRequest(polygons=polygons, cells=cells, filter=_filter(filter))
        shape.put_into(request)
        pages = list(self._pages(self._map.QueryRegion, request))
        version = decode.version_of(pages[0].map)
        planes = [decode.region_plane_of(plane) for page in pages for plane in page.planes]
        found = [cell for page in pages for cell in page.cells]
        return RegionContents(version, planes, decode.cells_of(found, version))

    def plane(self, plane_id: int) -> PlaneInfo:
        """Everything about a plane, also where it was merged into another one."""
        plane_id = _whole(plane_id, "plane_id", 1, _MOST_UINT64)
        request = queries_pb2.GetPlaneRequest(plane_id=plane_id)
        try:
            response = self._map.GetPlane(request, timeout=self._timeout_s, metadata=self._channel.metadata)
        except grpc.RpcError as error:
            if error.code() == grpc.StatusCode.NOT_FOUND:
                return PlaneInfo(asked=plane_id, fate=PlaneFate.UNKNOWN)
            raise self._channel.error_of(error, self._timeout_s) from error
        return decode.plane_info_of(response, plane_id)

    def floorplan(
        self,
        *,
        cut_low_m: float | None = None,
        cut_high_m: float | None = None,
        wall_thickness_m: float | None = None,
        clear_low_m: float | None = None,
        clear_high_m: float | None = None,
        filter: PlaneFilter | None = None,
    ) -> FloorPlan:
        """Walls and free floor, seen from above. Heights are above the floor; what None means is in docs/queries.md."""
        request = queries_pb2.GetFloorPlanRequest(
            cut_low_m=cut_low_m,
            cut_high_m=cut_high_m,
            wall_thickness_m=wall_thickness_m,
            clear_low_m=clear_low_m,
            clear_high_m=clear_high_m,
            filter=_filter(filter),
        )
        return decode.floor_plan_of(self._call(self._map.GetFloorPlan, request))

    def watch(self, *, silent_after_s: float = 5.0) -> Watch:
        """Keeps a mirror of the map up to date; connects again whenever it is cut off.

            with robot.watch() as watch:
                for change in watch:
                    print(change.added, change.changed, change.removed, len(watch.map.planes))

        silent_after_s: nothing was heard of the service for so long: next() raises Unreachable.
        """
        return Watch(self, silent_after_s)

    def pause(self) -> None:
        """Scans are dropped until resume(). Needs a token of scope admin; without tokens, to be on its machine."""
        self._call(self._admin.Pause, admin_service_pb2.PauseRequest())

    def resume(self) -> None:
        """Scans are mapped again."""
        self._call(self._admin.Resume, admin_service_pb2.ResumeRequest())

    def reset(self) -> int:
        """Begins a new, empty map. Returns its epoch."""
        return int(self._call(self._admin.Reset, admin_service_pb2.ResetRequest()).epoch)

    def save(self) -> None:
        """Writes the map to the service's store."""
        self._call(self._admin.Save, admin_service_pb2.SaveRequest())

    def _call(self, method: Callable[..., Any], request: Any) -> Any:
        return self._channel.call(method, request, self._timeout_s)

    def _pages(self, method: Callable[..., Any], request: Any) -> Iterator[Any]:
        """The pages of one answer, of which there is one at least; all of one version."""
        count, first, last = 0, None, False
        try:
            for page in method(request, timeout=self._timeout_s, metadata=self._channel.metadata):
                first = first or page.map
                if last or page.page != count or page.map != first:
                    raise decode.malformed("a page of the answer")
                count, last = count + 1, page.last
                yield page
        except grpc.RpcError as error:
            reason = self._channel.error_of(error, self._timeout_s)
            if count > 0 and isinstance(reason, Unreachable):
                raise AnswerIncomplete(f"the answer came in part only ({count} pages); then {reason}") from error
            raise reason from error
        if not last:
            raise decode.malformed("the last page of the answer")

    def _in_parts(
        self,
        ask: Callable[[int, int, map_pb2.MapVersion | None], tuple[map_pb2.MapVersion, list[Item]]],
        n: int,
        most: int,
    ) -> tuple[Version, list[Item]]:
        """Asks for many items, so many at a time and all of the map that answered first; where the service does not keep
        that one any more, anew."""
        deadline = time.monotonic() + self._timeout_s
        while True:
            items: list[Item] = []
            version: map_pb2.MapVersion | None = None
            for begin in range(0, n, most):
                end = min(begin + most, n)
                try:
                    message, part = ask(begin, end, version)
                except Gone:
                    break
                if len(part) != end - begin:
                    raise decode.malformed("a batch")
                if version is not None and version != message:
                    break
                version = message
                items += part
            if version is not None and len(items) == n:
                return decode.version_of(version), items
            if time.monotonic() >= deadline:
                raise AnswerIncomplete(
                    f"the map changed faster than all {n} could be asked of one revision within {self._timeout_s:g} s; "
                    f"ask for {most} at a time"
                )
