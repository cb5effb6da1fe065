"""Edits of callbacks that wait or loop."""

from pathlib import Path
from textwrap import indent

import pytest

from sim.diagnosis.edits.flags import setters, sleep_in_loop
from sim.diagnosis.edits.polling import go_on_where_set, leave_out, look_again, one_round_a_call, step_by_step
from tests.diagnosis.edits.edited_source import changed, edited, node


@pytest.mark.parametrize(
    ("wait", "condition"),
    [
        ("while not self.ready:  # here\n    pass", "if not self.ready:"),
        ("while True:  # here\n    if self.ready:\n        break\n    time.sleep(0.1)", "if not self.ready:"),
        ("while True:  # here\n    if not self.busy:\n        break", "if self.busy:"),
        ("while True:  # here\n    if self.n > 3:\n        break", "if not (self.n > 3):"),
        ("self.client.wait_for_service()  # here", "if not self.client.service_is_ready():"),
        ("self.client.wait_for_service(1.0)  # here", "if not self.client.service_is_ready():"),
    ],
)
def test_a_timer_that_waits_looks_again_at_its_next_tick(wait: str, condition: str) -> None:
    lines = changed(node(f"def tick(self):\n{indent(wait, '    ')}\n    self.log()"), look_again)
    assert lines is not None
    assert [each[9:] for each in lines if each[0] == "+"] == [condition, "    return"]


def test_in_an_if_it_returns_too() -> None:
    wait = "if self.is_on:\n    if self.asks:\n        a = 1\n    else:\n"
    wait += "        self.client.wait_for_service()  # here\n"
    assert changed(node(f"def tick(self):\n{indent(wait, '    ')}    self.log()"), look_again) == [
        "-                self.client.wait_for_service()  # here",
        "+                if not self.client.service_is_ready():",
        "+                    return",
    ]


def test_what_a_loop_logs_while_it_waits_is_logged_before_the_return() -> None:
    wait = "while not self.client.wait_for_service(timeout_sec=1.0):  # here\n        self.log('no')"
    assert changed(node(f"def tick(self):\n    {wait}\n    self.go()"), look_again) == [
        "-        while not self.client.wait_for_service(timeout_sec=1.0):  # here",
        "+        if not self.client.service_is_ready():",
        "+            return",
    ]


def test_a_service_answers_instead_of_waiting() -> None:
    wait = "self.client.wait_for_service()  # here\n    answer.success = True\n    return answer"
    assert changed(node(f"def serve(self, request, answer):\n    {wait}"), look_again) == [
        "-        self.client.wait_for_service()  # here",
        "+        if not self.client.service_is_ready():",
        "+            return answer",
    ]


def test_a_callback_that_returns_after_a_wait_in_vain_asks_instead() -> None:
    wait = "if not self.client.wait_for_service(timeout_sec=5.0):  # here\n        return"
    assert changed(node(f"def tick(self):\n    {wait}\n    self.go()"), look_again) == [
        "-        if not self.client.wait_for_service(timeout_sec=5.0):  # here",
        "+        if not self.client.service_is_ready():  # here",
    ]


@pytest.mark.parametrize(
    "wait",
    [
        "while True:  # here\n    pass",
        "while rclpy.ok():  # here\n    time.sleep(1)",
        "while not self.ready:  # here\n    self.n += 1",
        "while not done:  # here\n    pass\ndone = 1",
        "for each in self.all:  # here\n    pass",
        "if not self.client.wait_for_service(1.0):  # here\n    self.log('no')",
    ],
)
def test_a_loop_that_does_more_than_to_wait_stays(wait: str) -> None:
    assert changed(node(f"def tick(self):\n{indent(wait, '    ')}"), look_again) is None


@pytest.mark.parametrize(
    "wait",
    [
        "while self.answer is None:  # here\n    pass",
        "while True:  # here\n    if self.answer is not None:\n        break",
    ],
)
def test_what_would_begin_anew_at_each_call_is_not_looked_at_again(wait: str) -> None:
    methods = f"def tick(self):\n    self.answer = None\n{indent(wait, '    ')}"
    assert changed(node(methods), look_again) is None


ASKS = """
def on_answer(self, message):
    self.answer = message

def tick(self):
    self.answer = None
    while self.answer is None:  # here
        rclpy.spin_once(self)
    self.log(self.answer)
"""


def test_what_follows_a_wait_goes_on_in_the_method_that_sets_what_is_waited_for() -> None:
    assert changed(node(ASKS), go_on_where_set) == [
        "+        was_waiting = self.answer is None",
        "+        if was_waiting and self.answer is not None:",
        "+            self.log(self.answer)",
        "-        while self.answer is None:  # here",
        "-            rclpy.spin_once(self)",
        "-        self.log(self.answer)",
    ]


