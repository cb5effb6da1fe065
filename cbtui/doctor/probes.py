"""Processes that try out code that may crash: packages with C code, and the robot's world."""

import os
import signal
import subprocess
import sys
from typing import NamedTuple

_TIMEOUT = 60.0
"""Limit of a probe process in seconds."""

_IMPORTS = {"backports-zstd": "backports.zstd", "pyyaml": "yaml"}


def module_of(distribution: str) -> str:
    """Return the module name of a distribution."""
    name = distribution.lower().replace(".", "-").replace("_", "-")
    return _IMPORTS.get(name, name.replace("-", "_"))


class ProbeResult(NamedTuple):
    """The output of a probe process, and why it died, "" if it exited."""

    said: str
    complained: str
    code: int
    death: str


class ProbeProcess:
    """A process that tries something out; ``end`` it when it is no longer needed."""

    def __init__(self, module: str, *arguments: str) -> None:
        """Run a module with this process's ``sys.path``, ignoring the current folder."""
        path = os.pathsep.join(filter(None, sys.path))
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, *arguments],
            env={**os.environ, "PYTHONPATH": path, "PYTHONIOENCODING": "utf-8"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
        )

    @classmethod
    def of_imports(cls) -> "ProbeProcess":
        """Import the packages that cbtui depends on."""
        from cbtui.doctor.requirements import PHYSICS, requirements

        names = [module_of(each.name) for each in requirements() if each.name not in PHYSICS]
        return cls("cbtui.doctor.importing", *names)

    @classmethod
    def of_world(cls) -> "ProbeProcess":
        """Build the robot's world."""
        return cls("sim.robot.probe")

    def outcome(self) -> ProbeResult:
        """Wait for the process; it is killed after a timeout."""
        try:
            said, complained = self._process.communicate(timeout=_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._process.kill()
            said, complained = self._process.communicate()
            return ProbeResult(said, complained, -1, f"it did not come back within {_TIMEOUT:g} s")
        code = self._process.returncode
        return ProbeResult(
            said, complained, code, f"it crashed with {signal.Signals(-code).name}" if code < 0 else ""
        )

    def end(self) -> None:
        """Kill the process if it still runs. Idempotent."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.communicate()
