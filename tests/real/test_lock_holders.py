"""The holder of a lock is found in frames and source on real rclpy, and told as on the model."""

import os
import re
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from sim.diagnosis import Weight, diagnose
from sim.probes.on_path.cbtui_probe.callbacks import is_own
from sim.probes.on_path.cbtui_probe.locks import HeldLocks, Holder, wanted_lock
from tests.real import programs


class Store:
    """Something with locks, and threads that stand in its methods."""

    def __init__(self) -> None:
        self.lock, self.other = threading.Lock(), threading.Lock()
        self.again = threading.RLock()
        self.changed = threading.Condition(self.lock)
        self.__own = threading.Lock()
        self.end = threading.Event()

    def keeps(self) -> None:
        with self.lock:
            self.end.wait()

    def keeps_own(self) -> None:
        with self.__own:
            self.end.wait()

    def keeps_two(self) -> None:
        with self.other, self.lock:
            self.end.wait()

    def keeps_by_name(self) -> None:
        lock = self.lock
        with lock:
            self.inner()

    def inner(self) -> None:
        self.end.wait()

    def keeps_again(self) -> None:
        with self.again:
            self.end.wait()

    def left(self) -> None:
        with self.lock:
            pass
        self.end.wait()

    def lets_go(self) -> None:
        with self.lock:
            self.lock.release()
            self.end.wait()
            self.lock.acquire()

    def waits_for_change(self) -> None:
        with self.changed:
            self.changed.wait()

    def wants(self) -> None:
        with self.lock:
            pass

    def wants_own(self) -> None:
        with self.__own:
            pass

    def wants_by_call(self) -> None:
        self.lock.acquire()
        self.lock.release()

    def wants_for_a_while(self) -> None:
        if self.lock.acquire(timeout=5.0):
            self.lock.release()

    def wants_by_condition(self) -> None:
        with self.changed:
            pass

    def wants_again(self) -> None:
        with self.again:
            pass

    def takes_twice(self) -> None:
        with self.other:
            self.wants_other()

    def wants_other(self) -> None:
        with self.other:
            pass

    async def awaits(self, done: "Later") -> None:
        with self.lock:
            await done


class Later:
    """What a coroutine can await for ever."""

    def __await__(self) -> Generator[None]:
        yield


@contextmanager
def standing(store: Store, *methods: Callable[[], None]) -> Iterator[list[int]]:
    """Threads that stand in methods, one begun after the other, by their identifiers."""
    threads = [threading.Thread(target=each, daemon=True) for each in methods]
    for thread in threads:
        thread.start()
        time.sleep(0.05)
    try:
        yield [thread.ident or 0 for thread in threads]
    finally:
        store.end.set()


def frames() -> dict[int, FrameType]:
    return sys._current_frames()


def own_frame(ident: int) -> FrameType:
    top: FrameType | None = frames()[ident]
    while top is not None and not is_own(top):
        top = top.f_back
    assert top is not None
    return top


def holder(waiting: int, suspended: dict[Any, int] | None = None) -> Holder | None:
    lock = wanted_lock(own_frame(waiting))
    return None if lock is None else HeldLocks(frames(), suspended or {}, is_own).holder_of(lock, waiting)


def line_of(method: Callable[[], None], *, after: int) -> tuple[str, int]:
    return __file__, method.__code__.co_firstlineno + after


@pytest.mark.parametrize("wants", ["wants", "wants_by_call", "wants_by_condition"])
@pytest.mark.parametrize(("keeps", "after"), [("keeps", 1), ("keeps_two", 1), ("keeps_by_name", 2)])
def test_a_thread_inside_a_with_holds_its_lock(wants: str, keeps: str, after: int) -> None:
    store = Store()
    taking = getattr(store, keeps)
    with standing(store, taking, getattr(store, wants)) as (keeper, waiter):
        assert holder(waiter) == Holder(keeper, 0, line_of(taking, after=after))


def test_a_private_name_and_a_reentrant_lock_are_found() -> None:
    store = Store()
    with standing(store, store.keeps_own, store.wants_own) as (keeper, waiter):
        found = holder(waiter)
        assert found is not None
        assert found.ident == keeper
    store = Store()
    with standing(store, store.keeps_again, store.wants_again) as (keeper, waiter):
        found = holder(waiter)
        assert found is not None
        assert found.ident == keeper


