"""The example runs, and draws."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from daemon import Daemon

EXAMPLE = Path(__file__).parents[3] / "clients/python/examples/draw_map.py"


def test_it_draws_the_map(daemon: Daemon, tmp_path: Path) -> None:
    picture = tmp_path / "map.png"
    run = subprocess.run(
        [sys.executable, EXAMPLE, "--server", daemon.server, "--out", picture], capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    assert "planes" in run.stdout and "+-" in run.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_without_a_daemon_it_says_so() -> None:
    run = subprocess.run([sys.executable, EXAMPLE, "--server", "127.0.0.1:1"], capture_output=True, text=True)
    assert run.returncode == 1
    assert run.stderr.startswith("draw_map.py: no planemapd can be reached at 127.0.0.1:1")
