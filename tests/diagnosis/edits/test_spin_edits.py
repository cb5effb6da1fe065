"""Edits of programs that spin one node after another."""

from pathlib import Path

import pytest

from sim.diagnosis.edits.spins import (
    await_in_loop,
    never_made,
    spin_beside,
    spin_node_beside,
    spin_past,
    spin_together,
    spins_in_turn,
    starving_loop,
)
from tests.diagnosis.edits.edited_source import changed


def test_nodes_that_are_spun_in_turn_are_spun_by_one_executor() -> None:
    main = "def main():\n    rclpy.spin(a)  # here\n    a.log()\n    rclpy.spin(self.b)\n    a.log()\n"
    assert changed(f"import rclpy\n\n\n{main}", spin_together) == [
        "+from rclpy.executors import SingleThreadedExecutor",
        "-    rclpy.spin(a)  # here",
        "+    executor = SingleThreadedExecutor()",
        "+    executor.add_node(a)",
        "+    executor.add_node(self.b)",
        "+    executor.spin()",
        "-    rclpy.spin(self.b)",
    ]


def test_of_executors_that_are_spun_in_turn_the_first_gets_all_nodes() -> None:
    made = "one = SingleThreadedExecutor()\none.add_node(a)\ntwo = MultiThreadedExecutor()\ntwo.add_node(b)\n"
    assert changed(f"{made}one.spin()  # here\ntwo.spin()\n", spin_together) == [
        "-two.add_node(b)",
        "+one.add_node(b)",
        "-two.spin()",
    ]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("rclpy.spin(a)\nrclpy.spin(b)\nrclpy.spin(c)\n", (1, 2, 3)),
        ("rclpy.spin(a)\n", ()),
        ("if a:\n    rclpy.spin(a)\nelse:\n    rclpy.spin(b)\n", ()),
        ("robot.spin()\nrobot.spin()\n", ()),
        ("def f():\n    rclpy.spin(a)\n    rclpy.spin(b)\n\nrclpy.spin(a)\nrclpy.spin(b)\n", ()),
        ("rclpy.spin(", ()),
    ],
)
def test_spins_in_turn_are_those_of_one_body(text: str, lines: tuple[int, ...], tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(text)
    assert spins_in_turn(str(path)) == lines


def test_a_spin_of_a_node_and_one_of_an_executor_stay() -> None:
    text = "import rclpy\none = SingleThreadedExecutor()\nrclpy.spin(a)  # here\none.spin()\n"
    assert changed(text, spin_together) is None


MADE = "ex = MultiThreadedExecutor()\nex.add_node(n)\n"


@pytest.mark.parametrize(
    ("text", "past"),
    [
        (f"{MADE}rclpy.spin(n)\nex.shutdown()\n", (3, "ex")),
        (f"{MADE.replace('ex', 'self.ex')}spin(n)\n", (3, "self.ex")),
        (f"{MADE}rclpy.spin(other)\n", (0, "")),
        (f"{MADE}rclpy.spin(n, ex)\n", (0, "")),
        (f"{MADE}rclpy.spin(n, executor=ex)\n", (0, "")),
        (f"{MADE}Thread(target=ex.spin).start()\nrclpy.spin(n)\n", (0, "")),
        (f"{MADE}use(ex)\nrclpy.spin(n)\n", (0, "")),
    ],
)
def test_a_spin_goes_past_an_executor_that_nothing_spins(
    text: str, past: tuple[int, str], tmp_path: Path
) -> None:
    path = tmp_path / "node.py"
    path.write_text(text)
    assert spin_past(str(path)) == past


NODES = """
class Talker(Node):
    def __init__(self):
        self.create_timer(1.0, self.tick)

class Listener(Node):
    def __init__(self):
        self.create_subscription(
            String, "chatter", self.hear, 10
        )

class Empty(Node):
    pass

rclpy.spin(Talker())
rclpy.spin(Listener())
rclpy.spin(Empty())
"""


@pytest.mark.parametrize(
    ("made", "found"),
    [({4}, ["Listener"]), ({4, 9}, []), ({4, 3}, [])],
    ids=["not made", "made", "another text ran"],
)
def test_a_node_that_a_later_spin_makes_was_made_if_its_entities_were(
    made: set[int], found: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "node.py"
    path.write_text(NODES)
    assert never_made(str(path), made) == found


def test_a_node_that_is_made_before_the_first_spin_is_not_missing(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(NODES.replace("rclpy.spin(Listener())", "rclpy.spin(listener)"))
    assert never_made(str(path), {4}) == []


def test_a_file_that_has_been_changed_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("rclpy.spin(a)\nrclpy.spin(b)\n")
    assert spins_in_turn(str(path)) == (1, 2)
    path.write_text("executor.spin()\n")
    assert spins_in_turn(str(path)) == ()


LOOP = "import rclpy\n{0}while rclpy.ok():\n    for _ in range(3):\n        {1}.sleep()  # here\n"


@pytest.mark.parametrize(
    ("made", "rate", "node"),
    [
        ("rate = self.node.create_rate(10)\n", "rate", "self.node"),
        ("", "node.rate", "node"),
        ("self.rate = self.create_rate(10)\n", "self.rate", "self"),
    ],
)
def test_the_node_of_a_rate_is_spun_in_a_thread_that_begins_before_the_outermost_loop(
    made: str, rate: str, node: str
) -> None:
    inside_out = LOOP.replace("while rclpy.ok()", "for _ in range(3)", 1).replace(
        "    for _ in range(3)", "    while rclpy.ok()"
    )
    for loop in (LOOP, inside_out):
        assert changed(loop.format(made, rate), spin_beside) == spun_before_loop(node)


def spun_before_loop(node: str) -> list[str]:
    return [
        "+from threading import Thread",
        "+",
        f"+Thread(target=rclpy.spin, args=({node},), daemon=True).start()",
    ]


def test_a_rate_of_an_unknown_node_or_without_a_loop_stays() -> None:
    assert changed(LOOP.format("", "rate"), spin_beside) is None
    assert changed("import rclpy\nself.rate.sleep()  # here\n", spin_beside) is None


@pytest.mark.parametrize(
    ("made", "more", "spun"),
    [
        ("n = Node('n')", "", True),
        ("n = rclpy.create_node('n')", "", True),
        ("n = Own()", "", True),
        ("n = Other()", "", False),
        ("n = Node('n')", "m = Node('m')", False),
        ("n = Node('n')", "rclpy.spin(n)", False),
        ("def make():\n    n = Node('n')", "", False),
    ],
)
def test_a_node_is_spun_beside_a_loop_if_it_is_the_only_one_and_spun_nowhere(
    made: str, more: str, spun: bool
) -> None:
    program = (
        f"import rclpy\n{made}\nwhile rclpy.ok():  # here\n    time.sleep(1)\nclass Own(Node): ...\n{more}\n"
    )
    assert changed(program, spin_node_beside) == (spun_before_loop("n") if spun else None)


SPINS = "import asyncio\nasync def spin():\n    while ok():  # here\n        rclpy.spin_once(node){0}\n{1}"
ASK = "async def ask():\n    await asyncio.sleep(1)\n"


def test_a_loop_that_spins_in_a_coroutine_awaits_in_each_round() -> None:
    assert changed(SPINS.format("", ASK), await_in_loop) == ["+        await asyncio.sleep(0)"]


@pytest.mark.parametrize(
    ("behind", "more", "found"),
    [
        ("", ASK, (3, "spin", ("ask",))),
        ("\n        await asyncio.sleep(0)", ASK, (0, "", ())),
        ("", "", (0, "", ())),
        ("", f"{ASK}executor.spin()", (0, "", ())),
    ],
    ids=["never awaits", "awaits", "no other coroutine", "spins elsewhere, too"],
)
def test_a_loop_that_starves_other_coroutines_is_found(
    behind: str, more: str, found: tuple[object, ...], tmp_path: Path
) -> None:
    path = tmp_path / "node.py"
    path.write_text(SPINS.format(behind, more))
    assert starving_loop(str(path)) == found
