import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from cbtui.text.ascii_filter import in_ascii
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.pictures import lines_of
from tests.support.runs import shared_group_run

PRINTABLE = st.text(st.characters(exclude_categories=["C", "M", "Z"]))


@given(PRINTABLE)
def test_text_becomes_ascii_of_the_same_width(text: str) -> None:
    plain = in_ascii(text)
    assert plain.isascii()
    assert cell_len(plain) == cell_len(text)


def test_signs_get_the_plainest_sign_like_them() -> None:
    assert in_ascii("● ◂ ╭─┤ ✓ × café … ⣿█") == "* < +-+ + x cafe ~ .#"


@pytest.mark.slow
@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_an_ascii_terminal_gets_nothing_but_ascii(size: tuple[int, int]) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 13.15, charset="ascii")
    async with app.run_test(size=size) as pilot:
        for key in ("1", "2", "3", "4", "question_mark", "escape", "t", "escape", "ctrl+p"):
            await pilot.press(key)
            await settle(pilot)
            assert "".join(lines_of(app)).isascii()
