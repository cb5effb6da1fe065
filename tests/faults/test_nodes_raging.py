"""Nodes that rage on: meanwhile the console answers keys, and meanwhile ``ctrl+r`` runs the file again."""

import re
from pathlib import Path
from typing import NamedTuple

import pytest

from cbtui.engines.memory_limit import MEMORY_LIMIT
from cbtui.runs.live.live_run import LiveRun, RunState
from sim.recording import read
from tests.faults.support import FIRST, console_on, node_with, provoked, still_here
from tests.recording.files import timeline_of
from tests.support.daily import first_slow
from tests.support.engine_runs import SECOND
from tests.support.pictures import text_of

CROWD = 2500
"""Entities of which each would cost a little of every frame."""
HUNDRED_MB = "for _ in range(2000): print('x' * 50_000)"
AT = f"node.py:{FIRST}, in fault"
MANY_MADE = (
    f"a node has 1,000 timers, subscriptions, services or clients, and its callbacks make more ({AT}): each"
)


class Rages(NamedTuple):
    """What a node does at each call of its timer, and the clock on which it does it."""

    fault: str
    clock: str = "real"
    entities: int = 1
    """How many the console knows of when the first key is pressed."""
    notice: str = ""
    """What the engine has said of it by then."""


FAULTS = {
    "loops for ever": Rages("while True: pass"),
    "logs as fast as it can": Rages("while True: self.get_logger().info('x')"),
    "prints as fast as it can": Rages("while True: print('x')"),
    "loops for ever on virtual time": Rages("while True: pass", "virtual"),
    "prints 100 MB": Rages(HUNDRED_MB),
    "publishes 1 MB at 1 kHz": Rages(
        "if not hasattr(self, 'big'):\n"
        "    self.big = self.create_publisher(String, 'big', 10)\n"
        "    self.create_subscription(String, 'big', lambda _: None, 10)\n"
        "    self.message = String(data='x' * 1_000_000)\n"
        "for _ in range(20): self.big.publish(self.message)"
    ),
    "makes 1,000 topics a second": Rages(
        "for each in range(20): self.create_publisher(String, f't{self.count}_{each}', 10)",
        notice=f"a node has 1,000 publishers, and its callbacks make more ({AT}): each stays until",
    ),
    "makes timers without end": Rages(
        "for _ in range(100): self.create_timer(1000.0, self.tick)",
        entities=CROWD,
        notice=MANY_MADE,
    ),
    "makes services without end": Rages(
        "for each in range(100): self.create_service(SetBool, f's{self.count}_{each}', lambda _, r: r)",
        entities=CROWD,
        notice=MANY_MADE,
    ),
}


def begun(live: LiveRun) -> bool:
    """Whether the node's timer is known."""
    return bool(live.timeline.entities)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.bulk if place % 4 else pytest.mark.slow)
        for place, name in enumerate(FAULTS)
    ],
)
async def test_the_console_answers_while_a_node_rages_and_runs_it_again(folder: Path, name: str) -> None:
    fault, clock, entities, notice = FAULTS[name]
    async with console_on(node_with(folder, fault, again=True), clock) as console:
        await console.until(lambda live: len(live.timeline.entities) >= entities)
        await console.until(lambda _: notice in console.said)
        console.app.simulate_key("R")
        await console.answers()
        first = console.screen.runs.run
        console.app.simulate_key("ctrl+r")
        await console.until(lambda live: live is not first and begun(live))
    (path,) = folder.glob("*.mcap")
    assert read(path).damage is None


@pytest.mark.bulk
def test_a_hundred_megabytes_are_all_in_the_log(folder: Path) -> None:
    with provoked(node_with(folder, HUNDRED_MB)) as run:
        run.until(still_here)
        assert sum(map(len, run.printed)) == 100_000_000 + len("still here")
        assert max(map(len, run.printed)) == 4096


@pytest.mark.slow
async def test_a_loop_without_end_on_the_real_clock_is_told_on_screen_with_its_place(folder: Path) -> None:
    async with console_on(node_with(folder, "while True: pass")) as console:
        await console.until(lambda live: bool(live.timeline.notices))
        (notice,) = console.screen.runs.run.timeline.notices
        assert notice.text.startswith("tick has not come back since ")
        assert f" s (node.py:{FIRST}, in fault)" in notice.text


@pytest.mark.slow
async def test_where_a_loop_without_end_keeps_virtual_time_the_header_says_that_it_stands(
    folder: Path,
) -> None:
    async with console_on(node_with(folder, "while True: pass"), "virtual") as console:
        await console.until(lambda live: bool(live.timeline.notices))
        await console.until(lambda _: "● LIVE  virtual time stands" in text_of(console.app))


@pytest.mark.parametrize(
    "fault", first_slow("while True: pass", "lock = threading.Lock()\nwith lock, lock: pass")
)
async def test_time_goes_on_on_screen_and_in_the_recording_while_a_callback_does_not_come_back(
    folder: Path, fault: str
) -> None:
    async with console_on(node_with(folder, fault)) as console:
        await console.until(lambda live: bool(live.timeline.notices))
        console.app.simulate_key("R")
        await console.until(lambda live: live.recording.count is not None)
        last = console.screen.runs.run.timeline.notices[-1].t
        await console.until(lambda live: live.timeline.end > last + SECOND)
        screen = console.app
        await console.until(
            lambda _: any(float(runs) > 3.5 for runs in re.findall(r"runs (\d+\.\d) s", text_of(screen)))
        )
        console.app.simulate_key("R")
        await console.until(lambda live: live.recording.count is None)
    (path,) = folder.glob("*.mcap")
    assert timeline_of(read(path).batches()).end > last + SECOND


@pytest.mark.slow
async def test_a_node_that_took_too_much_memory_can_be_run_again_with_the_key(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MEMORY_LIMIT, "0.4")
    path = node_with(folder, "self.kept = b'x' * 3_000_000_000")
    async with console_on(path) as console:
        await console.until(lambda live: live.state is RunState.LOST)
        assert "the node used more than 0.4 GB of memory" in str(console.screen.runs.run.loss)
        first = console.screen.runs.run
        node_with(folder, "pass")
        await console.pilot.press("r")
        await console.until(lambda live: live is not first and begun(live))
        assert console.screen.runs.run.alive
