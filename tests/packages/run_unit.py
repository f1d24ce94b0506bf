#!/usr/bin/env python3
"""Runs a service as its systemd unit says, where there is no systemd: run_unit.py UNIT COMMAND...

Starts ExecStart with the unit's user, group, working directory, umask, limit of files, NoNewPrivileges and a socket for
notifications; once the service says READY=1 runs COMMAND; then ends the service by SIGTERM. Passes (0) where the service
became ready in time, fed its watchdog, ran until it was told to end, said STOPPING=1 and ended with 0, and COMMAND passed.
"""

import configparser
import ctypes
import os
import pwd
import resource
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PR_SET_NO_NEW_PRIVS = 38


def fail(message: str) -> None:
    sys.exit(f"run_unit.py: {message}")


def read_unit(path: str) -> configparser.SectionProxy:
    unit = configparser.ConfigParser(strict=False, interpolation=None)
    unit.optionxform = str  # type: ignore[assignment]
    unit.read_string(Path(path).read_text())
    return unit["Service"]


class Notifications:
    """The messages of the service, as systemd would get them."""

    def __init__(self, folder: str, uid: int) -> None:
        self.path = f"{folder}/notify"
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(self.path)
        os.chown(self.path, uid, -1)
        self.lines: list[str] = []

    def wait_for(self, line: str, timeout_s: float, service: "subprocess.Popen[bytes]") -> None:
        deadline = time.monotonic() + timeout_s
        while line not in self.lines:
            if time.monotonic() > deadline:
                fail(f"the service did not say {line} within {timeout_s:g} s; it said {self.lines}")
            self._socket.settimeout(0.2)
            try:
                self.lines += self._socket.recv(65536).decode().splitlines()
            except TimeoutError:
                if service.poll() is not None:
                    fail(f"the service ended with {service.returncode} before it said {line}")


def main() -> int:
    unit = read_unit(sys.argv[1])
    user = pwd.getpwnam(unit["User"])
    files = int(unit["LimitNOFILE"])
    watchdog_s = float(unit["WatchdogSec"])

    def restrict() -> None:
        resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))
        if unit["NoNewPrivileges"] == "yes":
            ctypes.CDLL(None).prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)

    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        notifications = Notifications(folder, user.pw_uid)
        environment = {
            "PATH": "/usr/bin:/bin",
            "NOTIFY_SOCKET": notifications.path,
            "WATCHDOG_USEC": str(int(watchdog_s * 1e6)),
        }
        log = Path(folder, "log")
        with log.open("wb") as stderr:
            service = subprocess.Popen(
                shlex.split(unit["ExecStart"]), stderr=stderr, env=environment, cwd=unit["WorkingDirectory"],
                user=user.pw_uid, group=unit["Group"], extra_groups=[], umask=int(unit["UMask"], 8), preexec_fn=restrict)
        passed = False
        try:
            notifications.wait_for("READY=1", float(unit["TimeoutStartSec"]), service)
            command = subprocess.run(sys.argv[2:], env={**os.environ, "SERVICE_PID": str(service.pid)})
            notifications.wait_for("WATCHDOG=1", watchdog_s, service)
            service.send_signal(signal.SIGTERM)
            notifications.wait_for("STOPPING=1", float(unit["TimeoutStopSec"]), service)
            code = service.wait(float(unit["TimeoutStopSec"]))
            if code != 0:
                fail(f"the service ended with {code}")
            passed = command.returncode == 0
        finally:
            if service.poll() is None:
                service.kill()
                service.wait()
            if not passed:
                print("The last that the service said:", *log.read_text().splitlines()[-20:], sep="\n  ", file=sys.stderr)
    return command.returncode


if __name__ == "__main__":
    sys.exit(main())
