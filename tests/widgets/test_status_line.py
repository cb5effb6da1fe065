"""The line at the top as plain text, and what gives way where it has no room."""

from dataclasses import replace

import pytest

from cbtui.learning.stage import LessonStep, StepState
from cbtui.runs.live.live_run import RunState
from cbtui.widgets.status_line import RunStatus, speed_text, status_row
from tests.support.builder import ns

LIVE = RunStatus(
    title="2/6 One shared group",
    state=RunState.LIVE,
    pace="virtual ×1.0",
    brief_pace="×1.0",
    at=ns(12.48),
    back=0,
    executor="SingleThreadedExecutor",
    dropped=412,
    lost=0,
)


def line(status: RunStatus, width: int) -> str:
    return "".join(run.text for run in status_row(status, width))


@pytest.mark.parametrize(
    ("status", "width", "golden"),
    [
        (
            LIVE,
            120,
            "| 2/6 One shared group                             ● LIVE  virtual ×1.0   t 12.480 s   "
            "SingleThreadedExecutor   lost 412 |",
        ),
        (LIVE, 80, "| 2/6 One shared group              ● LIVE  virtual ×1.0   t 12.480 s   lost 412 |"),
        (
            replace(LIVE, dropped=None),
            80,
            "| 2/6 One shared group                ● LIVE  virtual ×1.0   t 12.480 s   lost - |",
        ),
        (
            replace(LIVE, exported=35),
            100,
            "| 2/6 One shared group                    ● LIVE  virtual ×1.0   t 12.480 s   EXPORT 35 %   "
            "lost 412 |",
        ),
        (
            replace(LIVE, recorded=41_204, unrecorded=7),
            110,
            "| 2/6 One shared group                     ● LIVE  virtual ×1.0   t 12.480 s   "
            "REC 41,204, 7 missed   "
            "lost 412 |",
        ),
        (
            replace(LIVE, back=ns(3.2), dropped=0),
            80,
            "| 2/6 One shared group          ◂ BACK 3.2 s  virtual ×1.0   t 12.480 s   lost 0 |",
        ),
        (replace(LIVE, lost=9), 48, "| 2/6 One sh… ● LIVE   t 12.480 s   trace lost 9 |"),
    ],
)
def test_the_line_is(status: RunStatus, width: int, golden: str) -> None:
    assert line(status, width) == golden[1:-1]


@pytest.mark.parametrize("width", range(40, 140, 7))
def test_the_line_is_as_wide_as_it_is_asked_to_be(width: int) -> None:
    assert len(line(LIVE, width)) == width


@pytest.mark.parametrize(
    ("asked", "slow", "text"),
    [
        (None, None, "max"),
        (1.0, None, "×1.0"),
        (2.0, 0.34, "×0.3 of ×2.0"),
        (1.0, 0.036, "×0.04 of ×1.0"),
        (1.0, 0.0, "×0 of ×1.0"),
    ],
)
def test_a_speed_however_small_is_not_told_as_none(
    asked: float | None, slow: float | None, text: str
) -> None:
    assert speed_text(asked, slow) == text


def test_a_program_in_which_nothing_moves_is_not_only_live() -> None:
    still = replace(LIVE, still=ns(4.1))
    assert "✗ STUCK 4.1 s, nothing moves" in line(still, 100)
    assert "✗ STUCK 4.1 s, only Thread-1 moves" in line(replace(still, moves="Thread-1"), 100)
    assert "✗ STARVED 4.1 s, only tick runs" in line(replace(still, only="tick"), 100)
    assert "◂ BACK 2.0 s" in line(replace(still, back=ns(2.0)), 100)


def test_a_run_that_is_sent_to_a_moment_says_to_which() -> None:
    sent = replace(LIVE, goal=99_999_000_000_000)
    for width in (80, 140):
        assert "● LIVE to 99999 s " in line(sent, width)
    assert "99999" not in line(replace(sent, state=RunState.PAUSED), 140)


def test_a_stuck_run_keeps_the_step_of_its_lesson() -> None:
    steps = (LessonStep("Predict", StepState.DONE), LessonStep("Run", StepState.CURRENT))
    stuck = line(replace(LIVE, still=ns(14.1), dropped=0, steps=steps), 80)
    assert "2/6 One shared group" in stuck
    assert "Run ●   ✗ STUCK 14.1 s" in stuck
