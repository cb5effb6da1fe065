"""Edits of source: the lines that change, layout and comments that stay, and the shapes that are refused."""

import ast
from collections.abc import Callable
from pathlib import Path
from textwrap import indent

import pytest

from sim.diagnosis.edits.code_edit import CodeEdit
from sim.diagnosis.edits.functions import await_coroutine, fit_parameters, hand_over_function, return_response
from sim.diagnosis.edits.groups import give_own_group
from sim.diagnosis.edits.locks import make_reentrant
from sim.diagnosis.edits.names import rename, rename_definition
from sim.diagnosis.edits.polling import leave_out, step_by_step
from sim.diagnosis.edits.replies import await_reply, go_on_in_done_callback, use_in_done_callback
from tests.diagnosis.edits.edited_source import changed, edited, node


def test_what_follows_a_call_goes_on_in_a_done_callback_with_its_comments() -> None:
    text = node(
        """
        def tick(self):
            request = Trigger.Request()
            # ask
            reply = self.client.call(request)  # here
            # and tell
            if reply.success:
                self.log(reply)  # well
        """
    )
    assert changed(text, go_on_in_done_callback) == [
        "-        reply = self.client.call(request)  # here",
        "+        future = self.client.call_async(request)  # here",
        "+        future.add_done_callback(self.on_reply)",
        "+",
        "+    def on_reply(self, future):",
        "+        reply = future.result()",
    ]


def test_a_reply_that_nobody_uses_needs_no_done_callback() -> None:
    text = node("def tick(self):\n    self.client.call(Trigger.Request())  # here")
    assert changed(text, go_on_in_done_callback) == [
        "-        self.client.call(Trigger.Request())  # here",
        "+        self.client.call_async(Trigger.Request())  # here",
    ]


def test_the_names_of_a_done_callback_and_its_future_are_new() -> None:
    text = node(
        """
        def tick(self):
            future = 1
            self.reply = self.client.call(Trigger.Request())  # here

        def on_reply(self): pass
        """
    )
    lines = changed(text, go_on_in_done_callback)
    assert lines is not None
    assert "+        reply_future.add_done_callback(self.tick_reply)" in lines
    assert "+        self.reply = reply_future.result()" in lines


@pytest.mark.parametrize(
    "methods",
    [
        "def serve(self, request, response):\n    self.client.call(request)  # here\n    return response",
        "def tick(self):\n    n = 1\n    self.client.call(Trigger.Request())  # here\n    self.log(n)",
        "def tick(self):\n    if self.on:\n        self.client.call(Trigger.Request())  # here",
        "def tick(self):\n    self.client.call(Trigger.Request(), timeout_sec=1.0)  # here",
        "def tick(self):\n    self.client.call(Trigger.Request()); self.log()  # here",
        "def ask(self):\n    self.client.call(Trigger.Request())  # here\n\ndef tick(self):\n    self.ask()",
        "@guarded\ndef tick(self):\n    self.client.call(Trigger.Request())  # here",
        "def tick(self):\n    self.client.send_goal(Fibonacci.Goal())  # here",
    ],
)
def test_what_is_not_simple_is_not_moved(methods: str) -> None:
    assert changed(node(methods), go_on_in_done_callback) is None


def test_the_use_of_a_result_moves_into_a_done_callback_with_what_follows() -> None:
    text = node(
        """
        def tick(self):
            future = self.client.call_async(Trigger.Request())
            # ask
            reply = future.result()
            if reply.success:  # here
                self.log(reply)  # well
        """
    )
    assert changed(text, use_in_done_callback, "success") == [
        "+        future.add_done_callback(self.on_reply)",
        "+",
        "+    def on_reply(self, future):",
    ]


@pytest.mark.parametrize(
    "methods",
    [
        "def tick(self):\n    self.log(self.future.result().success)  # here",
        "def tick(self):\n    n = 1\n    f = self.ask()\n    self.log(f.result().success, n)  # here",
        "def tick(self):\n    self.log(self.last.success)  # here",
        "def ask(self):\n    f = self.client.call_async(1)\n    return f.result()\n\n"
        "def tick(self):\n    reply = self.ask()\n    self.log(reply.success)  # here",
    ],
)
def test_a_use_of_a_result_that_is_not_simple_is_not_moved(methods: str) -> None:
    assert changed(node(methods), use_in_done_callback, "success") is None


def test_a_function_of_no_class_and_what_is_no_python_is_not_edited() -> None:
    assert changed("def tick(self):\n    self.client.call(1)  # here\n", await_reply, 1) is None
    assert CodeEdit("a.py", "", await_reply, (1, 1)).applied("def tick(") is None
    assert CodeEdit("a.py", "", await_reply, (1, 1)).applied("") is None


