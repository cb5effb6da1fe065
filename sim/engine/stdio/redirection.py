"""Records the output of programs on Python's streams, each line with its program."""

import sys
from collections.abc import Callable

from sim.clock import RunClock
from sim.engine.stdio.output import ProcessStream
from sim.ros.middleware.process import Process, current_process
from sim.trace.events import AnyEvent, Notice, Printed, Severity


def redirect_output(clock: RunClock, record: Callable[[AnyEvent], None]) -> None:
    """Replace Python's streams by streams that record the output of each program."""

    def report_hidden_output() -> None:
        text = (
            f"{current_process().label} prints to stdout, which ros2 launch only shows with output='screen'; "
            "its log goes to stderr and is shown"
        )
        record(Notice(clock.now(), Severity.INFO, text))

    def take_from(error: bool) -> Callable[[Process, str, bool], None]:
        def take(process: Process, text: str, ends: bool) -> None:
            if process.output_listener is not None and ends:
                process.output_listener(text, error)
            if process.output_sink is not None:
                process.output_sink(text, error)
            elif error or process.shows_stdout:
                record(Printed(clock.now(), text, error, process.number, ends))
            else:
                process.local(report_hidden_output)

        return take

    sys.stdout = ProcessStream(take_from(error=False), clock.switch_point)
    # Python's logging writes to stderr while it holds a lock that is not on the clock.
    sys.stderr = ProcessStream(take_from(error=True))
