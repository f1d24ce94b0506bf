"""A mirror of a map that is being made."""

from __future__ import annotations

import queue
import threading
import time

import planemap
from daemon import PATIENCE_S, Daemon


HEALS_WITHIN_S = 3.0  # from when the new daemon listens; by gRPC's own ways of connecting again it took up to eight


def next_change(watch: planemap.Watch) -> planemap.Change:
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        try:
            change = watch.next(1.0)
        except planemap.Unreachable:
            continue
        if change:
            return change
    raise AssertionError("no change came")


def same(one: planemap.Map, other: planemap.Map) -> bool:
    return one.version == other.version and [(p.id, p.revision) for p in one.planes] == [
        (p.id, p.revision) for p in other.planes
    ]


def test_the_mirror_keeps_up_with_the_map_and_a_restart() -> None:
    daemon = Daemon()
    try:
        client = planemap.connect(daemon.server, timeout_s=30.0)
        watch = client.watch()
        first = next_change(watch)
        assert first.new_map and not watch.map.planes

        kinect = threading.Thread(target=daemon.look_around)
        kinect.start()
        seen: set[int] = set()
        changes = 0
        while kinect.is_alive() or watch.map.version.revision < client.snapshot().version.revision:
            change = watch.next(0.2)
            if change:
                changes += 1
                seen |= set(change.added)
                seen -= {gone.id for gone in change.removed}
                assert seen == {plane.id for plane in watch.map.planes}
        kinect.join()
        assert changes > 3
        assert len(watch.map.planes) > 5
        assert same(watch.map, client.snapshot())

        daemon.stop()
        assert watch.map.planes, "the mirror stays"
        daemon = Daemon(server=daemon.server)
        change = next_change(watch)
        assert change.new_map
        assert change.version.epoch > first.version.epoch
        assert not watch.map.planes
        watch.close()
        client.close()
    finally:
        daemon.stop()


def test_who_sits_in_next_goes_on_with_each_restarted_daemon() -> None:
    daemon = Daemon()
    client = planemap.connect(daemon.server)
    news: queue.Queue[planemap.Change | Exception | None] = queue.Queue()

    def sit() -> None:
        try:
            for change in client.watch():
                news.put(change)
            news.put(None)
        except Exception as error:
            news.put(error)

    sitter = threading.Thread(target=sit)
    sitter.start()
    epochs: list[int] = []
    try:
        for _ in range(4):
            begin = time.monotonic()
            change = news.get(timeout=PATIENCE_S)
            assert isinstance(change, planemap.Change), change
            assert time.monotonic() - begin < HEALS_WITHIN_S
            assert change.new_map
            epochs.append(change.version.epoch)
            assert client.status().version.epoch == epochs[-1], "other questions are answered again, too"
            daemon.stop()
            daemon = Daemon(server=daemon.server)
        assert epochs == sorted(set(epochs))
        assert isinstance(news.get(timeout=PATIENCE_S), planemap.Change)
        client.close()
        assert news.get(timeout=PATIENCE_S) is None, "the watch ends with its client"
    finally:
        daemon.stop()
        sitter.join(PATIENCE_S)
    assert not sitter.is_alive()


def test_iterating_gives_each_change(client: planemap.Client) -> None:
    with client.watch() as watch:
        for change in watch:
            assert change.new_map
            assert same(watch.map, client.snapshot())
            break


def test_a_watch_can_be_polled(client: planemap.Client) -> None:
    with client.watch() as watch:
        deadline = time.monotonic() + PATIENCE_S
        change = None
        while not change and time.monotonic() < deadline:
            try:
                change = watch.next(0.0)
            except planemap.Unreachable:
                pass
        assert change and change.new_map
