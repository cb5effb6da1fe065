"""The cures that the window of findings offers: tried beforehand, and shown with what they edit."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from threading import Event
from time import sleep
from types import SimpleNamespace
from typing import Any, cast

import msgspec
import pytest

from cbtui.looks.theme import Charset
from cbtui.runs.judged.cures import Cure, TriedRun, Verdict, problem_of
from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest
from cbtui.runs.setup.shown_program import ShownProgram, of_file
from cbtui.screens.parts import cures
from cbtui.screens.parts.cures import CureTrial, CureTrials
from cbtui.screens.windows import diagnoses
from cbtui.screens.windows.diagnoses import (
    ChosenStep,
    DiagnosesScreen,
    NextStep,
)
from cbtui.screens.windows.finding_texts import cure_details
from lessons.catalogue import find
from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.code_edit import CodeEdit
from sim.trace.events import RunStarted
from sim.trace.timeline import Timeline
from tests import diagnosis
from tests.screens.test_diagnoses import TURNED, console, press, told_of
from tests.support.engine_runs import SECOND, run_to_end
from tests.support.exercises import until
from tests.support.pictures import text_of
from tests.support.runs import shared_group_run

EDIT = Cure(
    Changes(), "let it sleep less", "--- a.py\n+++ a.py, the copy\n@@ -1,1 +1,1 @@\n-sleep(9)\n+sleep(1)"
)


APART = Cure(Changes(threads=2), "spin with two threads")


class Trial:
    """Finds that an edit helps, and nothing else; keeps what was tried."""

    def __init__(self, refusal: str = "") -> None:
        self.tried: list[Cure] = []
        self.refusal = refusal

    def cures(self, told: ExplainedFinding) -> Sequence[Cure]:
        return (APART, EDIT) if told.is_problem and not self.refusal else ()

    def judge(self, _told: ExplainedFinding, cure: Cure, note: Callable[[int], object]) -> Verdict:
        self.tried.append(cure)
        note(40)
        return Verdict(cure is EDIT)


@pytest.mark.slow
@pytest.mark.parametrize("keys", [("t",), ("down", "enter"), ("down", "t")])
async def test_a_cure_is_offered_once_it_was_found_to_help(keys: tuple[str, ...]) -> None:
    async with console() as (app, pilot):
        chosen: list[ChosenStep | None] = []
        findings, trial = told_of(shared_group_run().until(TURNED)), Trial()
        await app.push_screen(DiagnosesScreen(findings, Charset.BRAILLE, trial), chosen.append)
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert trial.tried == [APART, EDIT]
        assert "→ tried, it helps: let it sleep less" in text_of(app)
        assert "two threads" not in text_of(app)
        await press(pilot, "down", "down", "t")
        assert chosen == []
        await press(pilot, "up", "up", *keys)
        assert chosen == [ChosenStep(findings[0], NextStep.CURE, EDIT)]


async def test_the_key_bar_tells_what_enter_does_on_each_row() -> None:
    async with console() as (app, pilot):
        findings = told_of(shared_group_run().until(TURNED))[:1]
        lesson = find("single-thread")
        await app.push_screen(DiagnosesScreen(findings, Charset.BRAILLE, Trial(), lambda _: lesson))
        await app.workers.wait_for_complete()
        await pilot.pause()
        for row in ("⏎ go there  t try the cure", "⏎ t try the cure", "⏎ open the lesson  t try the cure"):
            assert row in text_of(app)
            await press(pilot, "down")


async def test_beside_a_cure_that_helps_another_one_is_being_tried() -> None:
    class EndlessSecond(Trial):
        def judge(self, told: ExplainedFinding, cure: Cure, note: Callable[[int], object]) -> Verdict:
            return Verdict(cure is APART or over.wait(10))

    over = Event()
    async with console() as (app, pilot):
        findings, lesson = told_of(shared_group_run().until(TURNED)), find("single-thread")
        screen = DiagnosesScreen(findings, Charset.BRAILLE, EndlessSecond(), lambda _: lesson)
        await app.push_screen(screen)
        await until(pilot, lambda: "→ tried, it helps: spin with two" in text_of(app))
        await until(pilot, lambda: "· Another cure is being tried, for " in text_of(app))
        assert "open lesson" not in text_of(app), "who waits for a cure does not leave for a lesson"
        over.set()
        await until(pilot, lambda: "→ open lesson 1, which shows this" in text_of(app))
        await press(pilot, "escape")


async def test_a_cure_is_tried_once_it_is_known_also_of_a_problem_that_is_listed_already() -> None:
    class AsKnown(Trial):
        def cures(self, told: ExplainedFinding) -> Sequence[Cure]:
            return (EDIT,) if told.explanation.remedies else ()

    async with console() as (app, pilot):
        (told, *_), trial = told_of(shared_group_run().until(TURNED)), AsKnown()
        at_first = replace(told, explanation=replace(told.explanation, remedies=()))
        shown = [at_first]
        screen = DiagnosesScreen((at_first,), Charset.BRAILLE, trial, latest=lambda: tuple(shown))
        await app.push_screen(screen)
        await app.workers.wait_for_complete()
        assert "tried, it helps" not in text_of(app)
        shown[:] = [told]
        await until(pilot, lambda: "→ tried, it helps: let it sleep less" in text_of(app))
        await press(pilot, "escape")


async def test_while_a_trial_stands_still_its_time_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    class Endless(Trial):
        def judge(self, told: ExplainedFinding, cure: Cure, note: Callable[[int], object]) -> Verdict:
            started.wait(10)
            note(40)
            return Verdict(over.wait(10))

    now, started, over = [100.0], Event(), Event()
    monkeypatch.setattr(diagnoses, "monotonic", lambda: now[0])
    async with console() as (app, pilot):
        screen = DiagnosesScreen(told_of(shared_group_run().until(TURNED)), Charset.BRAILLE, Endless())
        await app.push_screen(screen)
        await until(pilot, lambda: "A cure is being tried, for 0 s now: its run is starting." in text_of(app))
        started.set()
        await until(pilot, lambda: "A cure is being tried, for 0 s now: 20 %." in text_of(app))
        await press(pilot, "t")
        assert "a cure is being tried, for 0 s now: 20 % " in text_of(app), "the key says what it waits for"
        now[0] += 7
        await until(pilot, lambda: "A cure is being tried, for 7 s now: 20 %." in text_of(app))
        assert "a cure is being tried, for 7 s now: 20 % " in text_of(app), "and no second number"
        over.set()
        await press(pilot, "escape")


async def test_that_no_cure_helps_is_told_with_what_was_tried() -> None:
    class InVain(Trial):
        def judge(self, told: ExplainedFinding, cure: Cure, note: Callable[[int], object]) -> Verdict:
            return answer

    findings = told_of(shared_group_run().until(TURNED))
    async with console() as (app, pilot):
        for answer, told in (
            (Verdict(False), "2 cures tried, none helps here: spin with two threads; let it sleep less."),
            (
                Verdict(False, "deadlock"),
                "2 cures tried, none is enough here: spin with two threads (with it this problem is gone, "
                "and another one comes: deadlock); let it sleep less (with it this problem is gone, and "
                "another one comes: deadlock).",
            ),
            (
                Verdict(True, "deadlock"),
                "A cure was tried, and helps against this; then another one comes: deadlock.",
            ),
            (
                Verdict(None),
                "Whether a cure helps is not known: the run that was made to try one did not show this "
                "problem.",
            ),
        ):
            await app.push_screen(DiagnosesScreen(findings, Charset.BRAILLE, InVain()))
            await app.workers.wait_for_complete()
            await pilot.pause()
            shown = " ".join(line.strip("│ ") for line in text_of(app).splitlines())
            assert f"· {told}" in shown
            assert ("→ what was tried is not enough here; in all: " in shown) == (answer.helps is False)
            await press(pilot, "escape")


async def test_where_the_code_is_of_no_simple_shape_it_is_told_that_no_cure_is_offered() -> None:
    [worst, *_] = told_of(shared_group_run().until(TURNED))
    explanation = replace(worst.explanation, remedies=(Remedy(edit=CodeEdit("a.py", "", print, ())),))

    class Nothing(Trial):
        def cures(self, told: ExplainedFinding) -> Sequence[Cure]:
            return ()

    async with console() as (app, pilot):
        listed = [replace(worst, explanation=explanation)]
        await app.push_screen(DiagnosesScreen(listed, Charset.BRAILLE, Nothing()))
        await pilot.pause()
        assert "· No cure can be offered here: cbtui only makes small changes by itself" in text_of(app)


@pytest.mark.slow
async def test_what_a_cure_edits_is_shown_line_by_line() -> None:
    async with console() as (app, pilot):
        await app.push_screen(
            DiagnosesScreen(told_of(shared_group_run().until(TURNED)), Charset.BRAILLE, Trial())
        )
        await app.workers.wait_for_complete()
        await press(pilot, "down")
        shown = text_of(app)
        assert "Your file stays as it is; a copy is run, with these lines:" in shown
        assert "-sleep(9)" in shown
        assert "+sleep(1)" in shown


async def test_where_no_cure_can_be_tried_problems_say_why_and_remarks_do_not() -> None:
    async with console() as (app, pilot):
        findings = told_of(shared_group_run().until(TURNED))
        await app.push_screen(DiagnosesScreen(findings, Charset.BRAILLE, Trial("Not on this ground.")))
        await pilot.pause()
        assert "· Not on this ground." in text_of(app)
        assert not findings[-1].is_problem
        await press(pilot, *["down"] * (len(findings) - 1))
        assert "Not on this ground." not in text_of(app)


def test_lines_that_go_and_come_are_coloured_apart() -> None:
    told = cure_details(EDIT, Charset.BRAILLE)
    styles = {told.plain[span.start : span.end].strip(): span.style for span in told.spans}
    assert styles["-sleep(9)"] == "$text-error"
    assert styles["+sleep(1)"] == "$text-success"
    assert cure_details(APART, Charset.BRAILLE).plain == "Spin with two threads."


def test_an_edited_line_that_is_too_long_goes_on_in_a_line_with_a_sign() -> None:
    diff = "--- a.py\n+++ a.py, the copy\n@@ -1,1 +1,1 @@\n-sleep(9)\n+    sleep(1)  # one second only"
    told = cure_details(replace(EDIT, diff=diff), Charset.BRAILLE, 20).plain.splitlines()
    assert told[-3:] == ["-sleep(9)", "+    sleep(1)  # ", "…one second only"]
    assert cure_details(replace(EDIT, diff=diff), Charset.BRAILLE, 40).plain.splitlines()[-1].endswith("only")


def test_a_cure_that_edits_nothing_tells_what_to_write() -> None:
    cure = replace(APART, code=("executor = MultiThreadedExecutor(num_threads=2)", "executor.spin()"))
    assert cure_details(cure, Charset.BRAILLE).plain.splitlines() == [
        "Spin with two threads.",
        "Your file stays as it is; to have this in it, write:",
        "executor = MultiThreadedExecutor(num_threads=2)",
        "executor.spin()",
    ]


def test_what_was_tried_for_a_run_is_not_tried_again_when_the_window_is_opened_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    events, timeline = shared_group_run().until(TURNED), Timeline()
    timeline.extend(events)
    (found, *_) = told_of(events)
    problem, tried = problem_of(found.finding, timeline), list[Changes]()

    def run_with(_: CureTrial, changes: Changes, *_rest: object) -> TriedRun:
        tried.append(changes)
        return TriedRun({} if changes.threads else {problem: False}, end=timeline.end)

    monkeypatch.setattr(CureTrial, "_try", run_with)
    restarts: Any = SimpleNamespace(changes=Changes())
    runs: Any = SimpleNamespace(timeline=timeline, run=SimpleNamespace(timeline=timeline))
    trials = CureTrials(runs, restarts, cast("ShownProgram", None), lambda: None)
    for _ in range(2):
        assert trials.begin().judge(found, APART).helps
    assert tried == [Changes(), APART.changes]
    runs.run = SimpleNamespace(timeline=timeline)
    assert trials.begin().judge(found, APART).helps
    assert len(tried) == 4


def test_a_problem_that_comes_while_the_window_is_open_is_tried_up_to_where_it_shows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    events, timeline = shared_group_run().until(TURNED), Timeline()
    (found, *_) = told_of(events)
    runs: Any = SimpleNamespace(timeline=timeline, run=SimpleNamespace(timeline=timeline))
    restarts: Any = SimpleNamespace(changes=Changes())
    trial = CureTrials(runs, restarts, cast("ShownProgram", None), lambda: None).begin()
    timeline.extend(events)
    problem = problem_of(found.finding, timeline)

    def run_with(trial: CureTrial, changes: Changes, *_rest: object) -> TriedRun:
        shows = trial.until > timeline.end and not changes.threads
        return TriedRun({problem: False} if shows else {}, end=trial.until)

    monkeypatch.setattr(CureTrial, "_try", run_with)
    assert trial.until < timeline.end
    assert trial.judge(found, APART).helps


def first_trial(subject: ShownProgram, seconds: int) -> tuple[CureTrial, ExplainedFinding]:
    """A trial of cures for the program's run of so many seconds, and what was found first in that."""
    setup = subject.set_up(None, None)
    ran = run_to_end(msgspec.structs.replace(setup, until=seconds * SECOND))
    (found, *_) = told_of(ran.events)
    material = SimpleNamespace(batches=lambda: ())
    run = SimpleNamespace(timeline=ran.timeline, setup=setup, material=lambda: material)
    runs: Any = SimpleNamespace(timeline=ran.timeline, run=run)
    restarts: Any = SimpleNamespace(changes=Changes())
    return CureTrials(runs, restarts, subject, lambda: None).begin(), found


