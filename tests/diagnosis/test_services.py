"""Service calls that are never answered."""

from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

import sim.ros.rclpy as rclpy
from lessons.catalogue import lesson_on
from sim.diagnosis.diagnoses import diagnose
from sim.engine.setup import ProgramSetup
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from tests.diagnosis.findings import Diagnosed, SetBool, diagnosed, once, spin
from tests.support.engine_runs import program_setup, run_program, run_to_end
from tests.support.simulation import Simulation


def served_by(serve: Callable[[object, object], object], until: float = 5.0) -> Diagnosed:
    """A service that is called at 1 s; its node spins on whatever comes out of ``spin``."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(SetBool, "s", serve)
        client = node.create_client(SetBool, "s")
        once(node, 1.0, lambda: client.call_async(SetBool.Request()))
        while rclpy.ok():
            try:
                rclpy.spin(node)
            except (TypeError, ValueError):
                continue

    return diagnosed(program, until)


def test_a_callback_that_returns_no_response_leaves_its_caller_waiting() -> None:
    def serve(_: object, response: object) -> object:
        return None

    run = served_by(serve)
    assert run.problems() == {("unreturned-response", "serve")}
    told = run.explained("unreturned-response")
    assert told.what == "serve returned no response, so the caller of /s waits for ever"
    assert told.cure == "end serve with: return response"
    found = run.one("unreturned-response")
    assert lesson_on(found.rule.kind(found, run.timeline)) is None


@pytest.mark.parametrize(("returned", "kind"), [(True, "bool"), (SetBool.Request(), "SetBool_Request")])
def test_a_callback_that_returns_something_else_is_told_of_what_type_that_is(
    returned: object, kind: str
) -> None:
    def serve(_: object, response: object) -> object:
        return returned

    told = served_by(serve).explained("unreturned-response")
    assert told.what == (
        f"serve returned a value of type {kind}, and not its response, so the caller of /s waits for ever"
    )
    assert told.cure == "set the fields of the response that serve is given, and return that"


def test_a_callback_that_raises_leaves_its_caller_waiting() -> None:
    def serve(_: object, response: object) -> object:
        raise ValueError("no such angle")

    run = served_by(serve)
    assert run.problems() == {("unreturned-response", "serve")}
    told = run.explained("unreturned-response").what
    assert told == "serve raised, so the caller of /s waits for ever: ValueError: no such angle"


def test_a_callback_that_raises_in_the_words_of_a_missing_response_has_raised() -> None:
    def serve(_: object, response: object) -> object:
        raise TypeError("Expected a number, got None")

    run = served_by(serve)
    assert ": TypeError: Expected a number" in run.explained("unreturned-response").what


def test_a_callback_that_returns_its_response_is_well() -> None:
    assert served_by(lambda _, response: response).told() == set()


def test_a_callback_that_still_works_when_the_run_ends_is_well() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def serve(_: object, response: object) -> object:
            simulation.sleep(60.0)
            return response

        node.create_service(SetBool, "s", serve)
        client = node.create_client(SetBool, "s")
        once(node, 1.0, lambda: client.call_async(SetBool.Request()))
        spin(node, None)

    assert diagnosed(program).problems() == set()


def test_a_coroutine_that_answers_later_is_well() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        open_door: rclpy.Future = rclpy.Future()  # type: ignore[type-arg]
        group = MutuallyExclusiveCallbackGroup()

        async def serve(_: object, response: object) -> object:
            await open_door
            return response

        node.create_service(SetBool, "s", serve)
        client = node.create_client(SetBool, "s", callback_group=group)
        once(node, 1.0, lambda: client.call_async(SetBool.Request()), group)
        once(node, 8.0, lambda: open_door.set_result(None), group)
        spin(node, None)

    assert diagnosed(program).problems() == set()
    assert diagnosed(program, until=5.0).problems() == set()


def calling(name: str, at: float = 1.0) -> Diagnosed:
    """``caller`` calls a service by name; ``/s`` is offered from 2 s on."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, name)

        def caller() -> None:
            client.call_async(SetBool.Request())

        once(node, at, caller)
        simulation.at(2.0, lambda: node.create_service(SetBool, "s", lambda _, response: response))
        spin(node, None)

    return diagnosed(program)


