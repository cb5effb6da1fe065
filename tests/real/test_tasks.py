"""What a program has an executor run as a task is on the trace, on both grounds and with its lines."""

from pathlib import Path

import pytest

from sim.trace.events import EntityKind
from tests.real import programs

TASKS = """
import functools
from rclpy.experimental import EventsExecutor
from rclpy.task import Future

class Polled:
    def __init__(self, executor):
        self.add_node = executor.add_node
        self.spin_once = executor.spin_once

    def spin(self):
        while rclpy.ok():
            self.spin_once(timeout_sec=0.1)

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.timer = self.create_timer(0.2, self.tick)

    def tick(self):
        self.timer.cancel()
        self.executor.create_task(self.given_as_coroutine())
        self.executor.create_task(self.given_as_function, 1)
        self.executor.create_task(self.never_begun()).cancel()
        future = Future(executor=self.executor)
        future.add_done_callback(functools.partial(self.done, 1))
        future.set_result(None)

    async def given_as_coroutine(self):
        time.sleep(0.01)

    async def given_as_function(self, number):
        time.sleep(0.01)

    async def never_begun(self):
        pass

    def done(self, number, future):
        time.sleep(0.01)
"""


@pytest.mark.parametrize("ground", ["model", pytest.param("ros2", marks=programs.needs_ros)])
@pytest.mark.parametrize("executor", ["SingleThreadedExecutor()", "Polled(EventsExecutor())"])
def test_tasks_have_their_calls_and_lines_on_the_trace(tmp_path: Path, executor: str, ground: str) -> None:
    run = programs.run(tmp_path, TASKS, executor, ground=ground, seconds=1.0)
    timeline, window = run.timeline, programs.whole(run.timeline)
    lines = (programs.HEAD + TASKS).splitlines()
    tasks = {
        each.callback: (lines[each.first_line - 1].split("(")[0].split()[-1], len(calls))
        for each in timeline.entities.values()
        if each.kind is EntityKind.TASK and (calls := timeline.spans_of(each.id, window))
    }
    assert tasks == {name: (name, 1) for name in ("given_as_coroutine", "given_as_function", "done")}
