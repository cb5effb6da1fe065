"""Edits of callbacks that take locks."""

from textwrap import dedent, indent

import pytest

from sim.diagnosis.edits.locks import (
    let_go_during_wait,
    make_one,
    make_reentrant,
    release_during_wait,
    take_before,
    take_by_one_with,
    take_by_with,
    take_early,
    take_together,
)
from tests.diagnosis.edits.edited_source import changed, edited, node

LOCKS = """
def move(self):
    with self.arm:
        self.a()
        # then
        with self.camera:  # here
            # both
            self.b()
            if self.c:

                self.d()

def look(self):
    with self.camera:
        with self.arm:
            self.e()
"""


def test_both_locks_are_taken_at_once_in_the_order_of_the_other_callback() -> None:
    text = node(LOCKS)
    other = next(number for number, each in enumerate(text.splitlines(), 1) if "self.e()" in each)
    assert changed(text, take_together, other) == [
        "-        with self.arm:",
        "+        with self.camera, self.arm:",
        "-            with self.camera:  # here",
        "-                # both",
        "-                self.b()",
        "-                if self.c:",
        "+            # both",
        "+            self.b()",
        "+            if self.c:",
        "-                    self.d()",
        "+                self.d()",
    ]
    assert changed(text.replace("self.b()", "self.b('''\n''')"), take_together, other + 1) is None
    assert (
        changed(
            text.replace("with self.arm:\n                self.e", "with self.lid:\n                self.e"),
            take_together,
            other,
        )
        is None
    )


def test_what_is_no_lock_is_kept_during_a_call() -> None:
    block = holding("self.client.call(Trigger.Request())  # here").replace("threading.Lock()", "self.open()")
    assert changed(block, let_go_during_wait) is None


def test_a_lock_that_its_holder_takes_again_becomes_reentrant() -> None:
    text = node(
        "def __init__(self):\n    self.lock = threading.Lock()\n\n"
        "def tick(self):\n    with self.lock:  # here\n        pass"
    )
    assert changed(text, make_reentrant) == [
        "-        self.lock = threading.Lock()",
        "+        self.lock = threading.RLock()",
    ]
    assert changed(text.replace("threading.Lock()", "make()"), make_reentrant) is None


def holding(block: str) -> str:
    """A callback that holds a lock while it runs a block of code."""
    held = indent(dedent(block).strip(), " " * 8)
    made = "def __init__(self):\n    self.lock = threading.Lock()"
    return node(f"{made}\n\ndef tick(self):\n    with self.lock:\n{held}")


def test_a_lock_is_let_go_of_during_a_call_and_taken_again() -> None:
    block = """
    self.asked += 1
    request = Trigger.Request()
    # ask
    reply = self.client.call(request)  # here
    self.log(reply)
    """
    assert changed(holding(block), let_go_during_wait) == [
        "-            reply = self.client.call(request)  # here",
        "+        reply = self.client.call(request)  # here",
        "+        with self.lock:",
    ]


@pytest.mark.parametrize(
    ("block", "lines"),
    [
        (
            "# ask\nself.client.call(Trigger.Request())  # here",
            [
                "-        with self.lock:",
                "-            # ask",
                "-            self.client.call(Trigger.Request())  # here",
                "+        # ask",
                "+        self.client.call(Trigger.Request())  # here",
            ],
        ),
        (
            "self.answer = self.client.call(Trigger.Request()).success  # here",
            [
                "+        reply = self.client.call(Trigger.Request())",
                "-            self.answer = self.client.call(Trigger.Request()).success  # here",
                "+            self.answer = reply.success  # here",
            ],
        ),
        (
            "future = self.ask()\nwhile not future.done():\n    time.sleep(0.1)  # here\nself.log()",
            [
                "-            while not future.done():",
                "-                time.sleep(0.1)  # here",
                "+        while not future.done():",
                "+            time.sleep(0.1)  # here",
                "+        with self.lock:",
            ],
        ),
        ("self.client.call(self.request)  # here", None),
        ("if self.on:\n    self.client.call(Trigger.Request())  # here", None),
        ("with self.other:\n    self.client.call(Trigger.Request())  # here", None),
        ("reply = 1\nself.answer = self.client.call(Trigger.Request()).success  # here", None),
        ("self.opened.wait()  # here", None),
    ],
)
def test_what_needs_the_lock_keeps_it_during_a_call(block: str, lines: list[str] | None) -> None:
    assert changed(holding(block), let_go_during_wait) == lines


