"""From messages of planemap.v1 to arrays."""

from __future__ import annotations

from typing import Any, Iterable, Sequence

import numpy as np

from planemap.v1 import cells_pb2, map_pb2, planemap_service_pb2, planes_pb2, queries_pb2

from .errors import MalformedAnswer
from .types import (
    Cells,
    Floats,
    FloorPlan,
    NearestPlanes,
    Plane,
    PlaneFate,
    PlaneInfo,
    Polygon,
    RayHits,
    RegionPlane,
    RemovedPlane,
    Status,
    Version,
)

CLASSES = ("other", "floor", "ceiling", "wall", "table", "slope")
_FATES = {1: PlaneFate.LIVES, 2: PlaneFate.MERGED, 3: PlaneFate.GONE}
_UPPER = np.triu_indices(4)


def malformed(what: str) -> MalformedAnswer:
    return MalformedAnswer(f"the service's answer cannot be used: {what} is not sound")


def _triple(message: planes_pb2.Vector3) -> tuple[float, float, float]:
    return message.x, message.y, message.z


def _finite(values: Any, shape: tuple[int, ...], what: str) -> Floats:
    array = np.array(values, dtype=np.float64).reshape(shape)
    if not np.isfinite(array).all():
        raise malformed(what)
    return array


def version_of(message: map_pb2.MapVersion) -> Version:
    if message.epoch == 0:
        raise malformed("the map's version")
    return Version(message.epoch, message.revision, message.utime)


def _ring(message: planes_pb2.Ring) -> Floats:
    if len(message.uv_m) % 2 != 0 or len(message.uv_m) < 6:
        raise malformed("a polygon")
    return _finite(message.uv_m, (-1, 2), "a polygon")


def polygons_of(messages: Iterable[planes_pb2.Polygon]) -> list[Polygon]:
    return [Polygon(_ring(message.outer), [_ring(hole) for hole in message.holes]) for message in messages]


def plane_of(message: planes_pb2.Plane) -> Plane:
    what = f"plane {message.id}"
    if message.id == 0 or len(message.covariance) != 10 or message.plane_class not in range(len(CLASSES)):
        raise malformed(what)
    covariance = np.zeros((4, 4))
    covariance[_UPPER] = _finite(message.covariance, (10,), what)
    covariance.T[_UPPER] = covariance[_UPPER]
    outline = message.outline
    return Plane(
        id=message.id,
        normal=_finite(_triple(message.normal), (3,), what),
        d_m=float(_finite(message.d_m, (), what)),
        covariance=covariance,
        centroid_m=_finite(_triple(message.centroid_m), (3,), what),
        area_m2=outline.area_m2,
        cell_count=message.cell_count,
        point_count=message.point_count,
        first_seen_utime=message.first_seen_utime,
        last_seen_utime=message.last_seen_utime,
        plane_class=CLASSES[message.plane_class],
        quality=message.quality,
        revision=message.revision,
        merged=list(message.merged),
        origin_m=_finite(_triple(outline.origin_m), (3,), what),
        axes=_finite([_triple(outline.axis_u), _triple(outline.axis_v)], (2, 3), what),
        polygons=polygons_of(outline.polygons),
    )


def removed_of(message: map_pb2.RemovedPlane) -> RemovedPlane:
    return RemovedPlane(message.id, message.merged_into)


def cells_of(
    messages: Sequence[cells_pb2.Cell], version: Version, frame: str = "", cell_size_m: float = float("nan")
) -> Cells:
    return Cells(
        version=version,
        frame=frame,
        cell_size_m=cell_size_m,
        centre_m=_finite([_triple(cell.centre_m) for cell in messages], (-1, 3), "a cell"),
        sigma_m=_finite([_triple(cell.sigma_m) for cell in messages], (-1, 3), "a cell"),
        normal=_finite([_triple(cell.normal) for cell in messages], (-1, 3), "a cell"),
        deviation_rad=np.array([cell.deviation_rad for cell in messages], dtype=np.float64),
        count=np.array([cell.count for cell in messages], dtype=np.int64),
        plane_id=np.array([cell.plane_id for cell in messages], dtype=np.int64),
    )


