"""Examines Python, the packages that cbtui depends on, and PyBullet."""

import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version

from packaging.requirements import Requirement

from cbtui.doctor.examination import Examination, fault, note, well
from cbtui.doctor.probes import ProbeProcess, module_of
from cbtui.doctor.requirements import requirements
from cbtui.text.installing import install_command

_OLDEST = (3, 11)
_NEWEST_WITH_WHEEL = (3, 11)
_MACHINE_WITH_WHEEL = "linux-x86_64"
"""The platform that PyBullet has wheels for."""


def python(running: tuple[int, ...]) -> Examination:
    """Examine the version of Python."""
    said = ".".join(map(str, running))
    if running < _OLDEST:
        return fault("Python", said, "cbtui needs Python 3.11 or newer; install it into a venv of one")
    return well("Python", f"{said} ({sys.executable})")


def dependencies(importing: ProbeProcess) -> Iterator[Examination]:
    """Examine whether each package is installed in a supported version and can be imported."""
    needed = [each for each in requirements() if each.name != "pybullet"]
    if not needed:
        yield note(
            "packages", "cbtui is not installed", "install it with pip install . to have them looked at"
        )
        return
    broken = _broken(importing)
    found = [verdict for each in needed if (verdict := _package(each, broken)) is not None]
    yield from found
    if not found:
        yield well("packages", f"{len(needed)}, each in a version that fits")


def _package(needed: Requirement, broken: Mapping[str, str]) -> Examination | None:
    name, wanted = needed.name, f"{needed.name}{needed.specifier}"
    remedy = f"install it with {install_command(wanted)}"
    try:
        installed = version(name)
    except PackageNotFoundError:
        return fault(name, "is not installed", remedy)
    if not needed.specifier.contains(installed, prereleases=True):
        return fault(name, f"is {installed}, and cbtui needs {needed.specifier}", remedy)
    if (why := broken.get(module_of(name))) is not None:
        remedy = f"install it again with {install_command('--force-reinstall', '--no-deps', wanted)}"
        return fault(name, f"{installed} cannot be imported ({why})", remedy)
    return None


def _broken(importing: ProbeProcess) -> dict[str, str]:
    """The modules that cannot be imported, with the reason."""
    outcome = importing.outcome()
    broken, begun = {}, ""
    for line in outcome.said.splitlines():
        word, _, rest = line.partition(" ")
        if word == "bad":
            name, _, why = rest.partition(": ")
            broken[name] = why
        begun = rest if word == "begin" else ""
    if begun:
        broken[begun] = outcome.death or "the process ended"
    return broken


def bullet(world: ProbeProcess, running: tuple[int, ...], machine: str) -> Examination:
    """Examine whether PyBullet, the robot's physics, builds a world.

    ``machine`` is the result of ``sysconfig.get_platform``.
    """
    outcome = world.outcome()
    if outcome.code == 0:
        return well("PyBullet", "builds the robot's world")
    why = outcome.death or (outcome.complained.strip().splitlines() or ["it failed"])[-1]
    return fault("PyBullet", f"builds no world ({why})", _bullet_remedy(running, machine))


def _bullet_remedy(running: tuple[int, ...], machine: str) -> str:
    install = install_command("--force-reinstall", "--no-deps", "pybullet")
    if running <= _NEWEST_WITH_WHEEL and machine == _MACHINE_WITH_WHEEL:
        return f"install it with {install}"
    instead = "use Python 3.11, which has a ready-made wheel, or " if machine == _MACHINE_WITH_WHEEL else ""
    return (
        f"{instead}have a C++ compiler and Python's headers (apt install g++ python3-dev) and let it be "
        f"built, for ten minutes or more: {install}"
    )
