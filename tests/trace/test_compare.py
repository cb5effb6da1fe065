"""Two runs side by side: callbacks are matched by what they are, and figures are of the window only."""

import msgspec
import pytest

from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackFailed,
    CallbackStarted,
    CommandGiven,
    CommandKind,
    EntityAppeared,
    EntityKind,
    GroupAppeared,
    GroupKind,
    MessageDropped,
    NodeAppeared,
    QosMismatched,
    Reason,
    RobotMoved,
    RunEnded,
    RunStarted,
    ThreadAppeared,
    VelocityCommanded,
    WaitEnded,
    WaitStarted,
)
from sim.trace.figures.comparison import compare, covered, first_difference
from sim.trace.figures.comparison_rows import (
    Assessment,
    ComparisonRow,
    sections,
)
from sim.trace.figures.comparison_sentences import Problems, ended_early, extent, is_tie, notable, verdict
from sim.trace.figures.comparison_text import comparison_lines, comparison_text
from sim.trace.figures.comparison_wording import CALLS
from sim.trace.incremental import run_to_end
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline
from tests.support.builder import ns

ODOM, TIMER = "odom_callback", "timer_callback"


def run(callbacks: list[str], events: list[AnyEvent], node: str = "/node") -> Timeline:
    """A run whose entities 1, 2, … have these callbacks, in one group and on one thread."""
    timeline = Timeline()
    cast: list[AnyEvent] = [
        RunStarted(0, "run", "virtual", 0),
        ThreadAppeared(0, 1, "MainThread"),
        NodeAppeared(0, 1, node),
        GroupAppeared(0, 1, 1, GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
    ]
    for number, callback in enumerate(callbacks, start=1):
        kind = EntityKind.TIMER if callback == TIMER else EntityKind.SUBSCRIPTION
        name, depth, period = ("", 0, ns(1.0)) if callback == TIMER else ("/odom", 10, 0)
        cast.append(EntityAppeared(0, number, 1, 1, kind, name, callback, "node.py", 1, 2, depth, period))
    timeline.extend([*cast, *events])
    return timeline


def called(entity: int, start: float, end: float, age: float = 0.0) -> list[AnyEvent]:
    return [CallbackStarted(ns(start), entity, 1, 0, ns(age), 0), CallbackEnded(ns(end), entity, 1)]


def starved() -> Timeline:
    """The timer's callback keeps odom's waiting from 1 to 3 s, and two messages are lost."""
    return run(
        [ODOM, TIMER],
        [
            *called(2, 0.5, 0.6)[:1],
            WaitStarted(ns(1.0), 1, ns(1.0), Reason.GROUP_HELD, 2, False),
            MessageDropped(ns(2.0), 1, 10, 5),
            MessageDropped(ns(2.5), 1, 10, 6),
            CallbackEnded(ns(3.0), 2, 1),
            WaitEnded(ns(3.0), 1),
            *called(1, 3.0, 3.1, age=2.0),
        ],
    )


def healthy() -> Timeline:
    """The same callbacks, made in the other order."""
    return run(
        [TIMER, ODOM], [*called(2, 1.0, 1.1, age=0.1), *called(2, 2.0, 2.1, age=0.2), *called(1, 3.0, 3.2)]
    )


def test_callbacks_match_by_what_they_are_and_not_by_their_numbers() -> None:
    compared = compare(starved(), healthy(), Window(0, ns(4.0)))
    calls = {
        pair.name: (pair.first and pair.first.figures.calls, pair.second and pair.second.figures.calls)
        for pair in compared.callbacks
    }
    assert calls == {ODOM: (1, 2), TIMER: (1, 1)}


def test_a_callback_of_one_run_only_stands_alone() -> None:
    compared = compare(starved(), run([TIMER], called(1, 1.0, 1.1)), Window(0, ns(4.0)))
    (odom,) = (pair for pair in compared.callbacks if pair.name == ODOM)
    assert odom.first is not None
    assert odom.second is None


def test_of_what_reaches_into_the_window_a_wait_counts_from_its_beginning_and_drops_do_not() -> None:
    compared = compare(starved(), healthy(), Window(ns(1.5), ns(2.2)))
    (odom,) = (pair for pair in compared.callbacks if pair.name == ODOM)
    assert odom.first is not None
    assert odom.first.waits is not None
    assert odom.first.waits.longest == ns(1.2)
    assert odom.first.waits.why == "group A held by timer_callback"
    assert odom.first.figures.drops == 1


@pytest.mark.parametrize("start", [1.5, 3.0])
def test_the_usual_wait_in_a_window_does_not_exceed_the_longest(start: float) -> None:
    shown = sections(compare(starved(), healthy(), Window(ns(start), ns(4.0))))
    (waits,) = (row for row in shown[0].rows if row.label == "wait med/max")
    assert waits.figures[0] == "2.0 s / 2.0 s"


def test_what_the_robot_travelled_counts_from_the_windows_beginning() -> None:
    timeline = run([], [moved(0.0, 0.0), moved(1.0, 0.5), moved(2.0, 0.75), moved(3.0, 1.0)])
    compared = compare(timeline, timeline, Window(ns(1.0), ns(2.5)))
    assert compared.first.robot is not None
    assert compared.first.robot.travelled == 0.25


def moved(t: float, travelled: float, *, touching: bool = False, yaw: float = 0.0) -> RobotMoved:
    return RobotMoved(ns(t), travelled, 0.0, yaw, 1.0, 0.1, 0.0, True, touching, yaw, travelled)


def rows_of(first: Timeline, second: Timeline, title: str) -> dict[str, ComparisonRow]:
    compared = compare(first, second, Window(0, ns(4.0)))
    (section,) = (each for each in sections(compared) if each.title == title)
    return {row.label: row for row in section.rows}


def test_a_callback_matches_that_of_a_node_with_another_name() -> None:
    compared = compare(starved(), run([ODOM, TIMER], called(1, 1.0, 1.1), node="/other"), Window(0, ns(4.0)))
    assert [(pair.name, pair.first is None, pair.second is None) for pair in compared.callbacks] == [
        (ODOM, False, False),
        (TIMER, False, False),
    ]


def test_callbacks_match_by_their_node_as_long_as_that_tells_them_apart() -> None:
    two = run([ODOM], called(1, 1.0, 1.1))
    two.extend(
        [
            NodeAppeared(0, 2, "/other"),
            EntityAppeared(0, 9, 2, 1, EntityKind.SUBSCRIPTION, "/odom", ODOM, "node.py", 1, 2, 10, 0),
            *called(9, 2.0, 2.1),
        ]
    )
    compared = compare(run([ODOM], called(1, 1.0, 1.1)), two, Window(0, ns(4.0)))
    assert [(pair.name, pair.first is None) for pair in compared.callbacks] == [
        (f"{ODOM} (/node /odom)", False),
        (f"{ODOM} (/other /odom)", True),
    ]


def test_a_callback_that_never_ran_is_no_callback_that_is_missing() -> None:
    rows = rows_of(run([ODOM], called(1, 1.0, 1.1)), run([ODOM], []), ODOM)
    assert rows["calls"] == ComparisonRow("calls", ("1", "0"), "1 fewer")


def test_what_only_one_run_has_is_listed_as_such() -> None:
    without = run([TIMER], called(1, 1.0, 1.1))
    titles = [each.title for each in sections(compare(starved(), without, Window(0, ns(4.0))))]
    assert titles == [f"{ODOM}: only in run A", TIMER, "whole program"]
    titles = [each.title for each in sections(compare(without, starved(), Window(0, ns(4.0))))]
    assert titles == [TIMER, f"{ODOM}: only in run B", "whole program"]


def test_a_difference_has_a_word_and_a_meaning() -> None:
    there, back = rows_of(starved(), healthy(), ODOM), rows_of(healthy(), starved(), ODOM)
    told = {label: (row.difference, row.assessment) for label, row in there.items()}
    assert told == {
        "calls": ("1 more", Assessment.OTHER),
        "lost": ("2 fewer", Assessment.BETTER),
        "wait med/max": ("max 2.0 s shorter", Assessment.BETTER),
        "age med/max": ("max 1.8 s fresher", Assessment.BETTER),
    }
    assert (back["lost"].difference, back["lost"].assessment) == ("2 more", Assessment.WORSE)
    assert back["age med/max"].difference == "max 1.8 s older"


def test_how_long_calls_take_is_told_where_it_differs_and_is_neither_better_nor_worse() -> None:
    takes = rows_of(starved(), healthy(), TIMER)["takes med/max"]
    assert (takes.difference, takes.assessment) == ("max 2.3 s shorter", Assessment.OTHER)
    assert "takes med/max" not in rows_of(starved(), healthy(), ODOM)


def test_the_callbacks_for_which_a_run_is_better_or_worse_are_listed_first() -> None:
    compared = compare(healthy(), starved(), Window(0, ns(4.0)))
    assert [pair.name for pair in compared.callbacks] == [TIMER, ODOM]
    assert [section.title for section in sections(compared)] == [ODOM, TIMER, "whole program"]
    compared = compare(run([TIMER, ODOM], called(1, 1.0, 1.1)), healthy(), Window(0, ns(4.0)))
    assert [section.title for section in sections(compared)] == [ODOM, TIMER, "whole program"]


def test_the_usual_is_what_differs_where_the_longest_does_not() -> None:
    ages = (0.2, 0.2, 0.5), (0.1, 0.1, 0.5)
    one, other = (
        run([ODOM], [event for at, age in enumerate(each) for event in called(1, at + 1, at + 1.1, age)])
        for each in ages
    )
    row = rows_of(one, other, ODOM)["age med/max"]
    assert (row.figures, row.difference) == (("200 ms / 500 ms", "100 ms / 500 ms"), "med 100 ms fresher")


def test_what_the_robot_did_is_compared_in_words() -> None:
    straight = run([], [moved(0.0, 0.0), moved(3.0, 0.75)])
    clumsy = run(
        [],
        [
            moved(0.0, 0.0),
            moved(1.0, 0.5, touching=True),
            moved(1.5, 0.5, touching=True),
            moved(2.0, 0.5),
            VelocityCommanded(ns(2.0), 0.0, -1.6),
            moved(2.5, 0.5, touching=True),
            moved(3.0, 0.5, yaw=-1.5707963),
        ],
    )
    rows = rows_of(straight, clumsy, "whole program")
    assert rows["robot travelled"].difference == "0.25 m less far"
    assert rows["robot turned"].difference == "1.6 rad more"
    assert rows["collisions"] == ComparisonRow("collisions", ("0", "2"), "2 more", Assessment.WORSE)
    assert rows["robot at x y"].difference == "0.25 m apart"
    assert rows["heading"].difference == "-90° right"


def test_a_run_without_a_robot_has_no_figures_of_one() -> None:
    rows = rows_of(run([], [moved(0.0, 0.0), moved(1.0, 0.5)]), run([], []), "whole program")
    assert rows["collisions"] == ComparisonRow("collisions", ("0", "-"))
    assert "collisions" not in rows_of(run([], []), run([], []), "whole program")
    assert "collisions" not in rows_of(run([], [moved(0.0, 0.0)]), run([], []), "whole program")


def test_a_run_that_goes_on_past_the_window_is_told_of() -> None:
    longer = run([ODOM], called(1, 19.0, 20.0))
    assert extent(Window(0, ns(3.1)), starved().end, longer.end) == "0 to 3.1 s; run B is 20 s long"
    assert extent(Window(ns(0.0005), ns(3.1)), ns(3.1), ns(3.1001)) == "0.001 to 3.1 s"


def test_a_robot_that_stands_still_in_both_runs_has_no_figures() -> None:
    stands = run([ODOM], [moved(0.0, 0.0), *called(1, 1.0, 1.1)])
    assert list(rows_of(stands, stands, "whole program")) == ["threads used", "at once"]


def test_of_runs_in_which_nothing_ran_no_threads_are_counted() -> None:
    *_, whole = sections(compare(run([ODOM], []), run([], []), Window(0, ns(4.0))))
    assert (whole.rows, whole.notes) == ((), ("no callback runs in either, 0 to 4 s",))


def test_an_exception_that_ends_a_run_belongs_to_what_is_compared_of_it() -> None:
    for clock, later in (("virtual", 0.0), ("real", 0.1)):
        start = RunStarted(0, "run", clock, 0)
        raised = CallbackFailed(ns(2.0), 1, 1, "IndexError", "node.py", 2)
        ended = RunEnded(ns(2.0), "it raised", failed=True)
        failed = run([ODOM], [start, *called(1, 1.0, 1.0), *called(1, 2.0, 2.0)[:1], raised, ended])
        longer = run(
            [ODOM], [start, *(each for at in (1, 2, 3) for each in called(1, at + later, at + later))]
        )
        window = Window(0, covered(failed))
        assert (run_to_end(first_difference(failed, longer, window)) == ns(2.0)) is (clock == "virtual")
        odom, _ = sections(compare(failed, longer, window))
        assert {"calls", "errors"} & {row.label for row in odom.rows} == {"calls", "errors"}


def test_two_runs_as_lines_name_the_run_of_each_figure() -> None:
    lines = list(comparison_lines(compare(starved(), healthy(), Window(0, ns(4.0))), "starved", "healthy"))
    assert lines[:3] == [
        "run A: starved",
        "run B: healthy",
        "Run B is better: losses of odom_callback 0 instead of 2, also longest wait of odom_callback.",
    ]
    assert "calls: run A 1, run B 2, 1 more" in lines


def test_two_runs_as_text_side_by_side() -> None:
    text = comparison_text(compare(starved(), healthy(), Window(0, ns(4.0))), "starved", "healthy")
    assert (
        text
        == """\
run A  starved
run B  healthy
0 to 4 s
Run B is better: losses of odom_callback 0 instead of 2, also longest wait of
odom_callback.

                 run A          run B            B against A

odom_callback
  calls          1              2                1 more
  lost           2              0                2 fewer
  wait med/max   2.0 s / 2.0 s  0 s / 0 s        max 2.0 s shorter
  age med/max    2.0 s / 2.0 s  100 ms / 200 ms  max 1.8 s fresher
  run A waits: group A held by timer_callback

timer_callback
  calls          1              1                same
  takes med/max  2.5 s / 2.5 s  200 ms / 200 ms  max 2.3 s shorter
  wait med/max   0 s / 0 s      0 s / 0 s        same
  late med/max   0 s / 0 s      0 s / 0 s        same

whole program
  threads used   1              1                same
  at once        1              1                same
"""
    )
    assert max(map(len, text.splitlines())) <= 80


def test_a_verdict_says_which_run_is_better_and_by_what() -> None:
    window = Window(0, ns(4.0))
    better, worse = (
        verdict(compare(starved(), healthy(), window)),
        verdict(compare(healthy(), starved(), window)),
    )
    assert better == f"run B is better: losses of {ODOM} 0 instead of 2, also longest wait of {ODOM}"
    assert worse == f"run B is worse: losses of {ODOM} 2 instead of 0, also longest wait of {ODOM}"
    assert verdict(compare(healthy(), healthy(), window)).startswith("Neither run is better")


def test_of_runs_that_were_not_given_the_same_commands_neither_is_better() -> None:
    asked, paused = (
        [CommandGiven(ns(at), text, kind) for at in times]
        for text, kind, times in (
            ("call /turn true", CommandKind.CALL, (0.5, 1.0, 1.5)),
            ("pause", CommandKind.PAUSE, (0.6,)),
        )
    )
    unasked, thrice, once = (
        run([ODOM, TIMER], [*given, *called(1, 3.0, 3.1, age=1.0)]) for given in (paused, asked, asked[:1])
    )
    after = run([ODOM, TIMER], called(1, 3.0, 3.1))

    def compared(first: Timeline, second: Timeline, end: float = 4.0) -> str:
        return verdict(compare(first, second, Window(0, ns(end))))

    only = "only with as many in both can one be better; cbtui compare --call SECONDS gives both the same"
    assert compared(thrice, after) == f"run A has 3 'call /turn true', run B has none: {only}"
    assert compared(after, thrice) == f"run A has no 'call /turn true', run B has 3: {only}"
    assert compared(once, thrice, end=1.0).startswith("Neither")
    assert compared(unasked, after).startswith("run B is better")
    assert not is_tie(compare(thrice, after, Window(0, ns(4.0))))


def test_lower_figures_of_far_fewer_calls_speak_for_no_run() -> None:
    never = run([ODOM, TIMER], [])
    old = run([ODOM, TIMER], called(1, 1.0, 1.1, age=0.5))
    assert verdict(compare(never, old, Window(0, ns(4.0)))).startswith("Neither")
    again = run([ODOM, TIMER], [*called(1, 1.0, 1.1), *called(1, 2.0, 2.1)])
    assert "oldest data" in verdict(compare(old, again, Window(0, ns(4.0))))


def test_fewer_losses_in_far_fewer_calls_do_not_outweigh_a_wait() -> None:
    hangs = run(
        [ODOM, TIMER], [WaitStarted(ns(1.0), 2, ns(1.0), Reason.GROUP_HELD, 1, False), *called(1, 1.0, 1.1)]
    )
    calls = [event for at in (1.0, 2.0, 3.0) for event in called(1, at, at + 0.1)]
    works = run([ODOM, TIMER], [*calls, MessageDropped(ns(3.5), 1, 10, 5)])
    told = verdict(compare(hangs, works, Window(0, ns(4.0))))
    assert told.startswith(f"run B is better: longest wait of {TIMER} 0 s instead of 100 ms")
    assert told.endswith(f"; but losses of {ODOM} 1 instead of 0")


def test_a_run_that_an_error_ends_and_one_that_hears_nothing_are_worse() -> None:
    window = Window(0, ns(4.0))
    deaf = QosMismatched(ns(1.0), "/odom", 1, 1, "RELIABILITY")
    crash = RunEnded(ns(3.0), "the program raised", failed=True)
    well = run([ODOM], called(1, 1.0, 1.1))
    twice = [deaf, msgspec.structs.replace(deaf, node=2)]
    told = verdict(compare(run([ODOM], [*twice, *called(1, 1.0, 1.1)]), well, window))
    assert told == "run B is better: subscriptions that do not match a publisher 0 instead of 1"
    told = verdict(compare(run([ODOM], [*called(1, 1.0, 1.1), crash]), well, window))
    assert told == "run B is better: runs that an error ends 0 instead of 1"


def test_collisions_of_a_robot_that_drives_do_not_outweigh_what_was_cured() -> None:
    window = Window(0, ns(4.0))
    deaf = QosMismatched(ns(1.0), "/odom", 1, 1, "RELIABILITY")
    clumsy = run(
        [ODOM], [touch for t in (1.0, 2.0) for touch in (moved(t, 0.5, touching=True), moved(t + 0.5, 0.5))]
    )
    still = [moved(0.0, 0.0), moved(3.0, 0.0)]
    told = verdict(compare(run([ODOM], [*still, deaf]), clumsy, window))
    assert told == (
        "run B is better: subscriptions that do not match a publisher 0 instead of 1; "
        "but collisions 2 instead of 0"
    )
    cured = compare(run([ODOM], [*still]), clumsy, window)
    gone, new = Problems(speaks=1), Problems(speaks=-1)
    assert verdict(cured, gone) == "run B is better by what is gone; but collisions 2 instead of 0"
    assert verdict(cured, new) == verdict(cured)
    assert verdict(cured) == "run B is worse: collisions 2 instead of 0"


def hanging(entity: int, since: float, at: float = 1.0) -> list[AnyEvent]:
    """A callback that waits from a time on for a call that does not end."""
    return [
        CallbackStarted(ns(at), 3 - entity, 1, 0, 0, 0),
        WaitStarted(ns(since), entity, ns(since), Reason.GROUP_HELD, 3 - entity, False),
    ]


def test_what_waits_for_ever_in_both_runs_speaks_for_none_however_long_it_has_waited() -> None:
    window, cast = Window(0, ns(6.0)), [ODOM, TIMER]
    early, late = (run(cast, [*hanging(1, since), moved(6.0, 0)]) for since in (1.0, 3.0))
    compared = compare(early, late, window)
    assert verdict(compared) == f"Neither run is better: in both {ODOM} still waits"
    (waits,) = (row for row in sections(compared)[0].rows if row.label == "wait med/max")
    assert (waits.figures, waits.difference) == (("- / 5.0 s", "- / 3.0 s"), "goes on in both")
    other = compare(early, run(cast, [*hanging(2, 1.0), moved(6.0, 0)]), window)
    assert "longest wait" in verdict(other)
    assert verdict(other, Problems(stuck=True)) == "Neither run is better: both are stuck"


def test_what_is_gone_or_new_decides_where_figures_do_not_and_there_is_no_tie() -> None:
    same = compare(healthy(), healthy(), Window(0, ns(4.0)))
    assert verdict(same, Problems(speaks=1)) == "run B is better by what is gone"
    assert verdict(same, Problems(speaks=-1)) == "run B is worse by what is new"
    assert verdict(same, Problems(speaks=0)) == "Neither run is better by its figures"
    ties = [Problems(), Problems(speaks=0), Problems(speaks=1), Problems(stuck=True)]
    assert [is_tie(same, each) for each in ties] == [True, False, False, False]
    better = compare(starved(), healthy(), Window(0, ns(4.0)))
    assert verdict(better, Problems(speaks=-1)).startswith(
        f"run B is worse by what is new; but losses of {ODOM} 0 instead of 2"
    )


def test_further_differences_are_named_if_they_are_few_and_else_counted() -> None:
    names = [ODOM, "scan_callback", "map_callback", "tf_callback", TIMER]

    def waits(length: float, callbacks: int) -> Timeline:
        waits = [
            event
            for entity in range(1, callbacks + 1)
            for event in (
                WaitStarted(ns(1.0), entity, ns(1.0), Reason.GROUP_HELD, 5, False),
                WaitEnded(ns(1.0 + length / entity), entity),
            )
        ]
        return run(names, sorted([*waits, *called(5, 0.5, 3.1)], key=lambda each: each.t))

    def better(callbacks: int) -> str:
        compared = compare(waits(2.0, callbacks), waits(0.0, callbacks), Window(0, ns(4.0)))
        return verdict(compared).removeprefix(f"run B is better: longest wait of {ODOM} 0 s instead of 2.0 s")

    ways = [better(callbacks) for callbacks in range(1, 5)]
    assert ways[:2] == ["", ", also of scan_callback"]
    assert ways[2:] == [", also of scan_callback and map_callback", ", and in 3 more ways"]


def test_a_run_that_an_exception_ended_while_the_other_goes_on_is_told_instead_of_a_verdict() -> None:
    crash = RunEnded(ns(3.0), "the program raised", failed=True)
    fails, works = run([ODOM], [*called(1, 1.0, 1.1), crash]), run([ODOM], called(1, 5.0, 6.0))
    compared = compare(fails, works, Window(0, ns(3.0)))
    assert ended_early(compared) == "Run A ended at 3 s with an exception; run B has none up to 6 s"
    assert "Run A ended at 3 s with an exception; run B has none up to 6 s.\n" in comparison_text(
        compared, "a", "b"
    )
    assert ended_early(compare(works, works, Window(0, ns(3.0)))) == ""


def test_a_run_that_goes_on_to_an_exception_of_its_own_is_not_said_to_go_on() -> None:
    first, second, alike = (
        run([ODOM], [RunEnded(ns(at), "the program raised", failed=True)]) for at in (3.0, 3.5, 3.0001)
    )
    compared = compare(first, second, Window(0, ns(3.0)))
    assert ended_early(compared) == "Run A ended at 3 s with an exception, and run B at 3.5 s with one"
    assert ended_early(compare(first, alike, Window(0, ns(3.0)))) == ""


def test_runs_first_differ_where_a_call_does_otherwise() -> None:
    def differ(first: list[AnyEvent], second: list[AnyEvent]) -> Nanoseconds | None:
        return run_to_end(first_difference(run([ODOM], first), run([ODOM], second), Window(0, ns(4.0))))

    same = called(1, 1.0, 1.1)
    assert differ(same, same) is None
    assert differ([*same, *called(1, 2.0, 2.1)], [*same, *called(1, 2.0, 2.5)]) == ns(2.1)
    assert differ(same, [*same, *called(1, 3.0, 3.1)]) == ns(3.0)
    assert differ(same, called(1, 1.0001, 1.1001)) is None


def test_in_a_window_runs_differ_from_its_beginning_on_at_the_earliest() -> None:
    long, short = run([ODOM], called(1, 1.0, 3.0)), run([ODOM], called(1, 1.0, 1.1))
    assert run_to_end(first_difference(long, short, Window(0, ns(4.0)))) == ns(1.1)
    other = run([ODOM], called(1, 2.5, 2.6))
    assert run_to_end(first_difference(long, other, Window(ns(2.0), ns(4.0)))) == ns(2.0)


def test_on_the_real_clock_runs_differ_by_more_than_a_start_that_is_a_little_later() -> None:
    def differ(first: list[AnyEvent], second: list[AnyEvent]) -> Nanoseconds | None:
        one, other = (run([ODOM], [RunStarted(0, "run", "real", 0), *events]) for events in (first, second))
        return run_to_end(first_difference(one, other, Window(0, ns(4.0))))

    assert differ(called(1, 1.0, 1.1), called(1, 1.05, 1.15)) is None
    assert differ(called(1, 1.0, 1.1), called(1, 1.05, 1.9)) == ns(1.1)
    often = [each for at in range(1, 30) for each in called(1, at / 10, at / 10 + 0.01)]
    drifts = [each for at in range(1, 28) for each in called(1, 0.5 + at / 9.5, 0.5 + at / 9.5 + 0.01)]
    assert differ(often, drifts) is None
    assert differ([*often[:20], *often[40:]], drifts) is not None


def on_the_real_clock(first: float, losses: int, wait: float = 0.0) -> Timeline:
    """A callback that runs each 100 ms from a time on and loses so many messages, one in each call."""
    calls = [each for at in range(30) for each in called(1, first + at / 10, first + at / 10 + 0.01)]
    drops = [MessageDropped(ns(first + (at + 0.5) * 3 / losses), 1, 10, 5) for at in range(losses)]
    waits = [
        WaitStarted(ns(first), 1, ns(first), Reason.GROUP_HELD, 1, False),
        WaitEnded(ns(first + wait), 1),
    ]
    return run(
        [ODOM], [RunStarted(0, "run", "real", 0), *sorted([*calls, *drops, *waits], key=lambda e: e.t)]
    )


def starved_for_real(calls: int) -> Timeline:
    """A callback that is called so many times in some seconds beside a timer on the real clock."""
    ticks = [each for at in range(3) for each in called(2, at, at + 0.1)]
    own = [each for at in range(calls) for each in called(1, at + 0.5, at + 0.6)]
    events = sorted([*ticks, *own], key=lambda each: each.t)
    return run([ODOM, TIMER], [RunStarted(0, "run", "real", 0), *events])


@pytest.mark.parametrize(("wait", "has_reason"), [(0.005, False), (0.05, True)])
def test_the_reason_is_told_of_a_wait_that_can_be_noticed(wait: float, has_reason: bool) -> None:
    waiting = on_the_real_clock(1.0, 3, wait)
    odom, _ = sections(compare(waiting, waiting, Window(0, ns(4.0))))
    assert any("group A held by" in note for note in odom.notes) is has_reason


def test_runs_on_the_real_clock_are_compared_from_their_first_calls_on() -> None:
    early, late = on_the_real_clock(0.2, 30), on_the_real_clock(1.1, 30)
    compared = compare(early, late, Window(0, ns(2.6)))
    (odom,) = compared.callbacks
    assert odom.first is not None
    assert odom.second is not None
    assert odom.first.figures.calls == odom.second.figures.calls
    assert odom.first.figures.drops == odom.second.figures.drops
    assert run_to_end(first_difference(early, late, Window(0, ns(2.6)))) is None


def test_a_client_is_named_after_the_reply_and_a_service_below_its_node_by_its_name_alone() -> None:
    timeline = run([TIMER], [])
    server, client = EntityKind.SERVICE, EntityKind.CLIENT
    made = ((2, server, "/node/ask", "on_ask"), (3, server, "/ask", "on_ask"), (4, client, "/node/ask", ""))
    timeline.extend(
        EntityAppeared(0, number, 1, 1, kind, name, callback, "node.py", 1, 2, 0, 0)
        for number, kind, name, callback in made
    )
    for number in (2, 3, 4):
        timeline.extend(called(number, number, number + 0.1))
    pairs = compare(timeline, timeline, Window(0, ns(6.0))).callbacks
    assert [each.name for each in pairs] == [
        "on_ask (/node/ask)",
        "on_ask (/node /ask)",
        "reply of /node/ask",
    ]


def test_what_is_lost_before_the_first_call_of_a_run_on_the_real_clock_counts() -> None:
    drops = [MessageDropped(ns(0.1), 1, 10, 5)] * 9
    calls = called(1, 1.0, 1.1)
    one, other = (run([ODOM], [RunStarted(0, "run", "real", 0), *lost, *calls]) for lost in (drops, ()))
    lost = sections(compare(one, other, Window(0, ns(1.2))))[0].rows[1]
    assert (lost.label, lost.figures) == ("lost", ("9", "0"))


def test_what_differs_by_noise_on_the_real_clock_is_about_the_same() -> None:
    window = Window(0, ns(4.0))
    compared = compare(on_the_real_clock(1.0, 69, wait=0.03), on_the_real_clock(1.0, 74), window)
    assert verdict(compared).startswith("Both runs are about the same")
    rows = {row.label: (row.difference, row.assessment) for row in sections(compared)[0].rows}
    assert rows["lost"] == rows["wait med/max"] == ("about the same", Assessment.SAME)
    calls, *_ = sections(compare(starved_for_real(0), starved_for_real(2), window))[0].rows
    assert (calls.label, calls.difference) == ("calls", "2 more")
    for one, other, told in ((0, 2, "2 instead of 0"), (3, 1, "1 instead of 3"), (2, 2, "about the same")):
        assert told in verdict(compare(starved_for_real(one), starved_for_real(other), window))
    assert CALLS.is_noise(2, 4)
    assert not CALLS.is_noise(1, 5)
    compared = compare(on_the_real_clock(1.0, 69), on_the_real_clock(1.0, 20), window)
    assert verdict(compared).startswith(f"run B is better: losses of {ODOM}")


def test_a_callback_that_hardly_runs_in_one_of_the_runs_is_unlike() -> None:
    other = run([TIMER, ODOM], [*called(1, 1.0, 1.1), *called(1, 2.0, 2.1), *called(1, 3.0, 3.1)])
    compared = compare(healthy(), other, Window(0, ns(4.0)))
    assert list(map(set, notable(compared))) == [{1, 2}, {1, 2}]
    assert not any(notable(compare(healthy(), healthy(), Window(0, ns(4.0)))))
    alone = compare(healthy(), run([TIMER], called(1, 1.0, 1.1)), Window(0, ns(4.0)))
    assert list(map(set, notable(alone))) == [{2}, set()]


def test_a_callback_that_takes_longer_in_one_of_the_runs_is_notable() -> None:
    one, other = (run([TIMER, ODOM], [*called(1, 0.0, end), *called(2, 2.0, 2.1)]) for end in (0.1, 1.0))
    assert notable(compare(one, other, Window(0, ns(4.0)))) == ({1: 0}, {1: 0})


def test_the_callback_that_decides_the_verdict_is_the_most_notable() -> None:
    compared = compare(starved(), healthy(), Window(0, ns(4.0)))
    assert verdict(compared).startswith(f"run B is better: losses of {ODOM}")
    assert [ranks[odom] for ranks, odom in zip(notable(compared), (1, 2), strict=True)] == [0, 0]


def test_the_compared_part_on_the_real_clock_begins_with_the_first_calls() -> None:
    compared = compare(on_the_real_clock(1.0, 3), on_the_real_clock(1.0, 3), Window(0, ns(3.0)))
    assert "\n0 to 3 s; each from its first call on;" in comparison_text(compared, "a", "b")


def test_a_callback_whose_function_says_nothing_has_the_name_that_it_has_elsewhere() -> None:
    timeline = run(["callback"], called(1, 0.5, 0.6))
    (pair,) = compare(timeline, timeline, Window(0, ns(1.0))).callbacks
    assert pair.name == timeline.entities[1].spoken_name


def test_a_run_that_ends_in_its_first_call_is_compared_with_the_first_call_of_the_other_one() -> None:
    began = RunStarted(0, "run", "real", 0)
    short = run([TIMER], [began, *called(1, 1.0, 1.01), RunEnded(ns(1.02), "exception", failed=True)])
    other = run([TIMER], [began, *called(1, 1.05, 1.06), *called(1, 2.05, 2.06)])
    (pair,) = compare(short, other, Window(0, covered(short))).callbacks
    assert pair.calls == (1, 1)
    nothing_yet = compare(other, other, Window(0, ns(0.5)))
    assert not nothing_yet.callbacks
