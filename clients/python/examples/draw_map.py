"""Draws the map of a running planemapd: a floor plan, the planes in space, and the surfaces that are nearest to a point.

    PYTHONPATH=build/release/python /usr/bin/python3 clients/python/examples/draw_map.py [--server HOST:PORT] [--out map.png]

The cells marked with %% are for editors that run them one by one, as in a notebook.
"""

# %% What is needed, and who is asked
import argparse

import matplotlib
import numpy as np

import planemap

arguments = argparse.ArgumentParser(description="Draw the map of a running planemapd.")
arguments.add_argument("--server", default="127.0.0.1:7670", metavar="HOST:PORT")
arguments.add_argument("--point", type=float, nargs=3, metavar=("X", "Y", "Z"), help="middle of the map")
arguments.add_argument("--out", metavar="FILE", help="write the picture instead of showing it")
options = arguments.parse_args()
if options.out:
    matplotlib.use("Agg")

from matplotlib import pyplot as plt  # noqa: E402  (the backend is chosen first)
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # noqa: E402

COLOURS = {"floor": "#8d7b68", "ceiling": "#b0b0b0", "wall": "#4878a8", "table": "#c8803c", "slope": "#7a9a4a"}



def one_ring(polygon: planemap.Polygon) -> np.ndarray:
    """Outline and holes as one ring, (n, 2): a cut there and back leads to each hole, which runs the other way round."""
    ring = polygon.outer
    for hole in polygon.holes:
        i, j = divmod(int(np.linalg.norm(ring[:, None] - hole[None], axis=2).argmin()), len(hole))
        ring = np.vstack([ring[: i + 1], np.roll(hole, -j, axis=0), hole[j], ring[i:]])
    return ring


try:
    robot = planemap.connect(options.server)
    map_ = robot.snapshot()
except planemap.PlanemapError as error:
    raise SystemExit(f"draw_map.py: {error}")
print(f"map {map_.version.epoch}, revision {map_.version.revision}: {len(map_.planes)} planes")

# %% The planes, largest first, and how well each is known
for plane in sorted(map_.planes, key=lambda plane: -plane.area_m2)[:10]:
    gradient = np.append(plane.centroid_m, 1.0)  # of n . x + d by (n, d), at the centroid
    sigma_mm = 1e3 * np.sqrt(gradient @ plane.covariance @ gradient)
    print(f"plane {plane.id:4d}  {plane.plane_class:8s} {plane.area_m2:7.2f} m2  +- {sigma_mm:.2f} mm")

# %% In space
figure = plt.figure(figsize=(12, 6))
space = figure.add_subplot(1, 2, 1, projection="3d")
corners = [np.zeros((1, 3))]
for plane in map_.planes:
    for polygon in plane.polygons:
        colour = COLOURS.get(plane.plane_class, "#909090")
        rings = [plane.to_world(ring) for ring in (polygon.outer, *polygon.holes)]
        corners.append(rings[0])
        face = plane.to_world(one_ring(polygon))
        space.add_collection3d(Poly3DCollection([face], facecolor=colour, edgecolor="none", alpha=0.5))
        closed = [np.vstack([ring, ring[:1]]) for ring in rings]
        space.add_collection3d(Line3DCollection(closed, color="black", linewidth=0.3))
low, high = np.vstack(corners).min(axis=0), np.vstack(corners).max(axis=0)
space.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]), xlabel="x, m", ylabel="y, m")
space.set_box_aspect(np.maximum(high - low, 0.1))
space.set(zlabel="z, m")
space.set_title(f"{len(map_.planes)} planes, revision {map_.version.revision}")

# %% From above, and what is nearest to a point
plan_axes = figure.add_subplot(1, 2, 2, aspect="equal", xlabel="m")
try:
    plan = robot.floorplan()
    for polygons, colour in ((plan.floor, "#e8e0d0"), (plan.free_floor, "#c8e0c0"), (plan.walls, "#404040")):
        for polygon in polygons:
            plan_axes.fill(*one_ring(polygon).T, facecolor=colour, linewidth=0.0)
    asked = np.array(options.point) if options.point else (low + high) / 2.0
    point = plan.axes @ (asked - plan.origin_m)
    near = robot.nearest([asked], sigma_m=0.01, count=3)
    for foot, distance, sigma in zip(near.surface_point_m[0], near.signed_distance_m[0], near.sigma_m[0]):
        if np.isfinite(distance):
            plan_axes.plot(*np.array([point, plan.axes @ (foot - plan.origin_m)]).T, "r-", linewidth=1)
            print(f"{distance:+.3f} m +- {1e3 * sigma:.1f} mm")
    plan_axes.plot(*point, "ro", markersize=4)
    plan_axes.set_title(f"free floor: {plan.free_area_m2:.1f} m2")
except planemap.Refused as error:  # no gravity, or no floor yet
    plan_axes.set_title("no floor plan")
    print(error)

# %% The picture
figure.tight_layout()
if options.out:
    figure.savefig(options.out, dpi=120)
    print(options.out)
else:
    plt.show()
