"""What a map is made of. Metres, radians, square metres; world frame; utimes in microseconds; sigmas are one standard
deviation. Shapes of arrays are given as (rows, columns)."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Version:
    """Of which map an answer is: `epoch` names one life of it, `revision` a state of its planes."""

    epoch: int
    revision: int
    utime: int
    """Of the newest mapped scan; 0: none was mapped yet."""


@dataclass(frozen=True)
class Polygon:
    """Rings of corners (n, 2), metres, in the basis of what the polygon belongs to; the first is not repeated."""

    outer: Floats
    """(n, 2), counter-clockwise."""
    holes: list[Floats]
    """(n, 2) each, clockwise."""


@dataclass(frozen=True, eq=False)
class Plane:
    """The points with normal . x + d_m = 0 within its polygons."""

    id: int
    """Never used again."""
    normal: Floats
    """(3,), unit, towards the side from which it was seen."""
    d_m: float
    covariance: Floats
    """(4, 4) of (nx, ny, nz, d), rank 3."""
    centroid_m: Floats
    """(3,)"""
    area_m2: float
    cell_count: int
    point_count: int
    first_seen_utime: int
    last_seen_utime: int
    plane_class: str
    """floor, ceiling, wall, table, slope or other."""
    quality: float
    """0 to 1."""
    revision: int
    """Of the map, when this plane last changed."""
    merged: list[int]
    """Planes that were merged into it."""
    origin_m: Floats
    """(3,), where (0, 0) of the polygons is."""
    axes: Floats
    """(2, 3), unit: the polygons' axes u and v."""
    polygons: list[Polygon]
    """Largest first; counter-clockwise seen from the normal's side."""

    def to_world(self, uv_m: Floats) -> Floats:
        """Corners (n, 2) of its polygons as points (n, 3)."""
        points: Floats = self.origin_m + np.asarray(uv_m) @ self.axes
        return points


@dataclass(frozen=True, eq=False)
class Map:
    """All planes of one revision, by id."""

    version: Version
    frame: str
    cell_size_m: float
    planes: list[Plane]

    def plane(self, plane_id: int) -> Plane:
        """The plane of that id; KeyError: there is none."""
        for plane in self.planes:
            if plane.id == plane_id:
                return plane
        raise KeyError(f"no plane {plane_id} in revision {self.version.revision} of the map")


@dataclass(frozen=True, eq=False)
class Cells:
    """Dense cells of the grid; row i of each array is of cell i."""

    version: Version
    frame: str
    cell_size_m: float
    centre_m: Floats
    """(n, 3), means of the cells' points."""
    sigma_m: Floats
    """(n, 3), standard errors of the centres along the world's axes."""
    normal: Floats
    """(n, 3), unit; zeros where it is not known."""
    deviation_rad: Floats
    """(n,), of the normal."""
    count: Ints
    """(n,), points."""
    plane_id: Ints
    """(n,); 0: of no plane."""


@dataclass(frozen=True)
class Status:
    """How the service is."""

    utime: int
    service_version: str
    version: Version
    plane_count: int
    cell_count: int
    block_count: int
    scan_rate_hz: float
    scan_ms_p50: float
    scan_ms_max: float
    idle_reason: str
    """Why nothing is being mapped; empty while scans are mapped."""
    degraded: str
    """What the service cannot do at present, while it maps on; empty: nothing."""
    paused: bool
    counters: dict[str, int]


@dataclass(frozen=True)
class PlaneFilter:
    """Which planes an answer may name; as it is made, every one."""

    classes: Sequence[str] = ()
    """Any of these: floor, ceiling, wall, table, slope, other; none given: any."""
    min_area_m2: float = 0.0
    max_normal_deviation_rad: float | None = None
    seen_since_utime: int | None = None
    epoch: int = 0
    """Of the map that is meant, else the call fails; 0: whichever."""


