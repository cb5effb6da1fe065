"""The banner of a passed exercise, while it moves and at its end."""

from textual.geometry import Size

from cbtui.looks.theme import Charset
from cbtui.widgets.passed_banner import banner


def test_lanes_fill_one_after_the_other_around_the_text() -> None:
    halfway, full = (
        ["".join(run.text for run in row) for row in banner("done", Size(20, 3), share, Charset.BRAILLE)]
        for share in (0.5, 1.0)
    )
    assert [row.count("█") for row in (halfway[0], halfway[2])] == [16, 10]
    assert full == ["█" * 20, f"{'█' * 7} done {'█' * 7}", "█" * 20]