@pytest.mark.parametrize(
    "change", [leave_out, fit_parameters, return_response, hand_over_function, make_reentrant, step_by_step]
)
def test_a_line_that_a_changed_file_has_no_more_and_any_other_are_no_error(
    change: Callable[..., None],
) -> None:
    for path in sorted((Path(__file__).parents[1] / "beginners").glob("l*.py")):
        text = path.read_text()
        for line in range(-1, text.count("\n") + 4):
            new = CodeEdit(str(path), "", change, (line,)).applied(text)
            assert new is None or ast.parse(new)


@pytest.mark.parametrize(
    ("made", "given"),
    [
        ("self.create_timer(1.0, self.tick, callback_group=self.group)  # here", "callback_group="),
        (
            "ActionServer(\n    self, Count, 'count', self.count,  # here\n)",
            "self.count, callback_group=",
        ),
        ("self.make_timer(self.tick)  # here", None),
    ],
)
def test_whatever_takes_a_group_is_given_its_own(made: str, given: str | None) -> None:
    text = edited(node(f"def __init__(self):\n{indent(made, '    ')}"), give_own_group)
    assert text is None if given is None else f"{given}MutuallyExclusiveCallbackGroup()" in (text or "")


def test_a_spin_is_left_out_and_a_body_is_never_empty() -> None:
    assert changed(node("def tick(self):\n    rclpy.spin_once(self)  # here\n    self.log()"), leave_out) == [
        "-        rclpy.spin_once(self)  # here"
    ]
    assert changed(node("def tick(self):\n    rclpy.spin_once(self)  # here"), leave_out) == [
        "-        rclpy.spin_once(self)  # here",
        "+        pass",
    ]
    assert changed(node("def tick(self):\n    done = rclpy.spin_once(self)  # here"), leave_out) is None


@pytest.mark.parametrize(
    ("written", "new", "renamed"),
    [
        ("'chattr'", "/chatter", "'chatter'"),
        ('"/chattr"', "/chatter", '"/chatter"'),
        ("'chattr'", "/robot/chatter", "'/robot/chatter'"),
    ],
)
def test_a_name_is_replaced_as_it_was_written(written: str, new: str, renamed: str) -> None:
    made = f"def __init__(self):\n    self.create_subscription(String, {written}, self.hear, 10)  # here"
    lines = changed(node(made), rename, "/chattr", new)
    assert lines is not None
    assert f"String, {renamed}, self.hear" in lines[1]


def test_a_name_that_is_not_written_at_the_line_stays() -> None:
    made = "def __init__(self):\n    self.create_subscription(String, TOPIC, self.hear, 10)  # here"
    assert changed(node(made), rename, "/chattr", "/chatter") is None


@pytest.mark.parametrize(
    ("definition", "made", "fitted"),
    [
        ("def on(self):", "create_subscription(String, 'a', self.on, 10)", "def on(self, message):"),
        ("def on(self, a, b):", "create_timer(1.0, self.on)", "def on(self):"),
        (
            "def on(self, request):",
            "create_service(Trigger, 'a', self.on)",
            "def on(self, request, response):",
        ),
        ("def on(self):", "ask().add_done_callback(self.on)", "def on(self, future):"),
        ("def on():", "create_timer(1.0, self.on)", "def on(self):"),
        ("def on():", "create_subscription(String, 'a', self.on, 10)", "def on(self, message):"),
        ("def on(msg):", "create_subscription(String, 'a', self.on, 10)", "def on(self, msg):"),
        ("def on(request):", "create_service(Trigger, 'a', self.on)", "def on(self, request, response):"),
        ("def on(cls):", "create_subscription(String, 'a', self.on, 10)", "def on(cls, message):"),
        ("def on(self, a, used):", "create_timer(1.0, self.on)", None),
        ("def on(self, *all):", "create_timer(1.0, self.on)", None),
        ("def on(self):", "create_timer(1.0, self.on)", None),
        ("def on(self, a):", "create(self.on)", None),
    ],
)
def test_a_callback_gets_the_parameters_it_is_called_with(
    definition: str, made: str, fitted: str | None
) -> None:
    text = node(f"def __init__(self):\n    self.{made}\n\n{definition}  # here\n    print('x', used)\n")
    expected = None if fitted is None else [f"-    {definition}  # here", f"+    {fitted}  # here"]
    if fitted and "response" in fitted:
        expected = [*(expected or ()), "+        return response"]
    assert changed(text, fit_parameters) == expected


def test_a_lambda_gets_the_parameters_it_lacks() -> None:
    text = node("def tick(self):\n    self.ask().add_done_callback(lambda: self.log())  # here")
    assert changed(text, fit_parameters) == [
        "-        self.ask().add_done_callback(lambda: self.log())  # here",
        "+        self.ask().add_done_callback(lambda future: self.log())  # here",
    ]