def status_of(message: planemap_service_pb2.GetStatusResponse) -> Status:
    return Status(
        utime=message.utime,
        service_version=message.version,
        version=version_of(message.map),
        plane_count=message.plane_count,
        cell_count=message.cell_count,
        block_count=message.block_count,
        scan_rate_hz=message.scan_rate_hz,
        scan_ms_p50=message.scan_ms_p50,
        scan_ms_max=message.scan_ms_max,
        idle_reason=message.idle_reason,
        degraded=message.degraded,
        paused=message.paused,
        counters=dict(message.counters),
    )


def nearest_of(results: Sequence[queries_pb2.NearPlanes], count: int, version: Version) -> NearestPlanes:
    shape = (len(results), count)

    def empty(*more: int) -> Floats:
        return np.full(shape + more, np.nan)

    near = NearestPlanes(
        version=version,
        plane_id=np.zeros(shape, dtype=np.int64),
        surface_distance_m=empty(),
        surface_point_m=empty(3),
        signed_distance_m=empty(),
        sigma_m=empty(),
        mahalanobis=empty(),
        foot_m=empty(3),
        foot_inside=np.zeros(shape, dtype=np.bool_),
    )
    for i, result in enumerate(results):
        if len(result.planes) > count:
            raise malformed("what is near a point")
        for k, plane in enumerate(result.planes):
            near.plane_id[i, k] = plane.plane_id
            near.surface_distance_m[i, k] = plane.surface_distance_m
            near.surface_point_m[i, k] = _triple(plane.surface_point_m)
            near.signed_distance_m[i, k] = plane.signed_distance_m
            near.sigma_m[i, k] = plane.sigma_m
            near.mahalanobis[i, k] = plane.mahalanobis
            near.foot_m[i, k] = _triple(plane.foot_m)
            near.foot_inside[i, k] = plane.foot_inside
    return near


def hits_of(messages: Sequence[queries_pb2.RayHits], version: Version) -> RayHits:
    n = len(messages)
    hits = RayHits(
        version=version,
        plane_id=np.zeros(n, dtype=np.int64),
        range_m=np.full(n, np.nan),
        sigma_m=np.full(n, np.nan),
        incidence_rad=np.full(n, np.nan),
        from_behind=np.zeros(n, dtype=np.bool_),
        point_m=np.full((n, 3), np.nan),
        cell_met=np.zeros(n, dtype=np.bool_),
        cell_plane_id=np.zeros(n, dtype=np.int64),
        cell_range_m=np.full(n, np.nan),
        cell_sigma_m=np.full(n, np.nan),
        cell_entry_m=np.full(n, np.nan),
    )
    for i, message in enumerate(messages):
        if message.HasField("plane"):
            plane = message.plane
            hits.plane_id[i], hits.range_m[i], hits.sigma_m[i] = plane.plane_id, plane.range_m, plane.sigma_m
            hits.incidence_rad[i], hits.from_behind[i] = plane.incidence_rad, plane.from_behind
            hits.point_m[i] = _triple(plane.point_m)
        if message.HasField("cell"):
            cell = message.cell
            hits.cell_met[i], hits.cell_plane_id[i] = True, cell.cell.plane_id
            hits.cell_range_m[i], hits.cell_sigma_m[i] = cell.range_m, cell.sigma_m
            hits.cell_entry_m[i] = cell.entry_m
    return hits


def region_plane_of(message: queries_pb2.RegionPlane) -> RegionPlane:
    return RegionPlane(plane_of(message.plane), message.whole, polygons_of(message.polygons), message.area_m2)


def plane_info_of(message: queries_pb2.GetPlaneResponse, asked: int) -> PlaneInfo:
    if message.fate not in _FATES:
        raise malformed("what became of the plane")
    return PlaneInfo(
        asked=asked,
        fate=_FATES[message.fate],
        version=version_of(message.map),
        lineage=list(message.lineage),
        removed_revision=message.removed_revision if message.HasField("removed_revision") else None,
        plane=plane_of(message.plane) if message.HasField("plane") else None,
        normal_deviation_rad=message.normal_deviation_rad,
        coplanar=list(message.coplanar),
    )


def floor_plan_of(message: queries_pb2.GetFloorPlanResponse) -> FloorPlan:
    what = "the floor plan"
    return FloorPlan(
        version=version_of(message.map),
        origin_m=_finite(_triple(message.origin_m), (3,), what),
        axes=_finite([_triple(message.axis_x), _triple(message.axis_y)], (2, 3), what),
        walls=polygons_of(message.walls),
        floor=polygons_of(message.floor),
        free_floor=polygons_of(message.free_floor),
        free_area_m2=message.free_area_m2,
    )
