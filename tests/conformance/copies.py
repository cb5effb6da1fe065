"""Runs programs in copies of a process that has imported rclpy; a script, in any Python that has one.

Standard input has a line of JSON for each program: its file, one for its output, and the ``Steering`` of its
threads, or null for first come, first served. The output is printed when the program has ended. With the
arguments ``model DISTRO`` rclpy is the model on virtual time. A program finds among its globals ``moments``,
at which anything fell due on the model (nanoseconds), and ``choices``, as ``Steered.made``; or ``late``:
when, and by how much, the machine was late to wake a thread of it (seconds).
"""

import json
import os
import select
import signal
import sys
import threading
import time
from importlib import import_module
from pathlib import Path
from typing import Any

LONGEST = 60
"""Real seconds after which a program is ended."""
_IMPORTED_ONCE = ("rclpy.action", "rclpy.experimental", "sim.ros.middleware.host", "test_msgs.action")
"""What programs of the model use, which takes longer than to run them."""


def on_model(source: str, distro: str, steering: list[Any] | None) -> None:
    """Run a program on the model, on virtual time, as a distribution of ROS 2 behaves."""
    from sim.clock import VirtualClock
    from sim.clock.stdlib import live_on
    from sim.probes.probe import SilentProbe
    from sim.releases.profile import Profile
    from sim.ros.middleware.host import Host, install
    from tests.conformance.steered import Steered, Steering

    program: dict[str, Any] = {"__name__": "__main__", "moments": (moments := {0})}
    steered = Steered(Steering(*steering or ()), lambda: len(program.get("said", ())))
    program["choices"] = steered.made
    clock = VirtualClock(schedule=None if steering is None else steered)

    def says(line: str) -> None:
        steered.says(clock, line)
        if steered.stuck:
            program["tell_all"]()

    program["says"] = says
    probe = SilentProbe(clock)
    probe.visible = True  # so that time stops over where a timer falls due that nobody waits for
    host = Host(clock, probe, profile=Profile.named(distro))

    def look() -> int | None:
        due = host.explain_waits()
        now = clock.now()
        moments.add(now)
        for timer in program.get("timers", ()):
            if timer.due <= now:
                latest = now - (now - timer.due) % timer.period
                moments.update((latest, latest + timer.period))
        return due

    clock.time.before_jump = look
    install(host)
    live_on(clock)
    exec(compile(source, "program", "exec"), program)


def on_ros(source: str) -> None:
    """Run a program on this Python's rclpy, and measure how busy the machine is."""
    late: list[tuple[float, float]] = []
    threading.Thread(target=_oversleep, args=(late,), daemon=True).start()
    exec(compile(source, "program", "exec"), {"__name__": "__main__", "late": late})


def _oversleep(late: list[tuple[float, float]]) -> None:
    while True:
        due = time.monotonic() + 0.02
        time.sleep(0.02)
        late.append((due, time.monotonic() - due))


def run(source: str, output: str, steering: list[Any] | None, model_of: str | None) -> None:
    """Run a program in this process, which ends with it."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)  # whoever started this may ignore it
    signal.alarm(LONGEST)
    os.dup2(os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 1)
    try:
        if model_of is None:
            on_ros(source)
        else:
            on_model(source, model_of, steering)
    finally:
        os._exit(1)


def main() -> None:
    """Run what standard input tells, all at once."""
    model_of = sys.argv[2] if sys.argv[1:2] == ["model"] else None
    if model_of is not None:
        from sim.ros import importing

        importing.install()
        for name in _IMPORTED_ONCE:
            import_module(name)
    import std_srvs.srv  # type: ignore[import-untyped]  # noqa: F401

    assert threading.active_count() == 1
    running: dict[int, str] = {}
    ended = False
    while running or not ended:
        if not ended and select.select([sys.stdin], [], [], 0.1 if running else None)[0]:
            line = os.read(0, 1)
            while line and not line.endswith(b"\n"):
                line += os.read(0, 1)
            ended = not line
            if line:
                program, output, steering = json.loads(line)
                child = os.fork()
                if child == 0:
                    run(Path(program).read_text(), output, steering, model_of)
                running[child] = output
        child = os.waitpid(-1, 0 if ended else os.WNOHANG)[0] if running else 0
        if child:
            print(running.pop(child), flush=True)


if __name__ == "__main__":
    main()