def test_a_call_of_a_service_that_nobody_offers_is_told() -> None:
    run = calling("/wrong")
    assert run.told() == {("nobody-offers", "caller")}
    told = run.explained("nobody-offers")
    assert told.what == "caller called /wrong, which nobody offered: no reply will come"
    assert "check the service's name" in told.cure


def test_a_call_before_the_service_is_there_is_told() -> None:
    run = calling("/s")
    assert run.told() == {("nobody-offers", "caller")}
    assert run.explained("nobody-offers").cure.startswith("call wait_for_service() first")


def test_a_call_of_a_service_that_is_there_is_well() -> None:
    assert calling("/s", at=3.0).told() == set()


def test_a_call_that_blocks_on_a_service_nobody_offers_is_told_as_that_and_not_as_a_deadlock() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, "/wrong", callback_group=MutuallyExclusiveCallbackGroup())

        def caller() -> None:
            client.call(SetBool.Request())

        once(node, 1.0, caller)
        spin(node, 2)

    assert diagnosed(program).problems() == {("nobody-offers", "caller")}


def test_each_of_several_programs_is_told_where_it_waits_before_it_spins(tmp_path: Path) -> None:
    text = (
        "import rclpy\nfrom rclpy.node import Node\nfrom std_srvs.srv import Trigger\n\n\n"
        "rclpy.init()\nnode = Node('{}')\nclient = node.create_client(Trigger, '{}')\n"
        "node.create_service(Trigger, '/here', lambda request, response: response)\n"
        "client.wait_for_service()\nrclpy.spin(node)\n"
    )
    programs = [tmp_path / "well.py", tmp_path / "waits.py"]
    for path, service in zip(programs, ("/here", "/nowhere"), strict=True):
        path.write_text(text.format(path.stem, service))
    setup = msgspec.structs.replace(
        program_setup(programs[0], 3.0), programs=tuple(ProgramSetup(str(each)) for each in programs)
    )
    timeline = run_to_end(setup).timeline
    (found,) = diagnose(timeline)
    told = found.explained(timeline)
    assert told.what.startswith("the program waits-2 waits in wait_for_service() for /nowhere, ")
    assert str(told.place) == "waits.py:10"


def test_a_service_that_the_waiting_callback_keeps_from_being_created_is_told_with_its_line() -> None:
    path = Path(__file__).parent / "beginners" / "service_created_later.py"
    timeline = run_to_end(program_setup(path, 3.0)).timeline
    assert diagnose(timeline)[0].explained(timeline).what == (
        "pick waits in wait_for_service() for /grip, which nobody has offered so far; setup would create it "
        "at line 20, and can run only when the wait is over"
    )


def test_a_request_before_its_service_is_created_is_told_with_both_lines(tmp_path: Path) -> None:
    program = (Path(__file__).parent / "beginners" / "service_created_later.py").read_text()
    timeline = run_program(tmp_path, program.replace("self.client.wait_for_service()", ""), 0.9).timeline
    [told] = [each.explained(timeline) for each in diagnose(timeline)]
    assert told.what == (
        "pick called /grip, which nobody offered: no reply will come; setup would create it at line 20"
    )
    assert told.cure == "create /grip in __init__, or ask service_is_ready() first, and return without it"
    assert str(told.place) == "node.py:16"