def test_a_thread_that_takes_its_lock_twice_holds_it_itself() -> None:
    store = Store()
    with standing(store, store.takes_twice) as (waiter,):
        assert holder(waiter) == Holder(waiter, 0, line_of(store.takes_twice, after=1))


@pytest.mark.parametrize("keeps", ["left", "lets_go", "waits_for_change", "keeps_again"])
def test_who_has_released_a_lock_does_not_hold_it(keeps: str) -> None:
    store = Store()
    with standing(store, getattr(store, keeps)), standing(store, store.wants):
        assert not HeldLocks(frames(), {}, is_own).holder_of(store.lock, 0)


def test_a_wait_with_a_timeout_has_no_known_holder() -> None:
    store = Store()
    with standing(store, store.keeps, store.wants_for_a_while) as (_, waiter):
        assert holder(waiter) is None


def test_a_lock_of_the_same_name_of_another_object_is_not_taken_for_it() -> None:
    store, other = Store(), Store()
    with standing(other, other.keeps), standing(store, store.left):
        assert not HeldLocks(frames(), {}, is_own).holder_of(store.lock, 0)


def test_a_suspended_coroutine_holds_the_lock_of_the_with_in_which_it_awaits() -> None:
    store = Store()
    coroutine = store.awaits(Later())
    coroutine.send(None)
    with standing(store, store.wants) as (waiter,):
        line = Store.awaits.__code__.co_firstlineno + 1
        assert holder(waiter, {coroutine: 12}) == Holder(0, 12, (__file__, line))
        coroutine.close()


@pytest.mark.parametrize("edited", [False, True])
def test_in_a_file_that_was_edited_since_the_program_began_nothing_is_looked_up(
    tmp_path: Path, edited: bool
) -> None:
    file, store = tmp_path / "node.py", Store()
    file.write_text("def wants(store):\n    with store.lock:\n        pass\n")
    if not edited:
        os.utime(file, (0, 0))
    program: dict[str, Any] = {"__name__": "node"}
    exec(compile(file.read_text(), str(file), "exec"), program)
    with standing(store, store.keeps, lambda: program["wants"](store)) as (_, waiter):
        assert (holder(waiter) is None) is edited


TWICE = """
import threading

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.lock = threading.Lock()
        self.create_timer(0.5, self.add)

    def balance(self):
        with self.lock:
            return 0

    def add(self):
        with self.lock:
            self.balance()
"""
CALLS = """
import threading

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        group = ReentrantCallbackGroup()
        self.lock = threading.Lock()
        self.create_service(SetBool, "switch", self.serve, callback_group=group)
        self.client = self.create_client(SetBool, "switch", callback_group=group)
        self.once = self.create_timer(0.5, self.ask, callback_group=group)

    def ask(self):
        self.once.cancel()
        with self.lock:
            self.client.call(SetBool.Request(data=True))

    def serve(self, request, response):
        with self.lock:
            return response
"""
AWAITS = CALLS.replace("def ask", "async def ask").replace(
    "self.client.call(", "await self.client.call_async("
)


@programs.needs_ros
@pytest.mark.slow
@pytest.mark.parametrize("body", [TWICE, CALLS, AWAITS], ids=["twice", "call", "await"])
def test_a_deadlock_over_a_lock_is_told_as_on_the_model(tmp_path: Path, body: str) -> None:
    def told(ground: str) -> list[tuple[str, str, str]]:
        executor = "MultiThreadedExecutor(num_threads=4)"
        run = programs.run(tmp_path, body, executor, ground=ground, seconds=3.5, clock="real")
        timeline = run.timeline
        found = [each for each in diagnose(timeline) if each.weight_in(timeline) is Weight.PROBLEM]
        said = [(each.rule.id, each.explained(timeline)) for each in found]
        return [(rule, re.sub(r"\d+\.\d+ s", "_ s", each.what), each.cure) for rule, each in said]

    on_model = told("model")
    assert [rule for rule, _, _ in on_model] == ["self-made-deadlock"]
    assert told("ros2") == on_model
