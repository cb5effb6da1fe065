"""A program that writes lines as fast as it can, on the real clock."""

from pathlib import Path
from threading import Event

import pytest

from cbtui.engines.session import ProcessSession
from sim.engine.commands import CallService
from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.trace.events import AnyEvent, CommandGiven, EventsLost, Logged, Notice, Printed
from tests.faults.support import PATIENCE, node_with

FLOODS = {"logs": "while True: self.get_logger().info('x')", "prints": "while True: print('x')"}
FAR = 3000
"""More events than those that are on their way to a console."""


@pytest.mark.parametrize("fault", FLOODS.values(), ids=FLOODS)
def test_the_answer_to_a_command_is_not_far_behind_lines_that_are_taken_slowly(
    tmp_path: Path, fault: str
) -> None:
    """The console stands for a while, then takes what came: the answer has to be among the first of it."""
    path = node_with(tmp_path, fault)
    setup = RunSetup(
        title="n", programs=(ProgramSetup(str(path)),), clock="real", speed=None, robot=RobotUse.NEVER
    )
    told: list[AnyEvent] = []
    floods, goes_on, answered = Event(), Event(), Event()

    def deliver(events: list[AnyEvent]) -> None:
        told.extend(events)
        if len(told) > FAR:
            floods.set()
            goes_on.wait(PATIENCE)
        if any(isinstance(event, CommandGiven | Notice) for event in told[FAR:]):
            answered.set()

    session = ProcessSession(setup, deliver, lambda _: None)
    session.start()
    try:
        assert floods.wait(PATIENCE)
        known = len(told)
        assert not answered.wait(0.5)
        session.send(CallService(None, data=True))
        goes_on.set()
        assert answered.wait(PATIENCE)
    finally:
        goes_on.set()
        session.stop()
    place = next(place for place, event in enumerate(told) if isinstance(event, CommandGiven | Notice))
    assert known < place < known + FAR
    assert any(isinstance(event, Logged | Printed) for event in told)
    assert not any(isinstance(event, EventsLost) for event in told)
