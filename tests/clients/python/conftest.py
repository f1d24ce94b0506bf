from __future__ import annotations

from typing import Iterator

import pytest

import planemap
from daemon import Daemon


@pytest.fixture(scope="session")
def daemon() -> Iterator[Daemon]:
    """One that has looked around; tests leave its map as it is."""
    with Daemon() as running:
        running.look_around()
        yield running


@pytest.fixture
def client(daemon: Daemon) -> Iterator[planemap.Client]:
    with planemap.connect(daemon.server, timeout_s=30.0) as connected:
        yield connected