def test_a_wait_in_the_if_that_ends_a_callback_goes_on_there_too() -> None:
    text = """
        def on_done(self, message):
            self.done = message.data

        def step(self):
            self.count += 1
            if self.state == "IDLE":
                self.done = False
                while not self.done:
                    rclpy.spin_once(self, timeout_sec=0.1)  # here
                self.state = "IDLE"
        """
    assert changed(node(text), go_on_where_set) == [
        "+        was_waiting = not self.done",
        "+        if was_waiting and self.done:",
        '+            self.state = "IDLE"',
        "-            while not self.done:",
        "-                rclpy.spin_once(self, timeout_sec=0.1)  # here",
        '-            self.state = "IDLE"',
    ]
    assert changed(node(f"{text.rstrip()}\n            self.count += 1"), go_on_where_set) is None


def test_what_lets_time_pass_in_a_loop_is_not_left_out_alone() -> None:
    loop = "while not self.done:\n        self.spin_once()  # here"
    assert changed(node(f"def step(self):\n    {loop}"), leave_out) is None


def test_the_docstring_of_the_method_that_goes_on_stays_its_first_line() -> None:
    text = node(ASKS.replace("    self.answer = message", '    """Take it."""\n    self.answer = message'))
    result = edited(text, go_on_where_set)
    assert result is not None
    lines = [each.strip() for each in result.splitlines()]
    assert lines.index('"""Take it."""') < lines.index("was_waiting = self.answer is None")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("def on_answer", "def reset(self):\n    self.answer = 0\n\ndef on_answer"),
        ("= message", "= message\n    return True"),
        ("    self.log", "    return self.log"),
        ("        rclpy.spin_once(self)", "        self.ask()"),
        ("    self.answer = None\n", ""),
        ("while self.answer is None", "until = 3\n    while self.answer < until"),
    ],
)
def test_a_wait_that_is_not_just_for_what_one_other_method_sets_stays(old: str, new: str) -> None:
    assert changed(node(ASKS.replace(old, new)), go_on_where_set) is None


def test_an_endless_loop_becomes_one_step_a_call() -> None:
    loop = (
        "while True:  # here\n        if self.level < 1:\n            self.log('low')\n        time.sleep(1)"
    )
    assert changed(node(f"def tick(self):\n    {loop}"), step_by_step) == [
        "-        while True:  # here",
        "-            if self.level < 1:",
        "-                self.log('low')",
        "-            time.sleep(1)",
        "+        if self.level < 1:",
        "+            self.log('low')",
    ]


@pytest.mark.parametrize(
    "body",
    [
        "n = 0\nwhile True:  # here\n    n += 1",
        "while True:  # here\n    if self.ready:\n        break",
        "self.n = 0\nwhile True:  # here\n    self.n += 1",
        "start = time.time()\nwhile True:  # here\n    self.log(time.time() - start)",
        "speed = self.speed\nwhile True:  # here\n    self.log(speed)",
        "twist = Twist()\nwhile True:  # here\n    twist.linear.x += 0.1",
        "seen = Seen()\nwhile True:  # here\n    seen.append(1)",
        "self.timer.cancel()\nwhile True:  # here\n    self.log()",
        "while True:  # here\n    self.log()\nself.log()",
        "while True:  # here\n    self.log()\n    if self.a: break\nself.log()",
        "while True:  # here\n    if self.a:\n        break\n    if self.b:\n        break\nself.log()",
        "while True:  # here\n    self.log()\n    with self.a:\n        if b:\n            break\nself.log()",
        "while self.busy:  # here\n    self.log()",
        "while True:  # here\n    self.log('''a\n    b''')",
    ],
)
def test_a_loop_that_remembers_or_ends_in_several_places_stays(body: str) -> None:
    assert changed(node(f"def tick(self):\n{indent(body, '    ')}"), step_by_step) is None


def test_where_a_loop_ends_the_callback_does_what_follows_and_returns() -> None:
    methods = """
    def tick(self):
        while rclpy.ok():  # here
            # far enough?
            if self.arrived:
                break
            for each in self.all:
                if each:
                    break
            if self.paused: continue
            self.go()
        # well
        self.log("arrived")
    """
    step = """
    def tick(self):
        # far enough?
        if self.arrived:
            # well
            self.log("arrived")
            return
        for each in self.all:
            if each:
                break
        if self.paused: return
        self.go()
    """
    assert edited(node(methods), step_by_step) == node(step)


def test_a_message_that_is_made_before_a_loop_is_made_before_each_step() -> None:
    made = "twist = Twist()\n    twist.linear.x = 0.1"
    methods = f"def tick(self):\n    {made}\n    while True:  # here\n        self.send(twist)"
    step = f"def tick(self):\n    {made}\n    self.send(twist)"
    assert edited(node(methods), step_by_step) == node(step)


TIMER = """
def __init__(self):
    self.rate = self.create_rate(10)
    self.create_timer(1.0, self.tick)

def tick(self):
    while True:  # here
        self.log()
        self.rate.sleep()
"""


@pytest.mark.parametrize(
    ("old", "new", "period"),
    [
        ("self.log", "self.say", "1 / 10"),
        ("self.rate.sleep()", "time.sleep(0.2)", "0.2"),
        ("self.rate.sleep()", "time.sleep(self.pause)", "1.0"),
        ("create_rate(10)", "create_rate(self.hz)", "1.0"),
    ],
)
def test_a_timer_that_does_one_step_at_each_call_has_the_pace_of_the_loop(
    old: str, new: str, period: str
) -> None:
    text = edited(node(TIMER.replace(old, new)), step_by_step)
    assert text is not None
    assert f"self.create_timer({period}, self.tick)" in text
    assert ("create_rate" in text) == (period != "1 / 10")