@pytest.mark.slow
def test_a_cure_that_lets_a_slow_timer_end_a_wait_is_tried_until_that_comes(tmp_path: Path) -> None:
    program = tmp_path / "node.py"
    program.write_text(
        "import queue\nimport rclpy\nrclpy.init()\nnode = rclpy.create_node('writer')\n"
        "full = queue.Queue(1)\nfull.put(0)\n"
        "def fill():\n    full.put(1)\n"
        "def drain():\n    full.get()\n"
        "node.create_timer(0.5, fill)\nnode.create_timer(0.7, print)\n"
        "node.create_timer(6.0, drain)\nrclpy.spin(node)\n"
    )
    subject = of_file(program, (), "virtual")
    trial, found = first_trial(subject, 2)
    (cure,) = trial.cures(found)
    assert trial.judge(found, cure).helps


@pytest.mark.slow
def test_two_cures_of_which_none_helps_alone_are_tried_and_offered_together() -> None:
    subject = of_file(Path(diagnosis.__file__).parent / "beginners" / "two_callers.py", (), "virtual")
    trial, found = first_trial(subject, 3)
    *alone, last = (trial.judge(found, each) for each in trial.cures(found))
    assert {each.helps for each in alone} == {False}
    assert last.helps
    assert last.both is not None
    assert last.both.words.startswith("give ask_left a callback group of its own, and ")
    assert "; for ask_right: go on in a done-callback" in last.both.words
    assert last.both.code or last.both.diff


