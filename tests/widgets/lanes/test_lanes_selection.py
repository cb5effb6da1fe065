"""Which bar lies where on a lane, and how to go from one to the next."""

from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st

from cbtui.widgets.lanes.rows import GroupLane, Lane, MemberLane, ServiceLane, ThreadLane, all_lanes
from cbtui.widgets.lanes.selection import Selection, bar_at, bar_up_to, neighbouring_bar, start_of
from sim.trace.model import Call, Span, Wait, Window
from sim.trace.timeline import Timeline
from tests.support.properties import examples
from tests.support.runs import ns
from tests.widgets.pictures import dummy_server, shared_group, split_groups

RUNS = (shared_group, split_groups, dummy_server)


def odom_lane(timeline: Timeline) -> Lane:
    lanes = all_lanes(timeline, "")
    return next(lane for lane in lanes if isinstance(lane, MemberLane) and lane.entity.name == "/odom")


def test_a_callbacks_lane_has_its_calls_and_its_waits() -> None:
    lane = odom_lane(shared_group())
    assert isinstance(bar_at(shared_group(), lane, Window(ns(9), ns(9.2))), Wait)
    assert isinstance(bar_at(shared_group(), lane, Window(ns(1), ns(1.01))), Span)
    assert bar_at(shared_group(), lane, Window(ns(0), ns(0.01))) is None


def test_of_two_bars_in_a_column_the_one_is_meant_that_takes_more_of_it() -> None:
    thread = ThreadLane(shared_group().threads[1])
    bar = bar_at(shared_group(), thread, Window(ns(3.9), ns(4.1)))
    assert isinstance(bar, Span)
    assert bar.start == ns(4)


def test_where_nothing_is_the_last_bar_on_screen_is_meant() -> None:
    lane = odom_lane(shared_group())
    empty = Window(ns(1.02), ns(1.021))
    assert bar_at(shared_group(), lane, empty) is None
    before = bar_up_to(shared_group(), lane, empty, Window(0, ns(10)))
    assert before is not None
    assert start_of(before) < ns(1.02)
    assert bar_up_to(shared_group(), lane, Window(0, ns(0.01)), Window(0, ns(10))) is None


def test_a_service_of_others_has_its_calls() -> None:
    timeline = split_groups()
    lane = ServiceLane("/motor_power")
    bar = neighbouring_bar(timeline, lane, 0, 1)
    assert isinstance(bar, Call)
    assert bar_at(timeline, lane, Window(bar.sent, bar.sent + 1)) is bar


@settings(deadline=None, max_examples=examples(30))
@given(st.sampled_from(RUNS).map(lambda timeline: timeline()), st.data())
def test_going_on_and_back_along_a_lane_meets_the_same_bars(timeline: Timeline, data: st.DataObject) -> None:
    lane = data.draw(st.sampled_from(all_lanes(timeline, "/motor_power")))
    at = data.draw(st.integers(0, timeline.end))
    after = neighbouring_bar(timeline, lane, at, 1)
    if after is None:
        return
    assert start_of(after) > at
    further = neighbouring_bar(timeline, lane, start_of(after), 1)
    if further is not None:
        back = neighbouring_bar(timeline, lane, start_of(further), -1)
        assert back is not None
        assert start_of(back) == start_of(after)


def test_a_selection_follows_what_becomes_of_its_bar() -> None:
    young = shared_group(12.9)
    lane = odom_lane(young)
    wait = bar_at(young, lane, Window(ns(9), ns(9.2)))
    assert isinstance(wait, Wait)
    assert wait.end is None
    later = Selection(lane, wait).renewed(shared_group()).bar
    assert isinstance(later, Wait)
    assert later.end == ns(24)


def test_a_bar_that_is_not_known_is_not_selected() -> None:
    lane = odom_lane(shared_group())
    wait = bar_at(shared_group(), lane, Window(ns(9), ns(9.2)))
    assert isinstance(wait, Wait)
    assert Selection(lane, replace(wait, start=ns(1.7))).renewed(shared_group()) == Selection(lane)


def test_the_callback_of_a_selection_is_that_of_its_bar_or_of_its_lane() -> None:
    lane = odom_lane(shared_group())
    assert isinstance(lane, MemberLane)
    assert Selection(lane).entity == lane.entity.id
    thread = ThreadLane(shared_group().threads[1])
    assert Selection(thread).entity is None
    bar = bar_at(shared_group(), thread, Window(ns(9), ns(9.2)))
    assert Selection(thread, bar).entity == bar.entity if isinstance(bar, Span) else False
    assert Selection(GroupLane(shared_group().groups[1])).entity is None
