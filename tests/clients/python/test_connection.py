"""Addresses, servers that are not there, TLS, tokens."""

from __future__ import annotations

import subprocess
import threading
import time
from concurrent import futures
from pathlib import Path

import grpc
import numpy as np
import pytest

import planemap
from daemon import Daemon
from planemap.v1 import map_pb2, planemap_service_pb2_grpc, queries_pb2

READER, ADMIN = "reader-0123456789abcdef", "admin-0123456789abcdef"


@pytest.mark.parametrize("server", ["", ":7670", "robot:", "robot:0", "robot:65536", "a b", "http://robot:7670"])
def test_addresses_that_are_none(server: str) -> None:
    with pytest.raises(ValueError, match="is no address of a server: it must be HOST, HOST:PORT or"):
        planemap.connect(server)


def test_options_that_cannot_be_used(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="token: would go to robot:7670 for everybody to read"):
        planemap.connect("robot", token=READER)
    planemap.connect("robot", token=READER, tls=True).close()
    with pytest.raises(ValueError, match="token: must be of printable ASCII characters"):
        planemap.connect(token="two words")
    with pytest.raises(ValueError, match="certificate_file, key_file: each needs the other"):
        planemap.connect(key_file=tmp_path / "key")
    with pytest.raises(FileNotFoundError, match="missing"):
        planemap.connect(ca_file=tmp_path / "missing")
    (tmp_path / "no.pem").write_text("nothing")
    with pytest.raises(ValueError, match="ca_file: .*no.pem: is not in PEM"):
        planemap.connect(ca_file=tmp_path / "no.pem")
    with pytest.raises(ValueError, match="timeout_s: must be greater than 0, is 0"):
        planemap.connect(timeout_s=0.0)


def test_nobody_there_is_said_at_once() -> None:
    with planemap.connect("127.0.0.1:1") as client:
        with pytest.raises(planemap.Unreachable, match=r"no planemapd can be reached at 127.0.0.1:1 .*is planemapd run"):
            client.status()
        with client.watch() as watch, pytest.raises(planemap.Unreachable, match="no planemapd can be reached"):
            watch.next(0.5)
        with client.watch() as watch, pytest.raises(LookupError, match="there is no map yet"):
            watch.map


def test_tokens_open_what_they_are_for(tmp_path: Path) -> None:
    (tmp_path / "tokens").write_text(f"read {READER}\nadmin {ADMIN}\n")
    with Daemon(f"grpc.token_file={tmp_path / 'tokens'}") as daemon:
        with planemap.connect(daemon.server) as client:
            with pytest.raises(planemap.Denied, match=r"needs a token of scope read.*connect\(..., token=...\)"):
                client.status()
            with client.watch() as watch, pytest.raises(planemap.Denied):
                watch.next(10.0)
        with planemap.connect(daemon.server, token=READER) as client:
            epoch = client.status().version.epoch
            assert client.snapshot().version.epoch == epoch
            with client.watch() as watch:
                assert watch.next(10.0).new_map
            with pytest.raises(planemap.Denied, match="the token is of scope read, this call needs admin"):
                client.pause()
        with planemap.connect(daemon.server, token=ADMIN) as client:
            client.pause()
            assert client.status().paused
            client.resume()
            assert not client.status().paused
            assert client.reset() > epoch


def openssl(folder: Path, *arguments: str) -> None:
    subprocess.run(["openssl", *arguments], cwd=folder, check=True, capture_output=True)


def test_tls_is_spoken_with_whom_the_authority_signed(tmp_path: Path) -> None:
    key = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
    for name in ("ca", "other"):
        openssl(tmp_path, "req", "-x509", *key, "-days", "2", "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out",
                f"{name}.crt")
    (tmp_path / "names").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
    openssl(tmp_path, "req", *key, "-subj", "/CN=server", "-keyout", "server.key", "-out", "server.csr")
    openssl(tmp_path, "x509", "-req", "-days", "2", "-in", "server.csr", "-CA", "ca.crt", "-CAkey", "ca.key",
            "-CAcreateserial", "-extfile", "names", "-out", "server.crt")
    settings = f"grpc.tls_certificate={tmp_path / 'server.crt'}", f"grpc.tls_key={tmp_path / 'server.key'}"
    with Daemon(*settings) as daemon:
        with planemap.connect(daemon.server, ca_file=tmp_path / "ca.crt") as client:
            assert client.status().version.epoch > 0
        with planemap.connect(daemon.server, ca_file=tmp_path / "other.crt") as client:
            with pytest.raises(planemap.Unreachable, match="over TLS"):
                client.status()
        with planemap.connect(daemon.server) as client:
            with pytest.raises(planemap.Unreachable, match="if it speaks TLS, name the authority"):
                client.status()


