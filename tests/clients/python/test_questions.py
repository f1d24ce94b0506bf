"""What a map answers, checked against its own planes."""

from __future__ import annotations

import numpy as np
import pytest

import planemap
from planemap import Box, Client, Cylinder, Frustum, Map, OrientedBox, PlaneFate, PlaneFilter, Sphere

EVERYWHERE = Box([-np.inf] * 3, [np.inf] * 3)


@pytest.fixture
def map_(client: Client) -> Map:
    return client.snapshot()


def test_status_says_how_the_service_is(client: Client, map_: Map) -> None:
    status = client.status()
    assert status.version == map_.version
    assert status.plane_count == len(map_.planes) > 5
    assert status.counters["scans.mapped"] > 0
    assert not status.paused
    assert status.service_version


def test_planes_of_a_snapshot_are_whole(map_: Map) -> None:
    assert map_.frame == "world"
    assert 0.0 < map_.cell_size_m < 1.0
    assert [plane.id for plane in map_.planes] == sorted(plane.id for plane in map_.planes)
    assert {"floor", "wall"} <= {plane.plane_class for plane in map_.planes}
    for plane in map_.planes:
        assert map_.plane(plane.id) is plane
        assert np.isclose(np.linalg.norm(plane.normal), 1.0)
        assert plane.covariance.shape == (4, 4)
        assert (plane.covariance == plane.covariance.T).all()
        assert np.linalg.eigvalsh(plane.covariance)[0] > -1e-9
        assert np.allclose(np.cross(*plane.axes), plane.normal, atol=1e-6)
        for polygon in plane.polygons:
            corners = plane.to_world(polygon.outer)
            assert corners.shape == (len(polygon.outer), 3)
            assert np.abs(corners @ plane.normal + plane.d_m).max() < 1e-4
    areas = [area_of(polygon) for polygon in map_.planes[0].polygons]
    # Corners are simplified to a quarter of a cell; the area is that before.
    assert sum(areas) == pytest.approx(map_.planes[0].area_m2, rel=0.03)
    with pytest.raises(KeyError, match="no plane 999999 in revision"):
        map_.plane(999999)


def area_of(polygon: planemap.Polygon) -> float:
    def ring(points: np.ndarray) -> float:
        x, y = points.T
        return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))

    return ring(polygon.outer) + sum(ring(hole) for hole in polygon.holes)


def test_cells_can_be_asked_for_by_plane(client: Client, map_: Map) -> None:
    cells = client.cells()
    n = len(cells.count)
    assert n > 1000
    assert cells.centre_m.shape == cells.sigma_m.shape == cells.normal.shape == (n, 3)
    assert cells.deviation_rad.shape == cells.plane_id.shape == (n,)
    first = map_.planes[0].id
    some = client.cells(plane_ids=[first])
    assert (some.plane_id == first).all()
    assert len(some.count) == (cells.plane_id == first).sum() > 0


def test_nearest_agrees_with_the_planes(client: Client, map_: Map) -> None:
    points = np.random.default_rng(3).uniform(-3.0, 3.0, (6000, 3))  # more than one call brings
    near = client.nearest(points, sigma_m=0.01)
    assert near.plane_id.shape == (6000, 1)
    assert near.foot_m.shape == (6000, 1, 3)
    assert (near.plane_id > 0).all()
    for point, id, distance in list(zip(points, near.plane_id[:, 0], near.signed_distance_m[:, 0]))[::50]:
        plane = map_.plane(id)
        assert distance == pytest.approx(point @ plane.normal + plane.d_m, abs=1e-9)
    assert (near.sigma_m >= 0.01).all()
    assert np.allclose(near.mahalanobis, np.abs(near.signed_distance_m) / near.sigma_m)
    by_covariance = client.nearest(points[:10], covariance_m2=1e-4 * np.eye(3))
    assert np.allclose(by_covariance.sigma_m, near.sigma_m[:10])


def test_fewer_planes_than_asked_for_are_zeros_and_nans(client: Client) -> None:
    near = client.nearest([[500.0, 0.0, 0.0]], count=3, max_distance_m=1.0)
    assert near.plane_id.tolist() == [[0, 0, 0]]
    assert np.isnan(near.signed_distance_m).all()
    assert not near.foot_inside.any()


def test_rays_end_on_planes(client: Client, map_: Map) -> None:
    ways = np.random.default_rng(4).normal(size=(2500, 3))
    hits = client.cast([[0.0, 0.0, 1.0]], ways)
    met = hits.plane_id > 0
    assert met.sum() > 100
    for i in np.flatnonzero(met)[::20]:
        plane = map_.plane(hits.plane_id[i])
        assert hits.point_m[i] @ plane.normal + plane.d_m == pytest.approx(0.0, abs=1e-6)
        assert hits.range_m[i] == pytest.approx(np.linalg.norm(hits.point_m[i] - [0.0, 0.0, 1.0]))
    assert np.isnan(hits.range_m[~met]).all()
    assert hits.cell_met.any()
    assert np.isnan(hits.cell_range_m[~hits.cell_met]).all()
    assert not client.cast([[0, 0, 1]], ways, planes=False).plane_id.any()
    assert (client.cast([[0, 0, 1]], ways[:50], max_range_m=0.01).plane_id == 0).all()


