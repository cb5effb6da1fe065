from dataclasses import replace

import pytest

from cbtui.keys.action import Scope
from cbtui.keys.actions import actions_of
from cbtui.learning.stage import LessonStep, StepState
from cbtui.looks.theme import Charset, TextRun
from cbtui.runs.live.live_run import RunState
from cbtui.widgets.banner import banner
from cbtui.widgets.key_bar import fitting_entries, key_bar_entries, key_row
from cbtui.widgets.status_line import RunStatus, status_row

LIVE = RunStatus(
    title="2/6 One shared group",
    state=RunState.LIVE,
    pace="virtual ×1.0",
    brief_pace="×1.0",
    at=14_250_000_000,
    back=0,
    executor="SingleThreadedExecutor",
    dropped=392,
    lost=0,
)


def text(runs: list[TextRun]) -> str:
    return "".join(run.text for run in runs)


def test_a_narrow_status_line_leaves_out_the_executor() -> None:
    assert text(status_row(LIVE, 80)) == (
        " 2/6 One shared group              ● LIVE  virtual ×1.0   t 14.250 s   lost 392 "
    )


def test_a_wide_status_line_tells_the_executor() -> None:
    assert "t 14.250 s   SingleThreadedExecutor   lost 392" in text(status_row(LIVE, 140))


@pytest.mark.parametrize("width", [80, 99, 140, 200])
@pytest.mark.parametrize("state", RunState)
@pytest.mark.parametrize("lost", [0, 12345])
@pytest.mark.parametrize("recorded", [None, 1_234_567])
@pytest.mark.parametrize("back", [0, 3_600_000_000_000])
def test_a_status_line_is_as_wide_as_the_screen(
    width: int, state: RunState, lost: int, recorded: int | None, back: int
) -> None:
    title = "12/34 A lesson with quite a long title"
    status = replace(LIVE, state=state, lost=lost, title=title, recorded=recorded, back=back)
    assert len(text(status_row(status, width))) == width


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (replace(LIVE, state=RunState.STARTING), "◐ STARTING"),
        (replace(LIVE, state=RunState.PAUSED), "‖ PAUSED"),
        (replace(LIVE, state=RunState.ENDED), "■ ENDED"),
        (replace(LIVE, state=RunState.LOST, back=3_000_000_000), "✗ LOST"),
        (replace(LIVE, back=3_000_000_000), "◂ BACK 3.0 s "),
        (replace(LIVE, state=RunState.PAUSED, back=3_000_000_000), "◂ BACK 3.0 s, paused"),
        (replace(LIVE, lost=7), "trace lost 7"),
        (replace(LIVE, recorded=1234), "REC 1,234"),
        (replace(LIVE, recorded=1234, unrecorded=1050), "REC 1,234, 1,050 missed"),
        (replace(LIVE, recorded=1234, recorded_bytes=41_900_000), "REC 1,234 41 MB"),
        (replace(LIVE, state=RunState.REPLAY_STANDS, back=3_000_000_000), "‖ REPLAY"),
        (replace(LIVE, state=RunState.REPLAY_PLAYS, back=3_000_000_000), "▶ REPLAY"),
    ],
)
def test_a_state_is_told_in_a_word_and_a_sign(status: RunStatus, words: str) -> None:
    assert words in text(status_row(status, 140))


DONE = (
    LessonStep("Predict", StepState.DONE),
    LessonStep("Run", StepState.DONE),
    LessonStep("Explain", StepState.DONE),
)
EXERCISE = (*DONE, LessonStep("Exercise", StepState.CURRENT, "2/5"))


def test_in_80_columns_the_last_step_tells_that_all_is_done() -> None:
    assert "Explain ✓" in text(status_row(replace(LIVE, steps=DONE), 80))


def test_in_80_columns_the_pace_makes_room_for_the_checks_that_pass() -> None:
    title = "1/6 Spin inside a callback"
    starting = replace(
        LIVE, title=title, state=RunState.STARTING, pace="virtual max", brief_pace="max", at=0, dropped=0
    )
    row = text(status_row(replace(starting, steps=EXERCISE), 80))
    assert row.startswith(f" {title}      Exercise 2/5 ")
    assert "STARTING   t 0.000 s   lost 0" in row


@pytest.mark.parametrize("width", range(40, 200))
@pytest.mark.parametrize("scope", [Scope.MENU, Scope.LESSON])
def test_the_keys_fit_and_the_way_out_and_the_help_are_always_there(scope: Scope, width: int) -> None:
    chosen = fitting_entries(key_bar_entries(actions_of(scope), Charset.BRAILLE), width - 1)
    ids = [action.id for entry in chosen for action in entry.actions]
    assert {"leave", "help"} <= set(ids)
    line = text(key_row(chosen, width))
    assert len(line) == width
    assert "? help" in line


def test_keys_keep_the_registry_s_order() -> None:
    every = key_bar_entries(actions_of(Scope.LESSON), Charset.BRAILLE)
    chosen = fitting_entries(every, 90)
    assert chosen == [entry for entry in every if entry in chosen]
    assert len(chosen) < len(every)


@pytest.mark.parametrize("width", [30, 78, 138])
def test_the_banner_fills_its_width_and_nothing_more(width: int) -> None:
    assert {len(text(row)) for row in banner(width)} == {width}
