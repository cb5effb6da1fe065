"""Other processes that try out what may crash: packages with C code in them, and the robot's world."""

import os
import signal
import subprocess
import sys
from typing import NamedTuple

_TIMEOUT = 20.0
"""Seconds after which a process that tries something out is given up."""

_IMPORTS = {"backports-zstd": "backports.zstd", "pyyaml": "yaml"}


def module_of(distribution: str) -> str:
    """Return what a distribution is imported as, which mostly is its own name."""
    name = distribution.lower().replace(".", "-").replace("_", "-")
    return _IMPORTS.get(name, name.replace("-", "_"))


class ProbeResult(NamedTuple):
    """What a process that tried something out said, and what it died of, "" if it ended by itself."""

    said: str
    complained: str
    code: int
    death: str


class ProbeProcess:
    """A process that was started to try something out. End it when it is not needed any more."""

    def __init__(self, module: str, *arguments: str) -> None:
        """Run a module with this process's own search path, whatever lies in the current folder."""
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
        """Import what cbtui depends on, one after another."""
        from cbtui.doctor.requirements import requirements

        names = [module_of(each.name) for each in requirements() if each.name != "pybullet"]
        return cls("cbtui.doctor.importing", *names)

    @classmethod
    def of_world(cls) -> "ProbeProcess":
        """Build the robot's world."""
        return cls("sim.robot.probe")

    def outcome(self) -> ProbeResult:
        """Wait for the end, but not for ever."""
        try:
            said, complained = self._process.communicate(timeout=_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._process.kill()
            said, complained = self._process.communicate()
            return ProbeResult(said, complained, -1, f"it did not come back within {_TIMEOUT:g} s")
        code = self._process.returncode
        return ProbeResult(
            said, complained, code, f"it crashed by {signal.Signals(-code).name}" if code < 0 else ""
        )

    def end(self) -> None:
        """End the process, if it has not ended. Safe to call twice."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.communicate()