@pytest.mark.parametrize(
    ("made", "handed_over"),
    [
        ("self.create_timer(0.5, self.tick())", "self.create_timer(0.5, self.tick)"),
        ("self.create_timer(self.period(), self.tick())", None),
        ("self.create_timer(0.5, self.tick(1))", None),
    ],
)
def test_a_function_is_handed_over_without_being_called(made: str, handed_over: str | None) -> None:
    text = node(f"def __init__(self):\n    {made}  # here")
    expected = [f"-        {made}  # here", f"+        {handed_over}  # here"] if handed_over else None
    assert changed(text, hand_over_function) == expected


def test_a_service_returns_its_response() -> None:
    text = node(
        "def serve(self, request, answer):  # here\n    if request.data:\n        answer.success = True"
    )
    assert changed(text, return_response) == ["+        return answer"]
    assert changed(text.replace("answer.success = True", "return None"), return_response) is None


def test_what_hides_a_name_of_a_node_gets_another_one_wherever_it_is_used() -> None:
    text = node(
        """
        def __init__(self):
            self.create_timer(1.0, self.handle)

        def handle(self):  # here
            self.door.handle()
        """
    )
    assert changed(text, rename_definition, False) is None
    assert changed(text, rename_definition, True) == [
        "-        self.create_timer(1.0, self.handle)",
        "+        self.create_timer(1.0, self.my_handle)",
        "-    def handle(self):  # here",
        "+    def my_handle(self):  # here",
    ]
    assert changed(node("handle = None  # here"), rename_definition, False) == [
        "-    handle = None  # here",
        "+    my_handle = None  # here",
    ]
    assert changed("def handle():  # here\n    pass\n", rename_definition, True) is None


SCRIPT = "import rclpy\n\n\n{0}  # here\n    answer.success = True\n\n\nnode.{1}\n"


@pytest.mark.parametrize(
    ("definition", "made", "fitting"),
    [
        ("def hear():", "create_subscription(String, 'a', hear, 10)", "def hear(message):"),
        ("def tick(event):", "create_timer(1.0, tick)", "def tick():"),
        ("def tick(now, then):", "create_timer(1.0, tick)", "def tick():"),
        ("def pong(request):", "create_service(Ping, 'p', pong)", "def pong(request, response):"),
        ("def pong(a, b, c):", "create_service(Ping, 'p', pong)", "def pong(a, b):"),
        ("def tick ():", "create_subscription(String, 'a', tick, 10)", None),
        ("def tick(answer):", "create_timer(1.0, tick)", None),
        ("def tick(event):", "create_timer(1.0, tick)\ntick(3)", None),
    ],
)
def test_a_function_of_no_class_gets_the_parameters_that_it_is_called_with(
    definition: str, made: str, fitting: str | None
) -> None:
    lines = changed(SCRIPT.format(definition, made), fit_parameters)
    returned = ["+    return response"] if "response" in (fitting or "") else []
    assert lines == (fitting and [f"-{definition}  # here", f"+{fitting}  # here", *returned])


def test_a_function_of_no_class_returns_its_response() -> None:
    text = SCRIPT.format("def pong(request, answer):", "create_service(Ping, 'p', pong)")
    assert changed(text, return_response) == ["+    return answer"]


@pytest.mark.parametrize(
    ("asked", "awaited"),
    [
        ("total = self.client.call(request).sum", "total = (await self.client.call_async(request)).sum"),
        ("return self.client.call(request)", "return await self.client.call_async(request)"),
    ],
)
def test_what_is_taken_from_a_reply_is_taken_once_that_is_there(asked: str, awaited: str) -> None:
    text = node(
        f"""
        def __init__(self):
            self.create_timer(1.0, self.tick)

        def tick(self):
            {asked}  # here
        """
    )
    made = next(n for n, each in enumerate(text.splitlines(), 1) if "create_timer" in each)
    assert f"+        {awaited}  # here" in (changed(text, await_reply, made) or [])


@pytest.mark.parametrize(
    ("statement", "awaited"),
    [
        ("self.look()", "await self.look()"),
        ("on = self.look() and self.on", "on = await self.look() and self.on"),
        ("asyncio.run(self.look())", None),
        ("self.look().result()", None),
        ("found = lambda: self.look()", None),
    ],
)
def test_a_coroutine_that_a_callback_drops_is_awaited_where_it_is_made_and_not_handed_on(
    statement: str, awaited: str | None
) -> None:
    text = node(
        f"""
        async def look(self):
            return True

        def tick(self):
            {statement}  # here
        """
    )
    lines = ["-    def tick(self):", f"-        {statement}  # here"]
    lines += ["+    async def tick(self):", f"+        {awaited}  # here"]
    assert changed(text, await_coroutine) == (lines if awaited else None)
    assert changed(text.replace("return True", "self.tick()"), await_coroutine) is None