class Fake(planemap_service_pb2_grpc.PlaneMapServicer):
    """Says what it is told to: for what a real server does not do."""

    def __init__(self) -> None:
        self.pages: list[map_pb2.SnapshotPage] = []
        self.released = threading.Event()
        self.is_holding = False
        self.newest = map_pb2.MapVersion(epoch=7, revision=1, utime=10)
        self.is_keeping = True
        self.batches: list[tuple[int, int]] = []

    def NearestPlanes(self, request, context):  # noqa: N802
        if request.HasField("map") and not self.is_keeping:
            self.is_keeping = True
            context.abort(grpc.StatusCode.ABORTED, "map: is not kept any more: ask all anew")
        version = request.map if request.HasField("map") else self.newest
        self.batches.append((len(request.points), version.revision))
        self.newest = map_pb2.MapVersion(epoch=7, revision=self.newest.revision + 1, utime=self.newest.utime + 33333)
        return queries_pb2.NearestPlanesResponse(
            map=version, results=[queries_pb2.NearPlanes() for _ in request.points]
        )

    def GetSnapshot(self, request, context):  # noqa: N802
        yield from self.pages
        if self.is_holding:
            self.released.wait(30.0)

    def Watch(self, request, context):  # noqa: N802
        self.released.wait(30.0)
        return iter(())


@pytest.fixture
def fake():
    server = grpc.server(futures.ThreadPoolExecutor(4))
    servicer = Fake()
    planemap_service_pb2_grpc.add_PlaneMapServicer_to_server(servicer, server)
    servicer.server = f"127.0.0.1:{server.add_insecure_port('127.0.0.1:0')}"
    server.start()
    yield servicer
    servicer.released.set()
    server.stop(0).wait(10.0)


def page(number: int, last: bool = False, revision: int = 3) -> map_pb2.SnapshotPage:
    message = map_pb2.SnapshotPage(frame="world", cell_size_m=0.1, page=number, last=last)
    message.map.epoch, message.map.revision = 7, revision
    return message


def test_answers_that_are_not_sound_are_not_taken(fake) -> None:
    flawed = page(0, last=True)
    flawed.planes.add(id=4).covariance.extend([0.0] * 9)
    with planemap.connect(fake.server) as client:
        fake.pages = [page(0), page(1, last=True)]
        assert client.snapshot().planes == []
        for pages in ([page(1)], [page(0)], [page(0), page(1, True, 9)], [page(0, True), page(1, True)], [flawed], []):
            fake.pages = pages
            with pytest.raises(planemap.MalformedAnswer, match="the service's answer cannot be used: "):
                client.snapshot()


def test_many_points_are_answered_by_one_map_however_fast_it_changes(fake) -> None:
    points = np.zeros((12000, 3))
    with planemap.connect(fake.server) as client:
        near = client.nearest(points)
        assert near.version == planemap.Version(7, 1, 10)
        assert near.plane_id.shape[0] == 12000
        assert fake.batches == [(5000, 1), (5000, 1), (2000, 1)]
        fake.batches, fake.is_keeping = [], False
        assert client.nearest(points).version.revision == 5
        assert fake.batches == [(5000, 4), (5000, 5), (5000, 5), (2000, 5)], "once from the beginning"


def test_an_answer_in_part_is_said_to_be(fake) -> None:
    fake.pages, fake.is_holding = [page(0)], True
    with planemap.connect(fake.server, timeout_s=0.3) as client:
        with pytest.raises(planemap.AnswerIncomplete, match=r"in part only \(1 pages\); then no answer came from"):
            client.snapshot()


def test_a_silent_server_is_said_to_be(fake) -> None:
    with planemap.connect(fake.server) as client, client.watch(silent_after_s=0.3) as watch:
        begin = time.monotonic()
        for _ in range(2):
            with pytest.raises(planemap.Unreachable, match=f"nothing was heard .* at {fake.server} for 0.3 s"):
                watch.next(10.0)
        assert time.monotonic() - begin < 5.0
