"""Waits for programs that a line started, and completes their names."""

from __future__ import annotations

from collections.abc import Callable

from sim.packages import Package
from sim.shell.parser import Surroundings
from sim.shell.quoting import quoted
from sim.shell.session import ShellSession
from sim.shell.starter import OnExit, Running


def wait_for(session: ShellSession, start: Callable[[OnExit], Running]) -> int:
    """Start programs, wait for their end, also after Ctrl-C, and return the exit status."""
    signal = session.ground.signal()
    statuses: list[int] = []

    def on_exit(status: int) -> None:
        statuses.append(status)
        signal.set()

    running = start(on_exit)
    session.on_interrupt(running.interrupt)
    while not statuses:
        signal.wait(None)
    return statuses[0]


def package(session: ShellSession, name: str) -> Package:
    """Return a package by name; raise PackageError if there is none."""
    return session.starter.packages().package(name)


def known_packages(surroundings: Surroundings) -> list[str]:
    """Candidates for a package."""
    return list(map(quoted, surroundings.packages.names))


def known_executables(surroundings: Surroundings) -> list[str]:
    """Candidates for an executable of the package that was given first."""
    return list(map(quoted, surroundings.packages.package(surroundings.given[0]).executables))


def known_launch_files(surroundings: Surroundings) -> list[str]:
    """Candidates for a launch file of the package that was given first."""
    return list(map(quoted, surroundings.packages.package(surroundings.given[0]).launch_files))
