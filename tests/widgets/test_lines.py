from dataclasses import replace

import pytest

from cbtui.keys.action import Scope
from cbtui.keys.actions import actions_of
from cbtui.looks.theme import Charset, Run
from cbtui.runs.live.live_run import State
from cbtui.widgets.banner import banner
from cbtui.widgets.key_bar import choose, entries, key_row
from cbtui.widgets.status_line import Status, status_row

LIVE = Status(
    title="2/6 One shared group",
    state=State.LIVE,
    pace="virtual ×1.0",
    at=14_250_000_000,
    back=0,
    executor="SingleThreadedExecutor",
    dropped=392,
    lost=0,
)


def text(runs: list[Run]) -> str:
    return "".join(run.text for run in runs)


def test_a_narrow_status_line_leaves_out_the_executor() -> None:
    assert text(status_row(LIVE, 80)) == (
        " 2/6 One shared group           ● LIVE  virtual ×1.0   t 14.250 s   dropped 392 "
    )


def test_a_wide_status_line_tells_the_executor() -> None:
    assert "t 14.250 s   SingleThreadedExecutor   dropped 392" in text(status_row(LIVE, 140))


@pytest.mark.parametrize("width", [80, 99, 140, 200])
@pytest.mark.parametrize("state", State)
@pytest.mark.parametrize("lost", [0, 12345])
@pytest.mark.parametrize("recorded", [None, 1_234_567])
@pytest.mark.parametrize("back", [0, 3_600_000_000_000])
def test_a_status_line_is_as_wide_as_the_screen(
    width: int, state: State, lost: int, recorded: int | None, back: int
) -> None:
    title = "12/34 A lesson with quite a long title"
    status = replace(LIVE, state=state, lost=lost, title=title, recorded=recorded, back=back)
    assert len(text(status_row(status, width))) == width


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (replace(LIVE, state=State.STARTING), "○ STARTING"),
        (replace(LIVE, state=State.PAUSED), "‖ PAUSED"),
        (replace(LIVE, state=State.ENDED), "■ ENDED"),
        (replace(LIVE, state=State.LOST, back=3_000_000_000), "✗ LOST"),
        (replace(LIVE, back=3_000_000_000), "◂ BACK 3.0 s "),
        (replace(LIVE, state=State.PAUSED, back=3_000_000_000), "◂ BACK 3.0 s, paused"),
        (replace(LIVE, lost=7), "trace lost 7"),
        (replace(LIVE, recorded=1234), "REC 1,234"),
        (replace(LIVE, recorded=1234, unrecorded=1050), "REC 1,234, lost 1,050"),
        (replace(LIVE, recorded=1234, recorded_bytes=41_900_000), "REC 1,234 41 MB"),
        (replace(LIVE, state=State.REPLAY_STANDS, back=3_000_000_000), "‖ REPLAY"),
        (replace(LIVE, state=State.REPLAY_PLAYS, back=3_000_000_000), "▶ REPLAY"),
    ],
)
def test_a_state_is_told_in_a_word_and_a_sign(status: Status, words: str) -> None:
    assert words in text(status_row(status, 140))


@pytest.mark.parametrize("width", range(40, 200))
@pytest.mark.parametrize("scope", [Scope.MENU, Scope.LESSON])
def test_the_keys_fit_and_the_way_out_and_the_help_are_always_there(scope: Scope, width: int) -> None:
    chosen = choose(entries(actions_of(scope), Charset.BRAILLE), width - 1)
    ids = [action.id for entry in chosen for action in entry.actions]
    assert {"leave", "help"} <= set(ids)
    line = text(key_row(chosen, width))
    assert len(line) == width
    assert "? help" in line


def test_keys_keep_the_registry_s_order() -> None:
    every = entries(actions_of(Scope.LESSON), Charset.BRAILLE)
    chosen = choose(every, 90)
    assert chosen == [entry for entry in every if entry in chosen]
    assert len(chosen) < len(every)


@pytest.mark.parametrize("width", [30, 78, 138])
def test_the_banner_fills_its_width_and_nothing_more(width: int) -> None:
    assert {len(text(row)) for row in banner(width)} == {width}