def test_regions_of_every_shape(client: Client, map_: Map) -> None:
    everything = client.region(EVERYWHERE, polygons=True, cells=True)
    assert [found.plane.id for found in everything.planes] == [plane.id for plane in map_.planes]
    assert all(found.whole for found in everything.planes)
    assert len(everything.cells.count) == len(client.cells().count)
    for found in everything.planes:
        assert sum(area_of(polygon) for polygon in found.polygons) == pytest.approx(found.area_m2, rel=1e-4)
    turned = [1.0, 0.0, 0.0, 0.0]
    middle = map_.planes[0].centroid_m
    for shape in (
        OrientedBox(middle, turned, [1.0, 1.0, 1.0]),
        Sphere(middle, 0.5),
        Frustum(middle - [0.0, 0.0, 1.0], turned, 1.0, 1.0, 0.1, 5.0),
        Cylinder(middle - [0.0, 0.0, 1.0], middle + [0.0, 0.0, 1.0], 0.5),
    ):
        assert client.region(shape).planes, shape
    assert not client.region(Sphere([500.0, 0.0, 0.0], 1.0)).planes


def test_filters_hold(client: Client, map_: Map) -> None:
    walls = client.snapshot(PlaneFilter(classes=["wall"], min_area_m2=0.5))
    assert 0 < len(walls.planes) < len(map_.planes)
    assert all(plane.plane_class == "wall" and plane.area_m2 >= 0.5 for plane in walls.planes)
    assert not client.snapshot(PlaneFilter(max_normal_deviation_rad=1e-9)).planes
    assert not client.snapshot(PlaneFilter(seen_since_utime=2**60)).planes


def test_a_plane_is_told_with_what_became_of_it(client: Client, map_: Map) -> None:
    info = client.plane(map_.planes[0].id)
    assert info.fate is PlaneFate.LIVES
    assert info.lineage == [map_.planes[0].id]
    assert info.plane is not None and info.plane.id == map_.planes[0].id
    assert info.normal_deviation_rad > 0.0
    unknown = client.plane(999999)
    assert unknown.fate is PlaneFate.UNKNOWN
    assert unknown.plane is None


def test_the_floor_plan_lies_on_the_floor(client: Client, map_: Map) -> None:
    plan = client.floorplan()
    assert plan.free_area_m2 > 0.1
    assert np.allclose(np.cross(*plan.axes), [0.0, 0.0, 1.0])
    corners = plan.to_world(plan.floor[0].outer)
    assert np.allclose(corners[:, 2], plan.origin_m[2])
    floors = [plane.centroid_m[2] for plane in map_.planes if plane.plane_class == "floor"]
    assert plan.origin_m[2] == pytest.approx(min(floors), abs=0.05)
    assert client.floorplan(cut_low_m=0.5).walls


@pytest.mark.parametrize(
    "ask, words",
    [
        (lambda c: c.nearest([1.0, 2.0, 3.0]), r"points_m: must be of shape \(n, 3\) with n >= 1, is of shape \(3,\)"),
        (lambda c: c.nearest([[1.0, 2.0, 3.0]], count=0), "count: must be 1 to 1000, is 0"),
        (lambda c: c.nearest([[1, 2, 3]], covariance_m2=np.triu(np.ones((3, 3)))), "covariance_m2: is not symmetric"),
        (
            lambda c: c.nearest([[1, 2, 3]], sigma_m=0.1, covariance_m2=np.eye(3)),
            "sigma_m, covariance_m2: give one of them, not both",
        ),
        (lambda c: c.nearest([[1, 2, 3]], sigma_m=[1, 2]), r"sigma_m: must be of shape \(1,\) or fit it, is of shape \(2,\)"),
        (lambda c: c.nearest([[1, 2, "far"]]), "points_m: must be an array of numbers: could not convert"),
        (lambda c: c.nearest([[1, 2, 3]], count=1.5), "count: must be a whole number, is 1.5"),
        (lambda c: c.snapshot(PlaneFilter(classes=["wal"])), "filter.classes: 'wal' is no class"),
        (lambda c: c.snapshot(PlaneFilter(epoch=-1)), "filter.epoch: must be 0 to 18446744073709551615, is -1"),
        (lambda c: c.snapshot(PlaneFilter(seen_since_utime=2**63)), "filter.seen_since_utime: must be -9223372036854775808 to"),
        (lambda c: c.plane(0), "plane_id: must be 1 to 18446744073709551615, is 0"),
        (lambda c: c.plane(2**64), "plane_id: must be 1 to 18446744073709551615, is 18446744073709551616"),
        (lambda c: c.cells(plane_ids=[-1]), "plane_ids: must be 1 to 18446744073709551615, is -1"),
        (lambda c: c.cells(plane_ids=[1.5]), "plane_ids: must be a whole number, is 1.5"),
        (lambda c: c.cast([[0, 0, 0]] * 2, [[1, 0, 0]] * 3), r"origins_m: must be of shape \(3, 3\) or fit it, is of shape \(2, 3\)"),
        (lambda c: c.region(Sphere("abc", 1.0)), r"centre_m: must be 3 numbers \(x, y, z\): could not convert"),
        (lambda c: c.region(Sphere([0.0, 0.0], 1.0)), r"centre_m: must have 3 numbers \(x, y, z\), has 2"),
    ],
)
def test_arguments_of_the_wrong_form(client: Client, ask, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        ask(client)


@pytest.mark.parametrize(
    "ask, words",
    [
        (lambda c: c.nearest([[np.nan, 0, 0]]), r"points\[0\].point_m: not every coordinate is a finite number"),
        (lambda c: c.cast([[0, 0, 0]], [[0, 0, 0]]), r"rays\[0\].direction: must not be zero"),
        (lambda c: c.region(Sphere([0, 0, 0], -1.0)), "sphere.radius_m: must be greater than 0"),
        (lambda c: c.snapshot(PlaneFilter(epoch=77)), "asked for is 77"),
        (lambda c: c.save(), "the service refused the request"),
    ],
)
def test_what_the_service_refuses(client: Client, ask, words: str) -> None:
    with pytest.raises(planemap.Refused, match=words):
        ask(client)