@pytest.mark.parametrize("request_", ["Trigger.Request()", "self.asked"])
def test_a_lock_that_acquire_takes_is_released_during_a_call_that_is_known_without_it(request_: str) -> None:
    call = f"    reply = self.client.call({request_})  # here\n"
    released = changed(
        node(
            f"def tick(self):\n    self.lock.acquire()\n    try:\n    {call}"
            "    finally:\n        self.lock.release()"
        ),
        release_during_wait,
    )
    added = ["+            self.lock.release()", "+            self.lock.acquire()"]
    assert released == (None if "self" in request_ else added)
    assert changed(node(f"def tick(self):\n{call}    self.lock.acquire()"), release_during_wait) is None


BY_ACQUIRE = node(
    """
    def pay(self):
        self.a.acquire()
        self.count()
        self.b.acquire()  # here
        self.b.release()
        self.a.release()

    def earn(self):
        self.b.acquire()
        self.a.acquire()  # there
        self.a.release()
        self.b.release()
    """
)


def line_with(text: str, mark: str) -> int:
    return next(number for number, each in enumerate(text.splitlines(), 1) if mark in each)


def test_locks_taken_by_acquire_are_taken_in_the_order_of_the_other_callback() -> None:
    assert changed(BY_ACQUIRE, take_before, line_with(BY_ACQUIRE, "# there")) == [
        "+        self.b.acquire()  # here",
        "-        self.b.acquire()  # here",
    ]


@pytest.mark.parametrize(
    ("line", "instead"),
    [
        ("self.a.acquire()  # there", "self.c.acquire()  # there"),
        (
            "        self.b.acquire()  # here",
            "        try:\n            self.b.acquire()  # here\n        finally: pass",
        ),
    ],
)
def test_locks_are_not_moved_out_of_a_try_nor_to_another_order(line: str, instead: str) -> None:
    text = BY_ACQUIRE.replace(line, instead)
    assert changed(text, take_before, line_with(text, "# there")) is None


BY_TRY = node(
    """
    def pay(self):
        self.a.acquire()
        try:
            self.count()
            self.b.acquire()  # there
            try:
                self.add()
                self.log()
            finally:
                self.b.release()
        finally:
            self.a.release()

    def earn(self):
        self.b.acquire()
        try:
            self.a.acquire()  # here
            try:
                self.add()
            finally:
                self.a.release()
        finally:
            self.b.release()
    """
)


SWAPPED = BY_TRY.replace("# here", "# -").replace("# there", "# here").replace("# -", "# there")


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        (BY_TRY, ["with self.a, self.b:", "    self.add()"]),
        (SWAPPED, ["with self.b, self.a:", "    self.add()", "    self.log()"]),
    ],
)
def test_locks_that_a_try_releases_are_taken_by_one_with(text: str, lines: list[str]) -> None:
    found = changed(text, take_by_one_with, line_with(text, "# there"))
    assert found is not None
    assert [each[1:] for each in found if each[0] == "+"] == [f"        {each}" for each in lines]


@pytest.mark.parametrize(
    ("part", "instead"),
    [
        ("self.a.release()\n        finally", "self.a.release()\n            self.log()\n        finally"),
        ("            self.a.acquire()  # here\n", "            self.log()  # here\n"),
        ("self.a.acquire()  # here", "self.c.acquire()  # here"),
        (
            "        self.b.acquire()\n        try",
            "        self.b.acquire()\n        self.log()\n        try",
        ),
    ],
)
def test_locks_that_a_try_releases_are_left_where_more_is_done(part: str, instead: str) -> None:
    text = BY_TRY.replace(part, instead)
    assert text != BY_TRY
    assert changed(text, take_by_one_with, line_with(text, "# there")) is None


