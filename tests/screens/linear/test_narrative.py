"""What the console for screen readers tells of a run: each thing once, in order, in words alone."""

from cbtui.runs.live.findings import FindingsMonitor
from cbtui.screens.linear.narrative import LEAST, Narrative
from cbtui.screens.linear.plain import plain, plain_lines
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events


def told(*until: float, least: int = LEAST[2], whole: bool = False) -> list[str]:
    """What is told of the run if one looks at these moments."""
    timeline = Timeline()
    narrative, monitor = Narrative(timeline), FindingsMonitor(timeline)
    narrative.least, narrative.whole = least, whole
    lines, events = [], list(EVENTS)
    for seconds in until:
        timeline.extend([event for event in events if event.t <= ns(seconds)])
        events = [event for event in events if event.t > ns(seconds)]
        monitor.update()
        lines += narrative.news(timeline.end, monitor.findings)
    return lines


def test_a_long_call_is_told_as_it_goes_on_and_as_it_ends() -> None:
    lines = told(3.9, 4.3, 8.0, 13.9, 30.0)
    begins = "4.000 s: timer_callback runs on MainThread"
    assert lines.count(begins) == 1 < len(lines)
    assert lines.count("14.000 s: timer_callback returns after 10.0 s, group A is free") == 1
    assert any("odom_callback waits, 1 queued: group A held by timer_callback" in line for line in lines)
    assert any("odom_callback waits no longer, after" in line for line in lines)


def test_calls_from_outside_are_told_with_their_replies_and_when_those_are_late() -> None:
    run = Run()
    run.call("/quick", 1.0, 1.5)
    run.call("/slow", 2.0, 4.0)
    run.call("/lost", 5.0)
    run.stop(8.0)
    for looks in ((8.0,), (1.0, 1.2, 3.0, 3.5, 6.0, 8.0)):
        timeline, lines = Timeline(), list[str]()
        narrative, past = Narrative(timeline), -1
        for now in map(ns, looks):
            timeline.extend([event for event in run.events if past < event.t <= now])
            lines += narrative.news(now, ())
            past = now
        assert [line for line in lines if "/" in line] == [
            "1.000 s: /quick is called",
            "1.500 s: /quick replied success=True",
            "2.000 s: /slow is called",
            "3.000 s: /slow has had no reply for 1.0 s",
            "4.000 s: /slow replied success=True",
            "5.000 s: /lost is called",
            "6.000 s: /lost has had no reply for 1.0 s",
        ]


def test_it_does_not_matter_when_one_looks() -> None:
    calls = [line for line in told(*(step / 4 for step in range(60))) if not line.startswith(("log", "pro"))]
    at_once = [line for line in told(3.9, 4.3, 14.75) if not line.startswith(("log", "pro"))]
    assert calls == at_once


def test_short_calls_are_told_only_if_that_is_wanted() -> None:
    assert not any("scan_callback runs" in line for line in told(3.0))
    every = told(3.0, 3.1, least=0)
    assert every == sorted(set(every), key=every.index)


def test_each_text_of_the_log_is_told_once_and_all_lines_on_request() -> None:
    lines = told(3.0)
    assert sum("Odom CallBack" in line for line in lines) == 1
    assert sum("Odom CallBack" in line for line in told(3.0, whole=True)) > 10


def test_a_problem_is_told_once_with_what_to_do() -> None:
    problems = [line for line in told(5.6, 6.0, 12.0) if line.startswith("problem: group starvation")]
    assert len(problems) == 1
    assert "what to do: " in problems[0]


def test_a_run_that_is_known_already_is_told_up_to_a_moment_and_once_more_from_an_earlier_one() -> None:
    timeline = Timeline()
    timeline.extend(EVENTS)
    monitor, narrative = FindingsMonitor(timeline), Narrative(timeline)
    monitor.update()
    assert not any("returns" in line for line in narrative.news(ns(5.0), monitor.findings))
    narrative.news(ns(20.0), monitor.findings)
    again = narrative.news(ns(14.2), monitor.findings)
    assert "14.000 s: timer_callback returns after 10.0 s, group A is free" in again
    assert any(line.startswith("problem: group starvation") for line in again)
    calls = [line for line in again if not line.startswith("problem")]
    assert calls == [line for line in told(14.2) if not line.startswith("problem")]


def test_no_sign_has_to_be_read_aloud() -> None:
    assert plain("✓ You were right: timer → runs") == "right: You were right: timer, runs"
    assert plain_lines(r"- file: run\.mcap \*") == ["- file: run.mcap *"]
    text = "# A title\n\nSome `code` and **bold**\ntext.\n\n- one\n  and more\n- two\n\n> said\n"
    assert plain_lines(text) == ["A title", "Some code and bold text.", "- one and more", "- two", "said"]