@pytest.mark.parametrize("before", ["", "other = node.create_client(Trigger, 'grip')\n"])
def test_of_several_clients_the_one_is_told_that_the_program_waits_for(tmp_path: Path, before: str) -> None:
    path = tmp_path / "program.py"
    path.write_text(
        "import rclpy\nfrom rclpy.node import Node\nfrom std_srvs.srv import Trigger\n\n"
        f"rclpy.init()\nnode = Node('n')\n{before}client = node.create_client(Trigger, 'late')\n"
        "node.create_timer(0.5, node.get_name)\nclient.wait_for_service()\n"
        "node.create_service(Trigger, 'late', lambda request, response: response)\nrclpy.spin(node)\n"
    )
    timeline = run_to_end(program_setup(path, 3.0)).timeline
    (found,) = diagnose(timeline)
    told = found.explained(timeline)
    line = 10 + bool(before)
    assert (
        f"for /late, which nobody has offered so far; the program would create it at line {line}" in told.what
    )
    assert told.cure == "create /late before the wait"


LAMP = """
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger


class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.client = self.create_client(SetBool, "lamp_on")
        self.create_timer(1.0, self.press)
        self.offer()

    def offer(self):
        self.create_service(SetBool, "lamp/on", lambda request, response: response)

    def press(self):
        self.client.wait_for_service(timeout_sec=0.5)


rclpy.init()
rclpy.spin(Lamp())
"""


@pytest.mark.parametrize(
    ("old", "new", "seconds", "told"),
    [
        ("", "", 6.0, ("problem", "nobody has offered it so far", "call /lamp/on, which is offered")),
        ("", "", 3.0, None),
        ("lamp_on", "window", 6.0, ("remark", "nobody has offered it so far", "start the node that offers")),
        (
            'SetBool, "lamp_on',
            'Trigger, "lamp/on',
            6.0,
            ("problem", "it is offered as std_srvs", "same type"),
        ),
        ("lamp_on", "lamp/on", 6.0, None),
    ],
)
def test_waits_for_a_service_that_end_in_vain_again_and_again_are_told_at_the_client(
    tmp_path: Path, old: str, new: str, seconds: float, told: tuple[str, str, str] | None
) -> None:
    path = tmp_path / "lamp.py"
    path.write_text(LAMP.replace(old, new) if old else LAMP)
    timeline = run_to_end(program_setup(path, seconds)).timeline
    found = [(each, each.explained(timeline)) for each in diagnose(timeline)]
    if told is None:
        assert not found
        return
    [(each, words)] = found
    assert each.weight_in(timeline).value == told[0]
    assert told[1] in words.what
    assert told[2] in words.cure
    assert str(words.place) == "lamp.py:10"


def test_waits_for_a_service_that_came_later_are_well(tmp_path: Path) -> None:
    path = tmp_path / "lamp.py"
    path.write_text(
        LAMP.replace("lamp_on", "lamp/on").replace("self.offer()", "self.create_timer(4.8, self.offer)")
    )
    waiting = run_to_end(program_setup(path, 4.6)).timeline
    assert [each.weight_in(waiting).value for each in diagnose(waiting)] == ["remark"]
    assert not diagnose(run_to_end(program_setup(path, 6.0)).timeline)


NO_RESPONSE = """
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Trigger

def work(request, response):
    pass

def ask():
    client.call(Trigger.Request())

rclpy.init()
node = rclpy.create_node("lazy")
group = ReentrantCallbackGroup()
node.create_service(Trigger, "work", work, callback_group=group)
client = node.create_client(Trigger, "work", callback_group=group)
node.create_timer(1.0, ask, callback_group=group)
executor = MultiThreadedExecutor(4)
executor.add_node(node)
while rclpy.ok():
    try:
        executor.spin()
    except TypeError:
        pass
"""


def test_what_comes_of_a_reply_that_does_not_come_is_not_told_beside_its_cause(tmp_path: Path) -> None:
    timeline = run_program(tmp_path, NO_RESPONSE, 3.5).timeline
    assert [each.rule.id for each in diagnose(timeline)] == ["unreturned-response"]
