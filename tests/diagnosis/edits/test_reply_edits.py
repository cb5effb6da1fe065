"""Edits of callbacks that await a reply, with all the functions between them and the wait."""

from textwrap import dedent

import pytest

from sim.diagnosis.edits.replies import await_reply
from tests.diagnosis.edits.edited_source import MARK, changed, node

TIMER = "def __init__(self):\n    self.create_timer(1.0, self.tick)"
HELPER = """
def ask(self):
    future = self.client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(self, future)  # here
    return future.result()
"""


def test_a_call_is_awaited_wherever_it_is_in_a_group_of_its_own() -> None:
    text = node(
        """
        def __init__(self):
            self.create_service(SetBool, "serve", self.serve)

        def serve(self, request, response):
            for each in self.clients:
                if each.call(request).success:  # here
                    pass
                reply = each.call(request)
            return response
        """
    )
    made = 6
    assert changed(text, await_reply, made) is None
    assert changed(
        text.replace(f"  {MARK}", "").replace(
            "reply = each.call(request)", f"reply = each.call(request)  {MARK}"
        ),
        await_reply,
        made,
    ) == [
        "+from rclpy.callback_groups import MutuallyExclusiveCallbackGroup",
        '-        self.create_service(SetBool, "serve", self.serve)',
        '+        self.create_service(SetBool, "serve", self.serve, '
        "callback_group=MutuallyExclusiveCallbackGroup())",
        "-    def serve(self, request, response):",
        "+    async def serve(self, request, response):",
        "-            reply = each.call(request)  # here",
        "+            reply = await each.call_async(request)  # here",
    ]


def test_a_loop_that_waits_for_a_future_is_one_await() -> None:
    text = node(
        """
        def __init__(self):
            self.create_timer(1.0, self.tick, self.group)

        def tick(self):
            while not future.done():
                time.sleep(0.1)  # here
            self.log()
        """
    )
    assert changed(text, await_reply, 6) == [
        "+from rclpy.callback_groups import MutuallyExclusiveCallbackGroup",
        "-        self.create_timer(1.0, self.tick, self.group)",
        "+        self.create_timer(1.0, self.tick, MutuallyExclusiveCallbackGroup())",
        "-    def tick(self):",
        "-        while not future.done():",
        "-            time.sleep(0.1)  # here",
        "+    async def tick(self):",
        "+        await future  # here",
    ]


def test_nothing_is_awaited_with_a_lock() -> None:
    call = "with self.lock:\n        self.client.call(Trigger.Request())  # here"
    assert changed(node(f"{TIMER}\n\ndef tick(self):\n    {call}"), await_reply, 6) is None


def with_helper(callbacks: str, timers: str = TIMER) -> str:
    return node("\n".join((timers, HELPER, dedent(callbacks))))


def test_all_that_calls_what_waits_awaits_it_up_to_the_callbacks_which_get_groups() -> None:
    timers = f"{TIMER}\n    self.create_timer(2.0, self.tock, callback_group=None)"
    text = with_helper(
        """
        def name(self):
            return self.ask().message

        def tick(self):
            self.log(self.name())

        def tock(self):
            reply = self.ask()
        """,
        timers,
    )
    assert changed(text, await_reply, 6) == [
        "+from rclpy.callback_groups import MutuallyExclusiveCallbackGroup",
        "-        self.create_timer(1.0, self.tick)",
        "-        self.create_timer(2.0, self.tock, callback_group=None)",
        "+        self.create_timer(1.0, self.tick, callback_group=MutuallyExclusiveCallbackGroup())",
        "+        self.create_timer(2.0, self.tock, callback_group=MutuallyExclusiveCallbackGroup())",
        "-    def ask(self):",
        "+    async def ask(self):",
        "-        rclpy.spin_until_future_complete(self, future)  # here",
        "+        await future  # here",
        "-    def name(self):",
        "-        return self.ask().message",
        "+    async def name(self):",
        "+        return (await self.ask()).message",
        "-    def tick(self):",
        "-        self.log(self.name())",
        "+    async def tick(self):",
        "+        self.log(await self.name())",
        "-    def tock(self):",
        "-        reply = self.ask()",
        "+    async def tock(self):",
        "+        reply = await self.ask()",
    ]


@pytest.mark.parametrize(
    "callbacks",
    [
        "def tick(self):\n    self.ask()\n\ndef start(self):\n    self.ask()",
        "def tick(self):\n    self.ask()\n\ndef start(self):\n    Thread(target=self.ask).start()",
        "def tick(self):\n    self.ask()\n\ndef start(self):\n    self.tick()",
        "def tick(self):\n    with self.lock:\n        self.ask()",
        "def tick(self):\n    self.log(lambda: self.ask())",
        "def tick(self):\n    self.log(f'{self.ask()}')",
        "@guarded\ndef tick(self):\n    self.ask()",
        "def tick(self):\n    self.ask()\n\nclass Other:\n    def ask(self): pass",
    ],
)
def test_nothing_is_awaited_where_somebody_could_not(callbacks: str) -> None:
    assert changed(with_helper(callbacks), await_reply, 6) is None


def test_what_a_constructor_or_the_program_calls_stays_a_function() -> None:
    tick = "def tick(self):\n    self.ask()"
    assert changed(with_helper(tick, f"{TIMER}\n    self.ask()"), await_reply, 6) is None
    assert changed(f"{with_helper(tick)}\n\nRobot().ask()\n", await_reply, 6) is None
