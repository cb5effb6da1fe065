"""A trace that no run can have written is told from one of a run."""

import os
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from cbtui.grading.submission import Submission
from cbtui.grading.trace_audit import TraceAudit
from sim.trace import events as ev
from sim.trace.events import AnyEvent, encode
from sim.trace.integrity.plausibility import Plausibility
from sim.trace.integrity.sealing import BrokenSealError, Seal

KEY = b"k" * 32
SOURCE = b"def tick():\n    pass\n\n\ndef main():\n    pass\n"
BEGIN: list[AnyEvent] = [
    ev.RunStarted(0, "node", "virtual", 0),
    ev.NodeAppeared(0, 1, "/node"),
    ev.GroupAppeared(0, 1, 1, ev.GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
]
THREAD = ev.ThreadAppeared(0, 1, "MainThread")
END = ev.RunEnded(9, "its time was up", failed=False)


def timer(
    number: int, file: str = "", first: int = 1, last: int = 2, name: str = "tick"
) -> ev.EntityAppeared:
    return ev.EntityAppeared(0, number, 1, 1, ev.EntityKind.TIMER, "", name, file, first, last, 0, 1)


def start(t: int, entity: int = 1, thread: int = 1) -> ev.CallbackStarted:
    return ev.CallbackStarted(t, entity, thread, 0, 0, 0)


def faults(*events: AnyEvent) -> list[str]:
    plausibility = Plausibility()
    plausibility.take(events)
    plausibility.finish()
    return plausibility.faults


def test_a_run_is_plausible() -> None:
    calls: list[AnyEvent] = [start(1), ev.CallbackEnded(2, 1, 1), start(2, 2), ev.CallbackSuspended(3, 2, 1)]
    rest: list[AnyEvent] = [ev.CallbackResumed(4, 2, 1), ev.CallbackEnded(5, 2, 1), END]
    assert faults(*BEGIN, THREAD, timer(1), timer(2), *calls, *rest) == []


@pytest.mark.parametrize(
    ("events", "fault"),
    [
        ([*BEGIN], "at 0 ns the trace stops before the end of the run"),
        ([*BEGIN, END, END], "at 9 ns RunEnded came after the end of the run"),
        ([*BEGIN[1:2], END], "at 0 ns NodeAppeared came first"),
        ([*BEGIN, BEGIN[0], END], "at 0 ns the run began twice"),
        ([*BEGIN, ev.NodeAppeared(0, 3, "/other"), END], "at 0 ns node 3 appeared in place of 2"),
        ([*BEGIN, start(1), END], "at 1 ns CallbackStarted names entity 1, which had not appeared"),
        (
            [*BEGIN, THREAD, timer(1), start(2), ev.CallbackEnded(1, 1, 1), END],
            "at 1 ns CallbackEnded came after an event of 2 ns",
        ),
        (
            [*BEGIN, THREAD, timer(1), ev.CallbackEnded(1, 1, 1), END],
            "at 1 ns CallbackEnded is of a callback that was not running",
        ),
        (
            [*BEGIN, THREAD, timer(1), timer(2), start(1), start(1, 2), END],
            "at 1 ns two callbacks run at once in the exclusive group 1",
        ),
    ],
)
def test_what_no_run_can_show_is_found(events: list[AnyEvent], fault: str) -> None:
    assert faults(*events)[0] == fault


def test_batches_are_opened_in_their_order_and_with_their_key_only() -> None:
    writer, reader = Seal(KEY), Seal(KEY)
    first, second = writer.close(b"1"), writer.close(b"2", ("sim.x",))
    assert reader.open(first).events == b"1"
    with pytest.raises(BrokenSealError, match="batch 1 of the trace came in place of 2"):
        reader.open(first)
    assert Seal(KEY).open(first).number == 1
    for data, fault in ((second, "wrong seal"), (b"\x90", "without a seal"), (b"", "without a seal")):
        with pytest.raises(BrokenSealError, match=fault):
            Seal(b"another").open(data)


@pytest.fixture
def doubts(tmp_path: Path) -> Callable[..., tuple[str, ...]]:
    """What an audit has to say of a run with some events; ``tamper`` changes the sealed batch."""

    def look(
        *events: AnyEvent, tamper: Callable[[bytes], bytes] = bytes, source: bytes = SOURCE
    ) -> tuple[str, ...]:
        submission = Submission("node.py", {"node.py": source})
        submission.write_to(tmp_path)
        audit = TraceAudit(KEY, submission, tmp_path, [Path(os.__file__).parent], virtual=True)
        audit.unpack(tamper(Seal(KEY).close(encode([*BEGIN, *events, END]))))
        return audit.doubts(ended_normally=True)

    return look


def test_callbacks_that_were_handed_in_or_are_a_librarys_are_none_to_doubt(
    doubts: Callable[..., tuple[str, ...]], tmp_path: Path
) -> None:
    library = timer(2, os.__file__, 7, 9, "anything")
    assert doubts(timer(1, str(tmp_path / "node.py")), library, timer(3, "", 0, 0)) == ()


@pytest.mark.parametrize(
    ("event", "doubt"),
    [
        (timer(1, "{}/solution.py"), "the callback tick is in {}/solution.py, which was not handed in"),
        (timer(1, "{}/copy/other.py"), "the callback tick is said to be at other.py:1, and it is not there"),
        (
            timer(1, "{}/copy/node.py", 1, 3),
            "the callback tick is said to be at node.py:1, and it is not there",
        ),
        (
            timer(1, "{}/copy/node.py", name="tock"),
            "the callback tock is said to be at node.py:1, and it is not",
        ),
    ],
)
def test_a_callback_from_elsewhere_gives_a_run_away(
    tmp_path: Path, event: ev.EntityAppeared, doubt: str
) -> None:
    copy = tmp_path / "copy"
    submission = Submission("node.py", {"node.py": SOURCE})
    copy.mkdir()
    submission.write_to(copy)
    audit = TraceAudit(KEY, submission, copy, [], virtual=True)
    moved = msgspec.structs.replace(event, file=event.file.format(tmp_path))
    audit.unpack(Seal(KEY).close(encode([*BEGIN, moved, END])))
    (found,) = audit.doubts(ended_normally=True)
    assert found.startswith(doubt.format(tmp_path))


def test_a_broken_seal_a_replaced_function_and_a_changed_file_give_a_run_away(
    doubts: Callable[..., tuple[str, ...]], tmp_path: Path
) -> None:
    assert doubts(tamper=lambda data: data[:-1] + b"\0")[0].startswith("something with a wrong seal")
    replaced = Seal(KEY).close(encode([*BEGIN, END]), ("sim.x",))
    assert doubts(tamper=lambda _: replaced) == ("the program replaced sim.x, which is the engine's own",)
    assert doubts(source=b"import sim.ros\n") == ("node.py:1 imports sim.ros, which is not part of ROS 2",)

    def write_over(data: bytes) -> bytes:
        (tmp_path / "node.py").write_bytes(b"")
        return data

    assert doubts(tamper=write_over) == ("node.py was changed while it ran",)


def test_what_only_the_run_can_know_gives_a_program_away_that_tells_it(
    doubts: Callable[..., tuple[str, ...]],
) -> None:
    told = ev.Notice(1, ev.Severity.ERROR, "the program tells of the robot", kind=ev.NoticeKind.FORGED)
    assert doubts(told) == ("the program tells of the robot",)
