import pytest

from cbtui.widgets.log import FilterError, filter_of
from sim.trace.events import Logged, Printed, Severity
from sim.trace.timeline import Timeline
from tests.support.builder import Run


def written() -> Timeline:
    """Odom (group A) and scan (B) on two threads of a pool, main (no callback), and two printed lines."""
    run = Run()
    first, second = run.thread("ThreadPoolExecutor-0_0"), run.thread("ThreadPoolExecutor-0_1")
    node = run.node("/n")
    odom = run.subscription(run.exclusive(node), "/odom", "on_motion")
    scan = run.subscription(run.exclusive(node), "/scan", "scan_callback")
    run.add(Logged(1, Severity.INFO, "n", "Turning left", first, odom))
    run.add(Logged(2, Severity.WARN, "n", "too close: 0.3 m", second, scan))
    run.add(Logged(3, Severity.ERROR, "other", "no scan", first, odom))
    run.add(Logged(4, Severity.DEBUG, "n", "it's done:", 0, 0))
    run.add(Printed(5, "TICK", False))
    run.add(Printed(6, "Traceback", True))
    timeline = Timeline()
    timeline.extend(run.events)
    return timeline


EVERY = [1, 2, 3, 4, 5, 6]


@pytest.mark.parametrize(
    ("text", "times"),
    [
        ("", EVERY),
        ("   ", EVERY),
        ("turning", [1]),
        ("TURNING LEFT", [1]),
        ("left turning", [1]),
        ('"left turning"', []),
        ('"turning left"', [1]),
        ('"turning le', [1]),
        ("warn", [2]),
        ("it's", [4]),
        ("done:", [4]),
        ("0.3", [2]),
        ("level:debug", EVERY),
        ("level:info", [1, 2, 3, 5, 6]),
        ("level:warn", [2, 3, 6]),
        ("level:WARNING", [2, 3, 6]),
        ("level:error", [3, 6]),
        ("level:fatal", []),
        ("level:error level:warn", [2, 3, 6]),
        ("callback:scan", [2]),
        ("callback:odom", [1, 3]),
        ("callback:motion", [1, 3]),
        ("callback:odom callback:scan", [1, 2, 3]),
        ("callback:scan_callback", [2]),
        ("thread:0_1", [2]),
        ("thread:pool", [1, 2, 3]),
        ("group:a", [1, 3]),
        ("Group:B", [2]),
        ("group:a level:error", [3]),
        ("group:a scan", [3]),
        ('callback:"on_motion"', [1, 3]),
        ('"callback:odom"', []),
    ],
)
def test_a_filter_lets_through_what_it_says(text: str, times: list[int]) -> None:
    timeline = written()
    wanted = filter_of(text)
    assert [event.t for event in timeline.logs if wanted.passes(event, timeline)] == times


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("level:", "level: wants one of debug, info, warn, error, fatal"),
        ("level:loud", "level: wants one of debug, info, warn, error, fatal"),
        ("odom callback:", "callback: wants a part of its name, such as callback:odom"),
        ("thread:", "thread: wants a part of its name, such as thread:0_1"),
        ("group:", "group: wants a letter, such as group:A"),
        (
            "levl:warn",
            'there is no levl: to filter by, only level:, callback:, thread:, group:, or put it in "quotes"',
        ),
    ],
)
def test_a_filter_that_means_nothing_gets_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(FilterError) as raised:
        filter_of(text)
    assert str(raised.value) == sentence


def test_an_address_and_quoted_words_with_a_colon_are_words() -> None:
    assert filter_of('http://x "a:b"').words == ("http://x", "a:b")


def test_only_an_empty_filter_lets_all_through() -> None:
    assert filter_of(" ").passes_all
    assert not filter_of("x").passes_all
