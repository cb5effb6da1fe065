"""Examines the system, Python, the packages that cbtui depends on, and the robot's physics."""

import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version

from packaging.requirements import Requirement

from cbtui.doctor.examination import Examination, fault, note, well
from cbtui.doctor.probes import ProbeProcess, module_of
from cbtui.doctor.requirements import PHYSICS, requirements
from cbtui.text.installing import install_command

_OLDEST = (3, 11)


def system(platform: str, release: str) -> Examination:
    """Examine the operating system: ``sys.platform``, and the kernel's own name of its version."""
    if platform == "linux":
        return well("system", f"Linux {release}{' in WSL' if 'microsoft' in release.lower() else ''}")
    if platform == "darwin":
        remedy = "if something fails, use the container of .devcontainer/Dockerfile"
        return note("system", f"macOS {release}: cbtui runs without what Linux alone has, untested", remedy)
    return fault("system", f"{platform}, on which no run starts", "on Windows use WSL: wsl --install")


def python(running: tuple[int, ...]) -> Examination:
    """Examine the version of Python."""
    said = ".".join(map(str, running))
    if running < _OLDEST:
        return fault("Python", said, "cbtui needs Python 3.11 or newer; install it into a venv of one")
    return well("Python", f"{said} ({sys.executable})")


def dependencies(importing: ProbeProcess) -> Iterator[Examination]:
    """Examine whether each package is installed in a supported version and can be imported."""
    needed = [each for each in requirements() if each.name not in PHYSICS]
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


def _is_installed(name: str) -> bool:
    try:
        return bool(version(name))
    except PackageNotFoundError:
        return False


def physics(world: ProbeProcess, *, installed: bool) -> Examination:
    """Examine what moves the robot; ``installed`` tells whether there is a module ``pybullet``."""
    outcome = world.outcome()
    wheel = next((each for each in requirements() if each.name in PHYSICS), None)
    install = "" if wheel is None else install_command("--force-reinstall", "--no-deps", wheel.name)
    if outcome.code != 0:
        why = outcome.death or (outcome.complained.strip().splitlines() or ["it failed"])[-1]
        remedy = f"give --physics numpy, or reinstall it: {install}" if install else "give --physics numpy"
        return fault("physics", f"PyBullet builds no world ({why})", remedy)
    if len(both := [name for name in sorted(PHYSICS) if _is_installed(name)]) > 1:
        return note(
            "physics",
            f"{' and '.join(both)} are both installed, and have overwritten each other",
            f"uninstall both, then {install or 'install one'}",
        )
    if installed:
        return well("physics", "PyBullet moves the robot, and draws the camera's pictures")
    found = "the numpy model moves the robot, without a camera"
    if wheel is None:
        return note(
            "physics", f"{found}: PyBullet has no wheel here", "use Python 3.11 to 3.13 on a PC or Mac"
        )
    return note("physics", f"{found}: PyBullet is not installed", f"install it with {install}")
