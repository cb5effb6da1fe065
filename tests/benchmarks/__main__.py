"""Measures the figures and prints them against goal and record: ``python -m tests.benchmarks [--record]``.

``--real PYTHON`` sets the executors of an interpreter's rclpy beside the model's.
"""

import argparse
import os
import platform
import sys
import warnings
from dataclasses import replace

from cbtui.commands.options.changes import release_of
from tests.benchmarks import records
from tests.benchmarks.beside import ratios
from tests.benchmarks.figures import FIGURES, Figure, unit

_COLUMNS = "{:<42}{:>12}{:>8}{:>12}{:>9}{:>9}{:>9}{:>9}"


def main() -> None:
    """Measure what was asked for."""
    options = _parse()
    if options.real is not None:
        for python in options.real or [sys.executable]:
            print(f"{release_of(python)}: times what the model takes, load {os.getloadavg()[0]:.1f}")
            for name, ratio in ratios(python, options.rounds):
                print(f"{name:<42}{ratio:>8.1f}", flush=True)
        return
    known = records.read()
    machine = f"Python {platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores"
    print(f"{machine}, load {os.getloadavg()[0]:.1f}, u = {unit() * 1e9:.0f} ns")
    if known.machine:
        print(f"recorded: {known.machine}")
    print(_COLUMNS.format("", "unit", "goal", "rclpy", "before", "last", "now", "change"))
    measured: dict[str, float] = {}
    load: dict[str, float] = {}
    for figure in FIGURES:
        if all(word in figure.name for word in options.words):
            load[figure.name] = os.getloadavg()[0]
            measured[figure.name] = figure.median_of(options.rounds)
            print(row(figure, known, measured[figure.name]), flush=True)
    if options.record:
        measured, load = {**known.last, **measured}, {**known.load, **load}
        last = {figure.name: measured[figure.name] for figure in FIGURES if figure.name in measured}
        records.write(replace(known, last=last, load=load, machine=machine))


def row(figure: Figure, known: records.Records, now: float) -> str:
    """A figure's line of the table; one that misses its goal is marked."""
    before, last = known.before.get(figure.name), known.last.get(figure.name)
    change = "" if last is None else f"{now / last - 1:+.0%}"
    over = "" if now <= figure.goal else "  over"
    return (
        _COLUMNS.format(
            figure.name,
            figure.unit,
            f"{figure.goal:g}",
            figure.rclpy,
            _shown(before),
            _shown(last),
            _shown(now),
            change,
        )
        + over
    )


def _shown(value: float | None) -> str:
    return "" if value is None else f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("words", nargs="*", help="measure only figures whose name has all these words")
    parser.add_argument("--rounds", type=int, default=5, help="how often each is measured; the median counts")
    parser.add_argument("--record", action="store_true", help="keep what was measured as the last record")
    parser.add_argument(
        "--real",
        nargs="*",
        metavar="PYTHON",
        help="the executors of interpreters with ROS 2 (this one's) instead",
    )
    return parser.parse_args()


if __name__ == "__main__":
    warnings.simplefilter("error")
    main()
