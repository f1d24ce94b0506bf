"""A real planemapd on a port of its own, and a simulated Kinect before it."""

from __future__ import annotations

import os
import subprocess
import threading
import time
from pathlib import Path

import planemap

BIN = Path(os.environ["PLANEMAP_BIN_DIR"])
LCM_URL = "udpm://239.255.76.67:7667?ttl=0"
PATIENCE_S = 60.0


class Daemon:
    """The process; `server` is where it listens."""

    def __init__(self, *settings: str, server: str = "127.0.0.1:0") -> None:
        command = [str(BIN / "planemapd"), "--lcm-url", LCM_URL]
        for setting in (f"grpc.listen={server}", "http.listen=127.0.0.1:0", "map.gravity=[0, 0, -1]", *settings):
            command += ["--set", setting]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        self.server = self._read_server()

    def _read_server(self) -> str:
        assert self.process.stderr is not None
        said = ""
        for line in self.process.stderr:
            said += line
            if "gRPC on " in line:
                threading.Thread(target=self.process.stderr.read, daemon=True).start()  # so that it never waits for us
                return line.split("gRPC on ")[1].split()[0]
        raise RuntimeError("planemapd did not come up:\n" + said)

    def stop(self) -> None:
        self.process.terminate()
        self.process.wait(PATIENCE_S)

    def __enter__(self) -> Daemon:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def look_around(self, frames: int = 30) -> None:
        """Lets a Kinect drive through an apartment, and waits until all that it saw is mapped or dropped."""
        with planemap.connect(self.server) as client, client.watch() as watch:
            watch.next(PATIENCE_S)
            before = client.status().counters["scans.received"]
            subprocess.run(
                [BIN / "planemap-kinect-bridge", "--simulate", "apartment", "--seed", "5", "--frames", str(frames),
                 "--rate", "10", "--quiet", "--lcm-url", LCM_URL],
                check=True,
                timeout=PATIENCE_S,
            )
            deadline = time.monotonic() + PATIENCE_S
            while time.monotonic() < deadline:
                status = client.status()
                counters = status.counters
                is_over = counters["scans.received"] >= before + frames and counters["scans.waiting"] == 0
                if is_over and client.snapshot().version == status.version:  # answers may be of a map just before
                    return
                watch.next(0.05)
            raise RuntimeError(f"not all scans came: {counters}")
