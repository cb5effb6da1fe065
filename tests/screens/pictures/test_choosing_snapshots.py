"""The screen on which the learner is the scheduler, as pictures."""

import pytest
from textual.pilot import Pilot

from tests.screens.pictures.test_snapshots import Compare
from tests.screens.test_choosing import console
from tests.support.asking import Asking
from tests.support.console import NARROW, WIDE, settle

pytestmark = pytest.mark.slow


async def after_a_move(pilot: Pilot[None]) -> None:
    await settle(pilot)
    await pilot.press("2")
    await settle(pilot)


@pytest.mark.parametrize("size", [NARROW, WIDE], ids=lambda size: f"{size[0]}x{size[1]}")
def test_a_choice_looks_as_it_did(snap_compare: Compare, size: tuple[int, int]) -> None:
    assert snap_compare(console(Asking()), terminal_size=size, run_before=after_a_move)
