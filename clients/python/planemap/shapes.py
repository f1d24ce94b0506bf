"""Parts of space to ask about. World frame, metres, radians."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence, Union

from planemap.v1 import planes_pb2, queries_pb2

Triple = Sequence[float]
"""Three numbers x, y, z; an array of shape (3,) is one, too."""


def vector(values: Triple, name: str) -> planes_pb2.Vector3:
    """The message for three numbers."""
    x, y, z = _floats(values, name, "x, y, z")
    return planes_pb2.Vector3(x=x, y=y, z=z)


def _floats(values: Sequence[float], name: str, names: str) -> list[float]:
    n = names.count(",") + 1
    try:
        numbers = [float(value) for value in values]
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: must be {n} numbers ({names}): {error}") from error
    if len(numbers) != n:
        raise ValueError(f"{name}: must have {n} numbers ({names}), has {len(numbers)}")
    return numbers


def _pose(position_m: Triple, rotation_wxyz: Sequence[float]) -> queries_pb2.Pose:
    w, x, y, z = _floats(rotation_wxyz, "rotation_wxyz", "w, x, y, z")
    return queries_pb2.Pose(
        position_m=vector(position_m, "position_m"), rotation_w=w, rotation_x=x, rotation_y=y, rotation_z=z
    )


@dataclass(frozen=True)
class Box:
    """Along the world's axes; sides may be infinite."""

    min_m: Triple
    max_m: Triple

    def put_into(self, request: queries_pb2.QueryRegionRequest) -> None:
        request.box.min_m.CopyFrom(vector(self.min_m, "min_m"))
        request.box.max_m.CopyFrom(vector(self.max_m, "max_m"))


@dataclass(frozen=True)
class OrientedBox:
    """A box whose middle and axes a pose places; size_m are its edges."""

    position_m: Triple
    rotation_wxyz: Sequence[float]
    size_m: Triple

    def put_into(self, request: queries_pb2.QueryRegionRequest) -> None:
        request.oriented_box.pose.CopyFrom(_pose(self.position_m, self.rotation_wxyz))
        request.oriented_box.size_m.CopyFrom(vector(self.size_m, "size_m"))


@dataclass(frozen=True)
class Sphere:
    centre_m: Triple
    radius_m: float

    def put_into(self, request: queries_pb2.QueryRegionRequest) -> None:
        request.sphere.centre_m.CopyFrom(vector(self.centre_m, "centre_m"))
        request.sphere.radius_m = self.radius_m


@dataclass(frozen=True)
class Frustum:
    """What a camera (x right, y down, z forward) sees between two depths."""

    position_m: Triple
    rotation_wxyz: Sequence[float]
    horizontal_rad: float
    vertical_rad: float
    near_m: float
    far_m: float

    def put_into(self, request: queries_pb2.QueryRegionRequest) -> None:
        frustum = request.frustum
        frustum.pose.CopyFrom(_pose(self.position_m, self.rotation_wxyz))
        frustum.horizontal_rad, frustum.vertical_rad = self.horizontal_rad, self.vertical_rad
        frustum.near_m, frustum.far_m = self.near_m, self.far_m


@dataclass(frozen=True)
class Cylinder:
    """Between the middles of its ends."""

    from_m: Triple
    to_m: Triple
    radius_m: float

    def put_into(self, request: queries_pb2.QueryRegionRequest) -> None:
        request.cylinder.from_m.CopyFrom(vector(self.from_m, "from_m"))
        request.cylinder.to_m.CopyFrom(vector(self.to_m, "to_m"))
        request.cylinder.radius_m = self.radius_m


Shape = Union[Box, OrientedBox, Sphere, Frustum, Cylinder]
