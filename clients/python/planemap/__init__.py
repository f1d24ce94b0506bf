"""Asks a planemapd for its map of planes with uncertainty.

    import planemap

    with planemap.connect() as robot:              # 127.0.0.1:7670
        for plane in robot.snapshot().planes:
            print(plane.id, plane.plane_class, plane.area_m2)
        near = robot.nearest([[1.2, 0.4, 0.9]], sigma_m=0.01)
        print(near.signed_distance_m, "+-", near.sigma_m)

Metres, radians, square metres; coordinates are those of the world frame; utimes are microseconds of the scans' clock;
standard deviations are one sigma. What the answers mean is in docs/queries.md.
"""

from .client import Client, connect
from .errors import (
    AnswerIncomplete,
    Denied,
    MalformedAnswer,
    PlanemapError,
    Refused,
    Unreachable,
)
from .shapes import Box, Cylinder, Frustum, OrientedBox, Shape, Sphere
from .types import (
    Cells,
    FloorPlan,
    Map,
    NearestPlanes,
    Plane,
    PlaneFate,
    PlaneFilter,
    PlaneInfo,
    Polygon,
    RayHits,
    RegionContents,
    RegionPlane,
    RemovedPlane,
    Status,
    Version,
)
from .watch import Change, Watch

__all__ = [
    "AnswerIncomplete",
    "Box",
    "Cells",
    "Change",
    "Client",
    "Cylinder",
    "Denied",
    "FloorPlan",
    "Frustum",
    "MalformedAnswer",
    "Map",
    "NearestPlanes",
    "OrientedBox",
    "Plane",
    "PlaneFate",
    "PlaneFilter",
    "PlaneInfo",
    "PlanemapError",
    "Polygon",
    "RayHits",
    "Refused",
    "RegionContents",
    "RegionPlane",
    "RemovedPlane",
    "Shape",
    "Sphere",
    "Status",
    "Unreachable",
    "Version",
    "Watch",
    "connect",
]
