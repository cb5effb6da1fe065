"""Examines what cbtui needs of a machine, one function per requirement."""

import os
import platform
import shutil
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

from cbtui.doctor.engines import engine
from cbtui.doctor.examination import Examination
from cbtui.doctor.extras import browser, editor, grading, ros
from cbtui.doctor.files import configuration, folders, lessons_found, progress
from cbtui.doctor.packages import dependencies, physics, python, system
from cbtui.doctor.probes import ProbeProcess
from cbtui.doctor.terminal import TerminalFacts, screen


def examinations(charset: str, config: str | None = None) -> Iterator[Examination]:
    """Yield the examinations one by one.

    ``charset`` is the console's, ``config`` a configuration in place of the user's own. Takes about two
    seconds, as an engine and other processes are started. Nothing is changed.
    """
    importing, world = ProbeProcess.of_imports(), ProbeProcess.of_world()
    try:
        yield system(sys.platform, platform.release())
        yield python(sys.version_info[:3])
        yield from dependencies(importing)
        yield physics(world, installed=find_spec("pybullet") is not None)
        yield engine()
        yield from lessons_found()
        yield from screen(TerminalFacts(os.environ, charset, _size()))
        yield from folders(Path.cwd)
        yield from configuration(None if config is None else Path(config))
        yield progress()
        yield editor(os.environ)
        yield browser()
        yield grading(shutil.which("bwrap"))
        yield from ros(os.environ)
    finally:
        importing.end()
        world.end()


def _size() -> os.terminal_size | None:
    terminal = all(stream.isatty() for stream in (sys.stdin, sys.stdout, sys.stderr))
    return shutil.get_terminal_size() if terminal else None
