"""Words on lanes: at any moment of any run and in any width, none is cut and none covers another."""

from unittest.mock import patch

from hypothesis import given, settings
from hypothesis import strategies as st

from cbtui.looks.theme import Ink, TextRun
from cbtui.text.cells import CellRow
from cbtui.widgets.lanes import LanePainter
from sim.trace.events import CallbackAt, Doing, Reason
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.runs import Run

NAMES = ("timer_callback", "odom_callback", "scan", "a_callback_with_a_very_long_name", "tick")
LENGTHS = (0.001, 0.03, 0.4, 2.5)
PAUSES = (0.0, 0.001, 0.3, 1.0)


@st.composite
def timelines(draw: st.DrawFn) -> Timeline:
    """A run of callbacks, inside each other, too, with waits, losses, calls, errors and what a person did."""
    run, more = Run(), []
    names = ("MainThread", "ThreadPoolExecutor-0_0")[: draw(st.integers(1, 2))]
    threads = [run.thread(name) for name in names]
    node = run.node("/n")
    entities = [run.service(run.exclusive(node), "/serve", "serve")]
    for name in draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=4, unique=True)):
        group = run.exclusive(node) if draw(st.booleans()) else run.reentrant(node)
        timer = draw(st.booleans())
        entities.append(
            run.timer(group, name, 0.5) if timer else run.subscription(group, f"/{name}", name, depth=1)
        )
    at = 0.1
    for _ in range(draw(st.integers(1, 10))):
        entity, thread = draw(st.sampled_from(entities)), draw(st.sampled_from(threads))
        lasts = draw(st.sampled_from(LENGTHS))
        other = draw(st.sampled_from(entities))
        match draw(st.integers(0, 6)):
            case 0 if entity != other:
                run.callback(other, thread, at + lasts / 4, lasts / 2)
            case 1 if entity != other:
                run.wait(other, at, at + lasts, draw(st.sampled_from(Reason)), entity)
            case 2:
                run.call("/serve", at, at + lasts if draw(st.booleans()) else None)
            case 3:
                run.call("/motor_power", at, at + lasts / 2, entity=entity)
            case 4:
                run.command("ros2 topic list", at + lasts / 2)
            case 5:
                doing = draw(st.sampled_from(Doing))
                more.append(CallbackAt(ns(at), entity, thread, doing, "wait", (("node.py", "f", 12),)))
        if entity != entities[0] and draw(st.booleans()):
            run.message(entity, at)
            run.message(entity, at)
        run.start(entity, thread, at, late=draw(st.sampled_from((0.0, 0.7))))
        if draw(st.booleans()):
            run.fail(entity, thread, at + lasts, "IndexError: no beam")
        else:
            run.end(entity, thread, at + lasts)
        at += lasts + draw(st.sampled_from(PAUSES))
    timeline = Timeline()
    timeline.extend(sorted([*run.until(at), *more], key=lambda event: event.t))
    return timeline


@given(timelines(), st.integers(40, 200), st.sampled_from((2, 5, 10, 30)), st.floats(0, 1), st.booleans())
@settings(deadline=None, max_examples=60)
def test_no_word_is_cut_and_none_covers_another(
    timeline: Timeline, width: int, seconds: int, share: float, looks_back: bool
) -> None:
    written: list[tuple[CellRow, int, str]] = []
    broken: list[str] = []
    write, runs = CellRow.write, CellRow.runs

    def note(row: CellRow, start: int, text: str, ink: Ink) -> None:
        written.append((row, start, text))
        write(row, start, text, ink)

    def look(row: CellRow) -> list[TextRun]:
        for _, start, text in (each for each in written if each[0] is row):
            shown = "".join(row.cells[start : start + len(text)])
            if start < 0 or shown.rstrip() != text.rstrip():
                broken.append(f"{text!r} at {start} became {shown!r} in {''.join(row.cells)!r}")
        return runs(row)

    end = max(ns(seconds), timeline.end)
    now = round(share * timeline.end) if looks_back else timeline.end
    with patch.object(CellRow, "write", note), patch.object(CellRow, "runs", look):
        LanePainter().paint(timeline, Window(end - ns(seconds), end), now, width, 30, whole=timeline.end)
    assert not broken