def test_what_virtual_time_does_not_show_is_tried_on_the_real_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    started, *events = shared_group_run().until(TURNED)
    assert isinstance(started, RunStarted)
    timeline = Timeline()
    timeline.extend([msgspec.structs.replace(started, clock="real"), *events])
    (found, *_) = told_of([started, *events])
    problem, tried = problem_of(found.finding, timeline), list[tuple[str, bool]]()

    def run_with(_: CureTrial, changes: Changes, clock: str, *_rest: object) -> TriedRun:
        tried.append((clock, changes == APART.changes))
        shows = clock == "real" and changes != APART.changes
        return TriedRun({problem: False} if shows else {}, end=timeline.end)

    monkeypatch.setattr(CureTrial, "_try", run_with)
    restarts: Any = SimpleNamespace(changes=Changes())
    runs: Any = SimpleNamespace(timeline=timeline, run=SimpleNamespace(timeline=timeline))
    trial = CureTrials(runs, restarts, cast("ShownProgram", None), lambda: None).begin()
    assert trial.judge(found, APART).helps
    assert trial.judge(found, APART).helps
    assert tried == [("virtual", False), ("real", False), ("real", True)]


def test_a_trial_goes_on_when_its_window_is_left_and_tells_its_progress_to_the_next_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    events, timeline = shared_group_run().until(TURNED), Timeline()
    timeline.extend(events)
    (found, *_) = told_of(events)
    problem, begun, reopened, told = problem_of(found.finding, timeline), Event(), Event(), list[int]()
    tried: list[bool] = []

    def try_run(
        _setup: object, until: int, given_up: Event, note: Callable[[int], object], **_: str
    ) -> TriedRun:
        tried.append(given_up.is_set())
        begun.set()
        reopened.wait(10)
        note(until)
        return TriedRun({problem: False} if len(tried) == 1 else {}, end=timeline.end)

    monkeypatch.setattr(cures, "try_run", try_run)
    monkeypatch.setattr(CureTrial, "inputs", ())
    restarts: Any = SimpleNamespace(changes=Changes())
    runs: Any = SimpleNamespace(timeline=timeline, run=SimpleNamespace(timeline=timeline))
    subject: Any = SimpleNamespace(set_up=lambda *_: RunRequest(lesson=find("shared-group")).setup())
    trials = CureTrials(runs, restarts, subject, lambda: None)
    with ThreadPoolExecutor() as pool:
        first = pool.submit(trials.begin().judge, found, APART, lambda _: pytest.fail("its window is left"))
        begun.wait(10)
        second = pool.submit(trials.begin().judge, found, APART, told.append)
        while trials.begin()._note != told.append:
            sleep(0.01)
        reopened.set()
        assert first.result(10).helps
        assert second.result(10).helps
    assert (tried, told) == ([False, False], [50, 100])
    trial = trials.begin()
    trials.leave()
    assert trial.given_up.is_set()


async def test_a_comparison_with_an_edit_tells_which_line_it_changed(tmp_path: Path) -> None:
    file, edits = tmp_path / "node.py", list[str]()
    file.write_text("a = 1\nb = 2\n")

    async def again(_: Changes, _inputs: object, edit: str) -> None:
        edits.append(edit)

    restarts: Any = SimpleNamespace(changes=Changes(), again=again)
    trials = CureTrials(cast("Any", None), restarts, cast("ShownProgram", None), lambda: None)
    trials._anew = lambda: SimpleNamespace(inputs=())  # type: ignore[method-assign,assignment,return-value]
    await trials.run(Cure(Changes(texts={str(file): "a = 1\nb = 3\n"}), "make b 3"))
    assert edits == ["line 2 changed"]
