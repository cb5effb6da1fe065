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
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from lessons.catalogue import ROOT as LESSONS

PACKAGES = LESSONS.parent
"""The folder that contains cbtui's packages: a checkout, or that of all installed packages."""
_SYSTEM = (
    *("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/nix", "/etc/ld.so.cache", "/etc/alternatives"),
    *("/etc/localtime", "/etc/passwd", "/etc/group", "/etc/nsswitch.conf", "/etc/hosts"),
)
_KEPT = ("PATH", "LANG", "LANGUAGE", "LC_ALL", "LC_CTYPE", "TZ", "LD_LIBRARY_PATH", "CBTUI_MEMORY_GB")
_TMP_BYTES = 1 << 28
_PROBE = "import cbtui.engines.session, sim.engine.process"
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
    """Readable folders: Python, installed packages and the engine."""

    @property
    def import_path(self) -> list[str]:
        """``sys.path`` of programs, without the folder in which the grader was started."""
        return [
            entry
            for entry in sys.path
            if Path(entry) == PACKAGES or any(Path(entry).is_relative_to(each) for each in self.libraries)
        ]

    @classmethod
    def best(cls, hidden: Sequence[Path]) -> Self:
        """Return the strictest confinement that works on this machine; it is tried once."""
        bwrap = shutil.which("bwrap")
        if bwrap is None:
            return cls(None, missing="bwrap (of the package bubblewrap) is not installed")
        everywhere = dict.fromkeys(form for path in hidden for form in (path.absolute(), path.resolve()))
        confinement = cls(bwrap, tuple(everywhere))
        words = [*confinement._words(None), sys.executable, "-P", "-c", _PROBE]
        found = {"PYTHONPATH": os.pathsep.join(confinement.import_path)}
        try:
            tried = subprocess.run(
                words, capture_output=True, text=True, timeout=_PROBE_SECONDS, check=False, cwd="/", env=found
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return cls(None, missing=f"bwrap does not work here ({error})")
        if tried.returncode:
            said = tried.stderr.strip().rpartition("\n")[2]
            return cls(None, missing=f"bwrap does not work here ({said})")
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
        kept = {name: os.environ[name] for name in _KEPT if name in os.environ}
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


def _libraries() -> Iterator[Path]:
    yield from (Path(sys.base_prefix), Path(sys.prefix), PACKAGES / "cbtui", PACKAGES / "sim")
    given = [Path(entry).absolute() for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    yield from (path for path in given if path.resolve() != PACKAGES.resolve())
    yield from (path for path in map(Path, sys.path) if path.name in {"site-packages", "dist-packages"})
