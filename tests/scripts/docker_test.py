#!/usr/bin/env python3
"""Checks what stands in deploy/docker without an engine: what is copied exists, scripts know their options, each stage that
is meant exists, and the health check tells a good answer from a bad one."""

import http.server
import json
import re
import subprocess
import sys
import threading
import unittest
from pathlib import Path

import yaml

PROJECT = Path(__file__).resolve().parents[2]
DOCKER = PROJECT / "deploy/docker"
# Instructions, with their continued lines put together.
INSTRUCTIONS = [
    line for line in (DOCKER / "Dockerfile").read_text().replace("\\\n", " ").splitlines() if line and line[0] != "#"
]


def of_kind(kind: str) -> list[str]:
    return [line.removeprefix(kind).strip() for line in INSTRUCTIONS if line.startswith(kind + " ")]


def stages() -> list[str]:
    return [line.split(" AS ")[1] for line in of_kind("FROM")]


class Dockerfile(unittest.TestCase):
    def test_has_only_instructions_that_exist(self) -> None:
        known = {"FROM", "WORKDIR", "COPY", "RUN", "USER", "VOLUME", "HEALTHCHECK", "ENTRYPOINT", "CMD"}
        self.assertLessEqual({line.split()[0] for line in INSTRUCTIONS}, known)

    def test_what_is_copied_is_there(self) -> None:
        copies = [words.split() for words in of_kind("COPY")]
        self.assertGreaterEqual(len(copies), 2)
        for *sources, _ in copies:
            for source in sources:
                self.assertTrue((PROJECT / source).exists(), source)

    def test_the_scripts_know_the_options_that_they_are_given(self) -> None:
        calls = [run.split() for run in of_kind("RUN") if run.startswith("deploy/")]
        self.assertEqual(len(calls), 2)
        for script, *arguments in calls:
            usage = subprocess.run([PROJECT / script, "--help"], capture_output=True, text=True, check=True).stdout
            for argument in arguments:
                if not argument.startswith("/"):
                    self.assertRegex(usage, rf"(^|[\s|\[]){re.escape(argument)}\b", f"{script} {argument}")

    def test_the_images_install_the_packages_that_are_made(self) -> None:
        installed = set(re.findall(r"/packages/([a-z0-9-]+)_\*\.deb", "\n".join(of_kind("RUN"))))
        self.assertEqual(installed, {"planemapd", "planemap-tools"})
        made = (PROJECT / "deploy/packages/CMakeLists.txt").read_text()
        for package in installed:
            self.assertRegex(made, rf"planemap_package\(\w+ {package} ")

    def test_runs_what_the_unit_runs_and_not_as_root(self) -> None:
        unit = (PROJECT / "deploy/systemd/planemapd.service").read_text()
        command = json.loads(of_kind("ENTRYPOINT")[0]) + json.loads(of_kind("CMD")[0])
        self.assertIn("ExecStart=" + " ".join(command) + "\n", unit)
        self.assertEqual(of_kind("USER")[0], "planemap")
        self.assertEqual(of_kind("USER")[-1], "planemap")

    def test_the_health_check_tells_good_from_bad(self) -> None:
        check = of_kind("HEALTHCHECK")[0]
        command = json.loads(check[check.index("CMD ") + 4 :])

        class Answer(http.server.BaseHTTPRequestHandler):
            code = 200

            def do_GET(self) -> None:
                self.send_response(self.code if self.path == "/healthz" else 404)
                self.end_headers()

            def log_message(self, *_: object) -> None:
                pass

        with http.server.HTTPServer(("127.0.0.1", 0), Answer) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            # The port of the image is taken by whoever runs there: the test has one of its own.
            command = [word.replace("/7671", f"/{server.server_port}") for word in command]
            self.assertEqual(subprocess.run(command).returncode, 0)
            Answer.code = 503
            self.assertNotEqual(subprocess.run(command).returncode, 0)
            server.shutdown()
        self.assertNotEqual(subprocess.run(command, stderr=subprocess.DEVNULL).returncode, 0)


class Compose(unittest.TestCase):
    def setUp(self) -> None:
        self.services = yaml.safe_load((DOCKER / "compose.yaml").read_text())["services"]

    def test_builds_stages_that_exist(self) -> None:
        for name, service in self.services.items():
            build = service["build"]
            self.assertEqual((DOCKER / build["context"]).resolve(), PROJECT, name)
            self.assertTrue((PROJECT / build["dockerfile"]).is_file(), name)
            self.assertIn(build["target"], stages(), name)

    def test_keeps_the_map_and_has_the_units_limits(self) -> None:
        daemon = self.services["planemapd"]
        self.assertEqual(daemon["volumes"], ["map:/var/lib/planemap"])
        unit = (PROJECT / "deploy/systemd/planemapd.service").read_text()
        self.assertIn(f"LimitNOFILE={daemon['ulimits']['nofile']}\n", unit)
        self.assertIn(f"TimeoutStopSec={daemon['stop_grace_period'].removesuffix('s')}\n", unit)

    def test_lcm_goes_over_the_network_of_the_machine(self) -> None:
        for name, service in self.services.items():
            self.assertEqual(service["network_mode"], "host", name)


if __name__ == "__main__":
    sys.exit(unittest.main())
