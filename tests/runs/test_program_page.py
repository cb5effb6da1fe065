"""The guide to a learner's own file: what it says can be tried is there."""

from pathlib import Path

import pytest

from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.program_page import page_of_program
from cbtui.runs.setup.unmet_changes import UnmetChanges
from sim.diagnosis import CodeLocation, Explanation
from sim.trace.timeline import Timeline
from tests.support.engine_runs import program_setup, run_program

_NODE = """
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

rclpy.init()
node = Node("server")
{}
rclpy.spin_once(node, timeout_sec=0.1)
"""
_TRIGGER = 'node.create_service(Trigger, "press", lambda request, response: response)'
_NAMED = """
def pressed(request, response):
    return response

def made_later(): ...

node.create_service(Trigger, "press", pressed)
"""
_SET_BOOL = 'node.create_service(SetBool, "switch", lambda request, response: response)'


@pytest.mark.parametrize(
    ("services", "said"),
    [
        ([_TRIGGER, _SET_BOOL], "- `s` calls ``/switch`` with true, `S` with false."),
        (
            [_TRIGGER],
            "- `:` and ``ros2 service call /press std_srvs/srv/Trigger`` call its service; "
            "`tab` completes the rest.",
        ),
    ],
)
def test_a_service_is_called_as_its_type_allows(services: list[str], said: str, tmp_path: Path) -> None:
    run = run_program(tmp_path, _NODE.format("\n".join(services)))
    over = page_of_program("node.py", "virtual", run.timeline)
    run.events.pop()
    page = page_of_program("node.py", "virtual", run.timeline)
    assert said in page["tries"].splitlines()
    assert "SetBool" not in page["tries"]
    assert said not in over["tries"].splitlines()


@pytest.mark.parametrize("spins", ["", "rclpy.spin_once(Node('other'), timeout_sec=0.1)"])
def test_no_call_is_suggested_of_a_node_that_nobody_spins(spins: str, tmp_path: Path) -> None:
    code = f"node.create_timer(0.1, print)\n{_SET_BOOL}\nimport time\n{spins}\ntime.sleep(1.0)"
    run = run_program(tmp_path, _NODE.format(code).partition("rclpy.spin_once(node")[0])
    run.events.pop()
    assert "calls ``/switch``" not in page_of_program("node.py", "virtual", run.timeline)["tries"]


@pytest.mark.parametrize(
    ("place", "has_cures", "said"),
    [
        (CodeLocation("node.py", 3, 3), True, "`d` shows its line and tries a cure"),
        (CodeLocation("node.py", 3, 3), False, "`d` shows its line and says what to do"),
        (None, True, "`d` tries a cure"),
    ],
)
def test_a_problem_promises_a_cure_only_where_there_is_one(
    place: CodeLocation | None, has_cures: bool, said: str
) -> None:
    problem = Explanation("tick waits", "", "", place)
    page = page_of_program("node.py", "virtual", Timeline(), [problem, problem], has_cures=has_cures)
    assert f"- tick waits. {said}, and 1 further problem." in page["tries"].splitlines()


def test_a_problem_that_ends_in_a_question_gets_no_full_stop() -> None:
    page = page_of_program(
        "node.py", "virtual", Timeline(), [Explanation("did you mean spin?", "", "", None)]
    )
    assert "- did you mean spin? `d` says" in page["tries"]


def test_a_problem_of_a_lambda_names_it() -> None:
    page = page_of_program("node.py", "virtual", Timeline(), [Explanation("<lambda> waits", "", "", None)])
    assert r"- \<lambda\> waits. `d` says what to do." in page["tries"].splitlines()


def test_a_change_for_a_callback_that_there_is_not_is_told_of(tmp_path: Path) -> None:
    run = run_program(tmp_path, _NODE.format(_TRIGGER))
    path = tmp_path / "node.py"
    path.write_text(_NODE.format(_TRIGGER))
    changes = Changes().with_group(("", "pushed"), "own").with_group(("", "press"), "own")
    unmet = UnmetChanges(changes.applied(program_setup(path, 1.0))).now(run.timeline)
    page = page_of_program("node.py", "virtual", run.timeline, unmet=unmet)
    assert page["found"].splitlines()[-1] == (
        "- no callback is named ``pushed`` so far: nothing is changed there"
    )
    assert page["found"].count("no callback is named") == 1


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (Changes().with_group(("/server", "pressed"), "own"), []),
        (
            Changes().with_group(("/sever", "pressed"), "own"),
            [("no callback is named pressed in /sever", True)],
        ),
        (Changes().with_group(("/Trigger", "pressed"), "own"), []),
        (Changes().with_period(("", "pressed"), 1), [("no timer callback is named pressed", False)]),
        (
            Changes().with_period(("/server", "pressed"), 1),
            [("no timer callback is named pressed in /server", False)],
        ),
        (Changes().with_group(("/server", "made_later"), "own"), []),
    ],
)
def test_a_change_is_wrong_if_no_file_mentions_its_node_or_callback(
    changes: Changes, said: list[tuple[str, bool]], tmp_path: Path
) -> None:
    run = run_program(tmp_path, _NODE.format(_NAMED))
    path = tmp_path / "node.py"
    path.write_text(_NODE.format(_NAMED))
    unmet = UnmetChanges(changes.applied(program_setup(path, 1.0))).now(run.timeline)
    assert [(each.sentence(), each.is_wrong) for each in unmet] == [
        (f"{sentence} so far", is_wrong) for sentence, is_wrong in said
    ]


@pytest.mark.parametrize(("count", "said"), [(1, "s"), (9, "s × 9"), (30, "s × 20, …")])
def test_timers_of_one_function_and_period_are_listed_once(count: int, said: str, tmp_path: Path) -> None:
    made = f"for _ in range({count}): node.create_timer(1.0, node.get_name)"
    run = run_program(tmp_path, _NODE.format(made))
    found = page_of_program("node.py", "virtual", run.timeline)["found"]
    assert found.splitlines()[-1].endswith(f": ``get_name`` every 1.0 {said}")


def test_the_guide_says_of_each_node_who_spins_it(tmp_path: Path) -> None:
    idle, alarm = "idle = Node('idle')", "alarm = Node('alarm')\nalarm.create_timer(0.1, print)"
    run = run_program(
        tmp_path,
        f"{_NODE.partition('{}')[0]}{idle}\n{alarm}\nnode.create_timer(0.1, str)\nrclpy.spin(node)",
        seconds=1.0,
    )
    assert page_of_program("node.py", "virtual", run.timeline)["found"].splitlines()[2:5] == [
        "- node ``/server``, in SingleThreadedExecutor",
        "- node ``/idle``, of which nothing has run so far",
        "- node ``/alarm``, spun by nobody so far",
    ]