def test_a_lock_is_taken_by_with_up_to_its_last_release() -> None:
    text = node(
        """
        def tick(self):
            self.lock.acquire()  # here
            if self.full:
                self.lock.release()
                return
            # count
            self.n += 1
            self.lock.release()
        """
    )
    assert (edited(text, take_by_with) or "").splitlines()[5:] == [
        "        with self.lock:",
        "            if self.full:",
        "                return",
        "            # count",
        "            self.n += 1",
    ]


@pytest.mark.parametrize(
    "body",
    [
        "self.lock.acquire()  # here\nself.n += 1",
        "self.lock.acquire()  # here\nself.lock.release()",
        "self.lock.acquire()  # here\nself.n += 1\nself.lock.release()\nself.show()",
        "self.lock.acquire()  # here\nself.lock.release()\nself.lock.acquire()\nself.lock.release()",
        "if self.lock.acquire(False):  # here\n    self.lock.release()",
    ],
)
def test_a_lock_that_is_not_released_last_stays_as_it_is(body: str) -> None:
    assert changed(node(f"def tick(self):\n{indent(body, '    ')}"), take_by_with) is None


def test_a_lock_that_one_function_alone_acquires_is_not_made_reentrant() -> None:
    text = node(
        "def tick(self):\n    self.lock.acquire()  # here", "import threading\nself.lock = threading.Lock()"
    )
    assert changed(text, make_reentrant) is None


HELPERS = """
def __init__(self):
    self.arm = threading.Lock()
    self.camera = threading.Lock()

def move(self):
    with self.arm:
        self.step()

def step(self):
    self.take()

def take(self):
    with self.camera:  # here
        self.b()

def look(self):
    with self.camera:
        self.turn()

def turn(self):
    with self.arm:
        self.c()
"""


def test_a_lock_that_a_helper_takes_is_taken_before_by_what_calls_it() -> None:
    text = node(HELPERS)
    callers = line_with(text, "self.step()"), line_with(text, "self.take()")
    turned = line_with(text, "self.c()") - 1
    assert changed(text, take_early, turned, *callers) == [
        "-        self.camera = threading.Lock()",
        "+        self.camera = threading.RLock()",
        "-        with self.arm:",
        "+        with self.camera, self.arm:",
    ]
    assert changed(text, take_early, turned) is None
    free = text.replace("with self.arm:\n            self.step", "if 1:\n            self.step")
    assert changed(free, take_early, turned, *callers) is None
    moved = text.replace("    def take", "class Other:\n    def take")
    assert changed(moved, take_early, turned + 1, callers[0], callers[1]) is None


@pytest.mark.parametrize(
    ("imports", "made", "one"),
    [
        ("import threading", "threading.Lock()", "threading.RLock()"),
        ("from threading import Lock", "Lock()", "RLock()"),
    ],
)
def test_two_locks_become_one_which_its_holder_may_take_again(imports: str, made: str, one: str) -> None:
    text = node(HELPERS.replace("threading.Lock()", made), imports)
    lines = changed(text, make_one, line_with(text, "self.c()") - 1)
    assert lines is not None
    assert [each for each in lines if each[0] == "+" and "import" not in each] == [
        f"+        self.arm = {one}",
        "+        self.camera = self.arm",
    ]
    assert [each for each in lines if "import" in each] == (
        [] if "import t" in imports else ["-from threading import Lock", "+from threading import RLock"]
    )


@pytest.mark.parametrize(
    "made",
    [
        "self.camera = make_lock()",
        "self.camera = self.arm",
        "pass\n\ndef more(self):\n    self.camera = Lock()",
    ],
)
def test_only_locks_that_are_made_side_by_side_become_one(made: str) -> None:
    text = node(HELPERS.replace("self.camera = threading.Lock()", indent(made, "    ").strip()))
    assert changed(text, make_one, line_with(text, "self.c()") - 1) is None
