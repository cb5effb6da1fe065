"""Nodes that end their process, by will or by accident: told with the place, and nothing is lost."""

from pathlib import Path
from typing import NamedTuple

import pytest

from cbtui.runs.live.live_run import RunState
from tests.faults.support import FIRST, node_with, provoked
from tests.support.daily import first_daily


class Ends(NamedTuple):
    """What a node does, and what the person reads of it."""

    fault: str
    sentence: str
    state: RunState = RunState.LOST


AT = f"node.py:{FIRST}"
IN_FAULT = f"({AT}, in fault)"

FAULTS = {
    "sys.exit": Ends(
        "sys.exit(3)", f"the run is over: the program ended with exit code 3 ({AT})", RunState.ENDED
    ),
    "os._exit": Ends(
        "os._exit(3)",
        f"engine lost: the program ended its process by os._exit(), with exit code 3 {IN_FAULT}",
    ),
    "os.abort": Ends("os.abort()", f"engine lost: the program crashed with SIGABRT {IN_FAULT}"),
    "a crash in C": Ends(
        "import ctypes; ctypes.string_at(0)",
        f"engine lost: the program crashed with SIGSEGV {IN_FAULT}",
    ),
    "a full stack in C": Ends(
        "sys.setrecursionlimit(10**9)\nclass R:\n    def __repr__(self): return repr(self)\nrepr(R())",
        "engine lost: the program called itself until its stack was full, and crashed with SIGSEGV "
        f"(node.py:{FIRST + 2}, in __repr__)",
    ),
    "a recursion without end": Ends(
        "self.fault()",
        f"the run is over: {AT}: the program raised RecursionError: maximum recursion depth exceeded",
        RunState.ENDED,
    ),
    "SIGKILL": Ends("os.kill(os.getpid(), 9)", "engine lost: killed by signal 9"),
    "files closed that are not its own": Ends(
        "os.closerange(3, 256)",
        "engine lost: the program closed files of the engine's, as os.closerange does; close only your own",
    ),
    "an exception in a done-callback": Ends(
        "self.create_service(SetBool, 's', lambda q, r: r)\n"
        "call = self.create_client(SetBool, 's').call_async(SetBool.Request())\n"
        "call.add_done_callback(lambda _: 1 / 0)",
        f"the run is over: node.py:{FIRST + 2}: the program raised ZeroDivisionError: division by zero",
        RunState.ENDED,
    ),
    "rclpy.shutdown in a callback": Ends(
        "rclpy.shutdown()",
        f"the run is over: the program returned, as rclpy was shut down {IN_FAULT}",
        RunState.ENDED,
    ),
}


@pytest.mark.parametrize("name", first_daily(*FAULTS))
def test_a_node_that_ends_its_process_is_told_of_with_its_place_and_its_recording_opens(
    folder: Path, name: str
) -> None:
    fault, sentence, state = FAULTS[name]
    with provoked(node_with(folder, fault)) as run:
        run.to_its_end()
        assert run.sentence.startswith(sentence)
        assert run.live.state is state
    assert run.recorded is not None


@pytest.mark.parametrize("name", first_daily("os._exit", "a crash in C", "rclpy.shutdown in a callback"))
def test_it_is_told_the_same_way_on_virtual_time(folder: Path, name: str) -> None:
    with provoked(node_with(folder, FAULTS[name].fault), "virtual") as run:
        run.to_its_end()
        assert run.sentence.startswith(FAULTS[name].sentence)


def test_what_was_printed_before_os_exit_is_not_lost(folder: Path) -> None:
    with provoked(node_with(folder, "print('last words')\nos._exit(0)")) as run:
        run.to_its_end()
        assert "last words" in run.printed