@dataclass(frozen=True, eq=False)
class NearestPlanes:
    """For each of n points up to `count` planes, nearest first: arrays (n, count, ...). Where there are fewer planes
    plane_id is 0, numbers are NaN and foot_inside is False."""

    version: Version
    plane_id: Ints
    """(n, count)"""
    surface_distance_m: Floats
    """(n, count), to the nearest point within the boundary."""
    surface_point_m: Floats
    """(n, count, 3), that point."""
    signed_distance_m: Floats
    """(n, count), to the endless plane; > 0 on the side from which it was seen."""
    sigma_m: Floats
    """(n, count), of the signed distance."""
    mahalanobis: Floats
    """(n, count), |signed distance| / sigma."""
    foot_m: Floats
    """(n, count, 3), the point's projection on the endless plane."""
    foot_inside: Bools
    """(n, count), whether the foot lies within the boundary."""


@dataclass(frozen=True, eq=False)
class RayHits:
    """The first plane and the first dense cell on each of n rays. Where none is met, ids are 0 and numbers NaN."""

    version: Version
    plane_id: Ints
    """(n,); 0: no plane is met."""
    range_m: Floats
    """(n,), to the plane along the ray."""
    sigma_m: Floats
    """(n,), of that range."""
    incidence_rad: Floats
    """(n,): 0 square on, pi/2 edge-on."""
    from_behind: Bools
    """(n,)"""
    point_m: Floats
    """(n, 3)"""
    cell_met: Bools
    """(n,), whether a cell is met."""
    cell_plane_id: Ints
    """(n,), of that cell; 0: it is of no plane, or none is met."""
    cell_range_m: Floats
    """(n,), at which the ray passes nearest to the cell's centre."""
    cell_sigma_m: Floats
    """(n,), of that range."""
    cell_entry_m: Floats
    """(n,), at which the ray enters the cell's cube."""


@dataclass(frozen=True, eq=False)
class RegionPlane:
    """A plane of which something is in a region."""

    plane: Plane
    whole: bool
    """All of its surface is in the region."""
    polygons: list[Polygon]
    """What is in it, in the plane's basis; on demand."""
    area_m2: float
    """Of these polygons."""


@dataclass(frozen=True, eq=False)
class RegionContents:
    """What is in a part of space; planes by id."""

    version: Version
    planes: list[RegionPlane]
    cells: Cells
    """On demand; else of no rows. Its frame and cell_size_m are not told."""


class PlaneFate(enum.Enum):
    """What became of a plane."""

    UNKNOWN = "unknown"
    LIVES = "lives"
    MERGED = "merged"
    GONE = "gone"


@dataclass(frozen=True, eq=False)
class PlaneInfo:
    """Everything about one plane, also where it was merged into another."""

    asked: int
    fate: PlaneFate
    version: Version | None = None
    """None where the plane is not known."""
    lineage: list[int] = field(default_factory=list)
    """9, 17: "9 was merged into 17"."""
    removed_revision: int | None = None
    """When the asked one was merged or went; None: it lives, or that is not known."""
    plane: Plane | None = None
    """That holds it now; the next two are of this one."""
    normal_deviation_rad: float = 0.0
    coplanar: list[int] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """Seen from above; polygons along the axes, see to_world()."""

    version: Version
    origin_m: Floats
    """(3,), on the lowest floor."""
    axes: Floats
    """(2, 3), unit; their cross product points up."""
    walls: list[Polygon]
    floor: list[Polygon]
    free_floor: list[Polygon]
    free_area_m2: float

    def to_world(self, xy_m: Floats) -> Floats:
        """Corners (n, 2) of its polygons as points (n, 3)."""
        points: Floats = self.origin_m + np.asarray(xy_m) @ self.axes
        return points


@dataclass(frozen=True)
class RemovedPlane:
    """A plane that is no more."""

    id: int
    merged_into: int
    """The plane that holds it now; 0: it is gone."""