ROUNDS = """
def __init__(self):
    self.create_timer(1.0, self.tick)

def tick(self):
    for number in range(5):  # here
        self.log(number)
        time.sleep(0.5)
"""


def test_a_loop_over_numbers_becomes_one_round_a_call() -> None:
    assert changed(node(ROUNDS, "import rclpy"), one_round_a_call) == [
        "+from itertools import cycle",
        "+",
        "-        self.create_timer(1.0, self.tick)",
        "+        self.tick_steps = cycle(range(5))",
        "+        self.create_timer(0.5, self.tick)",
        "-        for number in range(5):  # here",
        "-            self.log(number)",
        "-            time.sleep(0.5)",
        "+        number = next(self.tick_steps)",
        "+        self.log(number)",
    ]


@pytest.mark.parametrize(("rounds", "count"), [("range(5)", 5), ("['a', 'b']", 2), ("range(2, 5)", 0)])
def test_a_loop_that_may_be_over_before_the_next_call_stays(rounds: str, count: int) -> None:
    text = node(ROUNDS.replace("range(5)", rounds))
    assert changed(text, one_round_a_call, count) is not None
    assert changed(text, one_round_a_call, count + 1) is None


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("range(5)", "self.all"),
        ("        self.log(number)", "        if number:\n            break"),
        ("        time.sleep(0.5)", "        time.sleep(0.5)\n    self.log()"),
        ("        time.sleep(0.5)", "        pass\n        time.sleep(0.5)"),
        ("create_timer(1.0", "create_subscription(String, 'a'"),
    ],
)
def test_a_loop_whose_rounds_are_not_known_stays(old: str, new: str) -> None:
    assert changed(node(ROUNDS.replace(old, new)), one_round_a_call) is None


@pytest.mark.parametrize(
    ("loop", "asleep"),
    [
        ("while not self.done:  # here\n    pass  # yet", ["sleep(0.01)  # yet"]),
        ("while not self.done: pass  # here", ["while not self.done: sleep(0.01)  # here"]),
        ("while self.x is None:  # here\n    self.log.info('no')", ["sleep(0.01)"]),
        ("while True:  # here\n    if self.done:\n        break", ["sleep(0.01)"]),
    ],
)
def test_a_loop_that_only_asks_sleeps_in_each_round(loop: str, asleep: list[str]) -> None:
    lines = changed(node(f"def tick(self):\n{indent(loop, '    ')}"), sleep_in_loop)
    assert lines is not None
    assert [each[1:].strip() for each in lines if each[0] == "+"] == ["from time import sleep", "", *asleep]


def test_a_loop_sleeps_by_the_module_that_is_imported() -> None:
    text = node("def tick(self):\n    while not self.done:  # here\n        pass", "import time")
    assert changed(text, sleep_in_loop) == ["-            pass", "+            time.sleep(0.01)"]


@pytest.mark.parametrize(
    "loop",
    [
        "while not self.done:  # here\n    time.sleep(0.1)",
        "while not self.client.wait_for_service(1.0):  # here\n    self.log.info('no')",
        "while self.n < 9:  # here\n    self.n += 1",
        "while not self.done:  # here\n    self.step()",
    ],
)
def test_a_loop_that_sleeps_or_works_is_left_as_it_is(loop: str) -> None:
    assert changed(node(f"def tick(self):\n{indent(loop, '    ')}"), sleep_in_loop) is None


@pytest.mark.parametrize(
    ("asks", "sets", "found"),
    [
        ("not self.done", "self.done = True", ("on_done",)),
        ("not self.done", "self.count = 1", ()),
        ("not done", "global done\n    done = True", ("on_done",)),
        ("not done", "done = True", ()),
        ("self.last is None or self.last.data == 0", "self.last, self.n = 1, 2", ("on_done",)),
        ("'base' not in self.poses", "self.poses['base'] = 1", ("on_done",)),
        ("not self.jobs", "self.jobs.append(1)", ("on_done",)),
        ("not self.opened.done()", "self.opened.set_result(1)", ("on_done",)),
        ("not self.jobs", "print(self.jobs.count(1))", ()),
    ],
)
def test_it_is_known_who_sets_what_a_loop_asks(
    asks: str, sets: str, found: tuple[str, ...], tmp_path: Path
) -> None:
    path = tmp_path / "node.py"
    waits = f"def tick(self):\n    while {asks}:\n        time.sleep(0.1)\n"
    path.write_text(f"def __init__(self):\n    self.done = None\n\n{waits}\ndef on_done(self):\n    {sets}\n")
    assert setters(str(path), 5) == found


def test_who_sets_what_a_loop_that_works_asks_is_nothing_that_it_waits_for(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(
        "def tick(self):\n    while self.on:\n        self.step()\n\ndef off(self):\n    self.on = 0\n"
    )
    assert setters(str(path), 2) == ()
    assert setters(str(tmp_path / "no.py"), 2) == ()
