"""A node on real ROS 2 is watched for an hour, and nothing grows: ``python -m tests.soak.watched``.

Its timer publishes 200 times a second to its own subscription. ``cbtui probe --keep 60`` starts it, ``cbtui
attach`` draws it in a terminal, and further consoles come and go. Every five seconds the memory, threads and
open files are looked at: of the node, of the process that keeps, and of the console, each with its engine. A
line now and then tells of them. ``--record`` keeps what came of it.
"""

import argparse
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.probes.on_path.cbtui_probe import FOLLOW
from sim.real.probe_link import sockets_in
from tests.soak.footprint import Footprint, footprint, growth
from tests.soak.interruption import until_interrupted
from tests.soak.results import FILE, Entry, record, today
from tests.support.processes import descendants
from tests.terminal.console import TerminalConsole, opened

_NODE = """
import rclpy
from std_msgs.msg import String

def tick():
    publisher.publish(String(data="x" * 100))

rclpy.init()
node = rclpy.create_node("counting")
publisher = node.create_publisher(String, "news", 10)
node.create_subscription(String, "news", lambda message: None, 10)
node.create_timer(1 / 200, tick)
rclpy.spin(node)
"""
_KEPT = 60
_EVERY = 5.0
"""Seconds from one look at the processes to the next."""
_NEWS = 60.0
_VISIT = 1.0
"""Seconds that a further console stays, after each look."""
_ALLOWED = {"memory": 10_000_000, "threads": 1, "files": 2}
"""By how much a process may grow from the middle of the time to its end."""
_PATIENCE = 60.0


class Watching:
    """What the processes had at each look, by what they are for."""

    def __init__(self) -> None:
        self.taken: dict[str, list[Footprint]] = {}
        self.gone: list[str] = []

    def look(self, processes: dict[str, list[int]]) -> None:
        """Look at processes; those of one name are taken together."""
        for name, numbers in processes.items():
            seen = [each for each in map(footprint, numbers) if each is not None]
            if numbers and len(seen) == len(numbers):
                self.taken.setdefault(name, []).append(Footprint(*map(sum, zip(*seen, strict=True))))
            elif name not in self.gone:
                self.gone.append(name)

    def troubles(self) -> Iterator[str]:
        """Say what is gone, and what has grown."""
        yield from (f"{name} has ended" for name in self.gone)
        for name, taken in self.taken.items():
            for field, allowed in _ALLOWED.items():
                grown = growth([getattr(each, field) for each in taken])
                if grown > allowed:
                    yield f"{name}: {field} grew by {grown:,.0f}"

    def line(self) -> str:
        """What each had at the last look."""
        return "; ".join(
            f"{name} {taken[-1].memory / 1e6:.1f} MB, {taken[-1].threads} threads, {taken[-1].files} files"
            for name, taken in self.taken.items()
        )

    def figures(self) -> Entry:
        """By how many megabytes each has grown from the middle third of the time to the last."""
        return {
            name: round(growth([each.memory for each in taken]) / 1e6, 2)
            for name, taken in self.taken.items()
        }


@contextmanager
def _watched(home: Path) -> Iterator[tuple["subprocess.Popen[bytes]", Path]]:
    """A node that ``cbtui probe --keep`` runs, and its probe's socket."""
    (home / "counting.py").write_text(_NODE, encoding="utf-8")
    words = ["probe", "--keep", str(_KEPT), "--", sys.executable, "counting.py"]
    with subprocess.Popen([sys.executable, "-m", "cbtui", *words], cwd=home) as keeper:
        try:
            end = time.monotonic() + _PATIENCE
            while not (sockets := sockets_in(home)):
                assert time.monotonic() < end, "the node does not start"
                time.sleep(0.1)
            yield keeper, sockets[0]
        finally:
            keeper.terminate()
            keeper.wait()


def _visit(place: Path, console: TerminalConsole) -> None:
    """Be a further console for a moment, one that is too slow to read what it is told."""
    with socket.socket(socket.AF_UNIX) as visitor:
        visitor.connect(str(place))
        visitor.sendall(FOLLOW)
        console.read_for(_VISIT)


def soak(minutes: float, watching: Watching) -> float:
    """Watch a node for so long, or until the soak is told to end; return the minutes that it was."""
    began = told = time.monotonic()
    with TemporaryDirectory() as place, until_interrupted():
        home = Path(place)
        os.environ.update(
            XDG_RUNTIME_DIR=place, ROS_DOMAIN_ID="78", ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST"
        )
        with _watched(home) as (keeper, probe), opened(140, 40, home, "attach") as console:
            node = int(probe.stem)
            began = told = time.monotonic()
            while time.monotonic() < began + 60 * minutes and not watching.gone:
                console.read_for(_EVERY)
                console.drawn = b""
                _visit(probe, console)
                keeping = [keeper.pid, *(each for each in descendants(keeper.pid) if each != node)]
                drawing = [console.process.pid, *console.started()]
                watching.look({"node": [node], "keeper": keeping, "console": drawing})
                if time.monotonic() > told + _NEWS:
                    told = time.monotonic()
                    _say(f"{(told - began) / 60:.0f} min: {watching.line()}")
    return (time.monotonic() - began) / 60


def main() -> int:
    """Watch, and tell what came of it; returns the exit code: 0 all well, 1 something has grown or ended."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak.watched", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0, help="how long (%(default)s)")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    options = parser.parse_args()
    watching = Watching()
    minutes = soak(options.minutes, watching)
    troubles = list(watching.troubles())
    for trouble in troubles:
        _say(trouble)
    figures = {"minutes": round(minutes, 1), **watching.figures(), "troubles": len(troubles)}
    sys.stdout.write(f"megabytes added: {figures}\n")
    if options.record:
        record("watched", "node", {"date": today(), **figures})
    return 1 if troubles else 0


def _say(line: str) -> None:
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()


if __name__ == "__main__":
    sys.exit(main())
