"""How often what is drawn, by counted frames and a clock that stands until it is moved."""

import pytest

from cbtui.screens.parts.frames import FRAMES_A_SECOND, FrameContent, FrameSchedule


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def drawing(
    schedule: FrameSchedule,
    frames: int,
    *,
    grows: bool,
    clock: Clock | None = None,
    is_smooth: bool = True,
) -> list[FrameContent]:
    """What so many frames draw, of a run that has grown before each; a clock goes on by a frame before."""
    extents = []
    for _ in range(frames):
        if clock is not None:
            clock.now += 1 / FRAMES_A_SECOND
        if grows:
            schedule.grow()
        extents.append(schedule.next(is_smooth=is_smooth))
        if extents[-1] in (FrameContent.ALL, FrameContent.ALL_BUT_TEXTS):
            schedule.drawn(extents[-1])
    return extents


def test_the_first_frame_draws_everything_and_then_nothing_is_drawn_while_nothing_happens() -> None:
    assert drawing(FrameSchedule(), 30, grows=False) == [FrameContent.ALL, *[FrameContent.NOTHING] * 29]


@pytest.mark.parametrize(
    ("is_smooth", "between"), [(True, FrameContent.LANES), (False, FrameContent.NOTHING)]
)
def test_a_run_that_grows_is_drawn_in_all_panes_together_and_between_on_the_lanes_unless_it_is_fast(
    is_smooth: bool, between: FrameContent
) -> None:
    clock = Clock()
    schedule = FrameSchedule(clock)
    drawing(schedule, 18, grows=True, clock=clock)
    extents = drawing(schedule, 18, grows=True, clock=clock, is_smooth=is_smooth)
    assert [extents.count(kind) for kind in (between, FrameContent.ALL)] == [12, 6]


def test_what_comes_first_or_after_a_pause_is_drawn_in_all_panes_for_a_second() -> None:
    clock = Clock()
    schedule = FrameSchedule(clock)
    drawing(schedule, 1, grows=False)
    for _ in range(2):
        assert FrameContent.LANES not in drawing(schedule, FRAMES_A_SECOND, grows=True, clock=clock)
        assert FrameContent.LANES in drawing(schedule, 9, grows=True, clock=clock)
        drawing(schedule, 9, grows=False, clock=clock)


def test_lanes_are_not_ahead_of_the_other_panes_where_frames_come_seldom() -> None:
    clock = Clock()
    schedule = FrameSchedule(clock)
    drawing(schedule, 18, grows=True, clock=clock)
    for _ in range(9):
        clock.now += 0.3
        assert drawing(schedule, 1, grows=True) == [FrameContent.ALL]


def test_texts_that_were_left_out_are_drawn_although_nothing_more_comes() -> None:
    schedule = FrameSchedule()
    schedule.drawn(FrameContent.ALL_BUT_TEXTS)
    extents = drawing(schedule, 24, grows=False)
    assert extents.count(FrameContent.ALL) == 1
    assert set(extents) == {FrameContent.ALL, FrameContent.NOTHING}


def test_what_the_person_did_is_drawn_at_once_or_soon_after_all_was_drawn() -> None:
    clock = Clock()
    schedule = FrameSchedule(clock)
    schedule.invalidate()
    assert schedule.due_in() is None, "the first time is a frame's"
    schedule.drawn(FrameContent.ALL)
    assert schedule.due_in() is None
    schedule.invalidate()
    due_in = schedule.due_in()
    assert due_in is not None
    assert 0 < due_in < 0.05, "sooner than the next frame"
    clock.now += due_in
    assert schedule.due_in() == 0
    schedule.drawn(FrameContent.ALL)
    clock.now += due_in
    assert schedule.due_in() is None


def test_after_a_frame_that_waited_for_a_processor_nothing_is_drawn_unasked_for_a_while() -> None:
    clock = Clock()
    schedule = FrameSchedule(clock)
    drawing(schedule, 1, grows=False)
    schedule.rest(0.1)
    assert drawing(schedule, 20, grows=True) == [FrameContent.NOTHING] * 20
    schedule.invalidate()
    assert schedule.next() is FrameContent.ALL
    schedule.drawn(FrameContent.ALL)
    clock.now += 0.2
    assert drawing(schedule, 1, grows=True) != [FrameContent.NOTHING]


def test_texts_drawn_after_the_other_panes_take_no_frame_from_what_has_grown_since() -> None:
    schedule = FrameSchedule()
    schedule.drawn(FrameContent.ALL_BUT_TEXTS)
    schedule.grow()
    schedule.drawn(FrameContent.TEXTS)
    assert schedule.next() is not FrameContent.NOTHING
    schedule.drawn(FrameContent.ALL_BUT_TEXTS)
    schedule.drawn(FrameContent.TEXTS)
    assert drawing(schedule, 12, grows=False) == [FrameContent.NOTHING] * 12
