"""The example runs, and draws."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Callable

import numpy as np
import pytest
from matplotlib import colors, image

import planemap
from daemon import Daemon

EXAMPLE = Path(__file__).parents[3] / "clients/python/examples/draw_map.py"


def test_it_draws_the_map_with_its_holes(daemon: Daemon, client: planemap.Client, tmp_path: Path) -> None:
    picture = tmp_path / "map.png"
    run = subprocess.run(
        [sys.executable, EXAMPLE, "--server", daemon.server, "--out", picture], capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    assert "planes" in run.stdout and "+-" in run.stdout
    plan = client.floorplan()
    pixels, to_pixel = plan_of(picture, plan)
    free = (pixels == rgb(FREE)).all(axis=2)
    holes = [hole for polygon in plan.free_floor for hole in polygon.holes]
    largest = sorted(holes, key=lambda hole: float(np.prod(np.ptp(hole, axis=0))))[-2:]
    assert len(largest) == 2, "a map without holes shows nothing"
    for hole in largest:
        column, row = to_pixel(hole.mean(axis=0))
        assert not free[row, column], "a table is not drawn as free floor"
    # Holes that are filled would be free floor, too.
    assert free.mean() * np.prod(np.ptp(floor_corners(plan), axis=0)) == pytest.approx(plan.free_area_m2, rel=0.05)


FLOOR, FREE = "#e8e0d0", "#c8e0c0"


def rgb(colour: str) -> np.ndarray:
    return np.rint(255.0 * np.array(colors.to_rgb(colour))).astype(int)


def floor_corners(plan: planemap.FloorPlan) -> np.ndarray:
    return np.vstack([polygon.outer for polygon in plan.floor])


def plan_of(
    picture: Path, plan: planemap.FloorPlan
) -> tuple[np.ndarray, Callable[[np.ndarray], tuple[int, int]]]:
    """What is drawn of the floor, in colours of 0 to 255, and where in it a point of the plan is: column, row."""
    pixels = np.rint(255.0 * image.imread(picture)[:, :, :3]).astype(int)
    pixels = pixels[:, pixels.shape[1] // 2 :]
    drawn = np.any([(pixels == rgb(colour)).all(axis=2) for colour in (FLOOR, FREE)], axis=0)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    pixels = pixels[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    low, high = floor_corners(plan).min(axis=0), floor_corners(plan).max(axis=0)

    def to_pixel(point: np.ndarray) -> tuple[int, int]:
        x, y = (point - low) / (high - low)
        return int(x * pixels.shape[1]), int((1.0 - y) * pixels.shape[0])

    return pixels, to_pixel


def test_without_a_daemon_it_says_so() -> None:
    run = subprocess.run([sys.executable, EXAMPLE, "--server", "127.0.0.1:1"], capture_output=True, text=True)
    assert run.returncode == 1
    assert run.stderr.startswith("draw_map.py: no planemapd can be reached at 127.0.0.1:1")
