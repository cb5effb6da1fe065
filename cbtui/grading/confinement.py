"""Confines submissions with ``bwrap`` (bubblewrap).

In namespaces of its own a program has no other processes and no network but loopback. It can write to its own
copy and a private ``/tmp``, and read little more than Python, its packages and the engine.
"""

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Self

from lessons.catalogue import ROOT as LESSONS
from sim.engine.setup import RealRos

PACKAGES = LESSONS.parent
"""The folder that contains cbtui's packages: a checkout, or that of all installed packages."""
_SYSTEM = (
    *("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/nix", "/etc/ld.so.cache", "/etc/alternatives"),
    *("/etc/localtime", "/etc/passwd", "/etc/group", "/etc/nsswitch.conf", "/etc/hosts"),
)
_KEPT = ("PATH", "LANG", "LANGUAGE", "LC_ALL", "LC_CTYPE", "TZ", "LD_LIBRARY_PATH", "CBTUI_MEMORY_GB")
_KEPT_OF_ROS = (
    *("AMENT_PREFIX_PATH", "PYTHONPATH", "RMW_IMPLEMENTATION"),
    *("ROS_DISTRO", "ROS_PYTHON_VERSION", "ROS_VERSION"),
)
"""Variables of a terminal in which ROS is sourced."""
_TMP_BYTES = 1 << 28
_PROBE = "import cbtui.engines.session, sim.engine.process"
_PATH = "import sys; print(sys.prefix, sys.base_prefix, *sys.path, sep='\\n')"
_PROBE_SECONDS = 60
_SCRIPT = """#!/bin/sh
{bwrap} {python} "$@"
code=$?
# bwrap reports a signal as an exit code; the waiting process should see the signal itself.
[ $code -gt 128 ] && kill -$((code - 128)) $$
exit $code
"""


@dataclass(frozen=True)
class Confinement:
    """How submissions are confined: by ``bwrap``, or if that is None by a copy and a clean environment.

    ``missing`` says why ``bwrap`` is not used. ``hidden`` are files and folders that are masked.
    """

    bwrap: str | None
    hidden: tuple[Path, ...] = ()
    missing: str = ""

    libraries: tuple[Path, ...] = field(default_factory=lambda: tuple(_libraries()))
    """Readable folders: Python, installed packages, the engine, and ROS if that is another Python's."""

    kept: tuple[str, ...] = _KEPT
    """The variables that a program inherits."""

    @property
    def import_path(self) -> list[str]:
        """``sys.path`` of programs, without the folder in which the grader was started."""
        return [
            entry
            for entry in sys.path
            if Path(entry) == PACKAGES or any(Path(entry).is_relative_to(each) for each in self.libraries)
        ]

    @classmethod
    def best(cls, hidden: Sequence[Path], real: RealRos | None = None) -> Self:
        """Return the strictest confinement that works on this machine; it is tried once.

        ``real`` is the ROS 2 that programs are to run on.
        """
        loosest = cls(None)
        if real is not None and real.python:
            needed = (*loosest.libraries, *_libraries_of(real.python))
            loosest = replace(loosest, libraries=needed, kept=(*_KEPT, *_KEPT_OF_ROS))
        bwrap = shutil.which("bwrap")
        if bwrap is None:
            return replace(loosest, missing="bwrap (of the package bubblewrap) is not installed")
        everywhere = dict.fromkeys(form for path in hidden for form in (path.absolute(), path.resolve()))
        confinement = replace(loosest, bwrap=bwrap, hidden=tuple(everywhere))
        words = [*confinement._words(None), sys.executable, "-P", "-c", _PROBE]
        found = {"PYTHONPATH": os.pathsep.join(confinement.import_path)}
        try:
            tried = subprocess.run(
                words, capture_output=True, text=True, timeout=_PROBE_SECONDS, check=False, cwd="/", env=found
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return replace(loosest, missing=f"bwrap does not work here ({error})")
        if tried.returncode:
            said = tried.stderr.strip().rpartition("\n")[2]
            return replace(loosest, missing=f"bwrap does not work here ({said})")
        return confinement

    def launcher(self, folder: Path, script: Path) -> Path | None:
        """Write a script that starts Python confined to a folder; returns None without ``bwrap``."""
        if self.bwrap is None:
            return None
        text = _SCRIPT.format(bwrap=shlex.join(self._words(folder)), python=shlex.quote(sys.executable))
        script.write_text(text, encoding="utf-8")
        script.chmod(0o700)
        return script

    def environment(self, folder: Path) -> dict[str, str]:
        """The environment variables of a program that is confined to a folder."""
        kept = {name: os.environ[name] for name in self.kept if name in os.environ}
        temporary = {} if self.bwrap else {"TMPDIR": str(folder)}
        python = {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONNOUSERSITE": "1"}
        return {**kept, **temporary, **python, "HOME": str(folder)}

    def _words(self, folder: Path | None) -> Iterator[str]:
        assert self.bwrap is not None
        yield from (self.bwrap, "--unshare-all", "--die-with-parent", "--cap-drop", "ALL")
        yield from ("--proc", "/proc", "--dev", "/dev", "--size", str(_TMP_BYTES), "--tmpfs", "/tmp")
        known = (*map(Path, _SYSTEM), *self.libraries)
        seen = dict.fromkeys(path for each in known for path in (each, each.resolve()))
        for path in seen:
            yield from ("--ro-bind-try", str(path), str(path))
        for path in self.hidden:
            if any(path.is_relative_to(each) for each in seen) and path.exists():
                covered = ("--tmpfs",) if path.is_dir() else ("--ro-bind", os.devnull)
                yield from (*covered, str(path))
        if folder is not None:
            yield from ("--bind", str(folder), str(folder), "--chdir", str(folder))
        yield from ("--remount-ro", "/")


def _libraries_of(python: str) -> Iterator[Path]:
    """The folders that another Python needs, and those of the ROS that is sourced for it."""
    asked = subprocess.run([python, "-c", _PATH], capture_output=True, text=True, check=False)
    sourced = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    yield from (Path(each) for each in (*asked.stdout.splitlines(), *sourced) if each)


def _libraries() -> Iterator[Path]:
    yield from (Path(sys.base_prefix), Path(sys.prefix), PACKAGES / "cbtui", PACKAGES / "sim")
    given = [Path(entry).absolute() for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    yield from (path for path in given if path.resolve() != PACKAGES.resolve())
    yield from (path for path in map(Path, sys.path) if path.name in {"site-packages", "dist-packages"})
