"""The page that plays a run: nothing comes from outside, nothing breaks out, and a browser shows the run."""

import json
import re
import subprocess
from html import unescape
from pathlib import Path

import pytest
from msgspec.structs import replace

from sim.export.html import page
from sim.trace.events import Logged, Printed, RobotMoved, RunEnded, RunStarted
from sim.trace.timeline import Timeline
from tests.export.examples import NASTY, small_run, timeline_of
from tests.support.builder import ns
from tests.support.engine_runs import run_lesson
from tests.support.lesson_runs import shared_group_run
from tests.support.runs import Run
from tests.web.chromium import PROGRAM


def begun_late(at: float = 4.0) -> Timeline:
    """The last seconds of a run of fourteen, as a recording has them that was begun late."""
    events = [each for each in shared_group_run().events if each.t <= ns(14.0)]
    run = [replace(each, known_from=ns(at)) if isinstance(each, RunStarted) else each for each in events]
    return timeline_of([*run, RunEnded(ns(14.0), "", failed=False)])


def still_calling() -> Timeline:
    """A node that calls a service in a callback: the reply finds the callback's group taken."""
    run = Run("still calling")
    main, pool = run.thread("ThreadPoolExecutor-0_0"), run.thread("ThreadPoolExecutor-0_1")
    node = run.node("/picker")
    own, serving = run.exclusive(node), run.exclusive(node)
    pick, serve = run.timer(own, "pick", period=1.0), run.service(serving, "/gripper", "move")
    reply = run.client(own, "/gripper")
    run.start(pick, main, 1.0)
    call = run.call("/gripper", 1.0, 1.3, entity=pick)
    run.blocked(call, "/gripper", main, pick, 1.0)
    run.callback(serve, pool, 1.0, 0.3)
    run.message(reply, 1.3)
    run.wait(reply, 1.3, holder=pick)
    run.call("/nowhere", 2.0)
    run.call("/nowhere", 2.5)
    run.over(3.0)
    return timeline_of(run.events)


def data(text: str) -> dict[str, object]:
    found = re.search(r'<script type="application/json" id="run">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    run: dict[str, object] = json.loads(found[1])
    return run


def test_a_page_has_all_rows_log_lines_findings_and_the_robot() -> None:
    run = timeline_of(shared_group_run().events)
    shown = data(page(run))
    names = [row["name"] for row in shown["rows"]]  # type: ignore[attr-defined]
    assert names[-3:] == ["odom_callback", "scan_callback", "timer_callback"]
    assert len(shown["log"]) == len(run.logs)  # type: ignore[arg-type]
    assert shown["robot"]
    assert shown["arena"]
    assert any("waited" in each["what"] for each in shown["findings"])  # type: ignore[attr-defined]


def test_what_a_program_prints_stays_data_and_nothing_comes_from_outside() -> None:
    text = page(timeline_of(small_run()))
    assert NASTY in [callback["name"] for callback in data(text)["callbacks"]]  # type: ignore[attr-defined]
    assert "<b>" not in text.partition('id="run">')[2].partition("</script>")[0]
    assert "default-src 'none'" in text
    assert not re.search(r"https?:|src=|href=|import\(|fetch\(", text)


def shown_by_browser(text: str, moment: str, folder: Path) -> str:
    """The document of a page, as a browser has made it at a moment of the run."""
    file = folder / "run.html"
    file.write_text(text, encoding="utf-8")
    command = [str(PROGRAM), "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    address = f"{file.as_uri()}#{moment}"
    return subprocess.run([*command, address], capture_output=True, text=True, check=True).stdout


def told_by_browser(dom: str) -> dict[str, str]:
    """What a page tells of each callback and service at its moment."""
    return dict(re.findall(r"<div><b>([^<]*)</b><span[^>]*>([^<]*)</span>", dom))


def drawn_by_browser(text: str, folder: Path, wide: int) -> list[tuple[str, float, float]]:
    """The texts on the lanes of a page of some width, and from where to where they reach."""
    spy = """const spied = [], pen = CanvasRenderingContext2D.prototype, fill = pen.fillText;
      pen.fillText = function (text, x, y) {
        spied.push([text, x, x + this.measureText(text).width]); fill.call(this, text, x, y); };
      drawLanes(); document.title = JSON.stringify(spied);"""
    styled = text.replace("</style>", f"main {{ width: {wide}px; padding: 0 !important; }}</style>")
    dom = shown_by_browser(styled.replace("</body>", f"<script>{spy}</script></body>"), "5", folder)
    found = re.search("<title>(.*?)</title>", dom)
    assert found is not None
    return [tuple(each) for each in json.loads(unescape(found[1]))]


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_a_log_without_lines_says_so(tmp_path: Path) -> None:
    quiet = [event for event in small_run() if not isinstance(event, Logged | Printed)]
    assert "<span>nothing so far</span>" in shown_by_browser(page(timeline_of(quiet)), "0", tmp_path)


def test_what_was_begun_during_a_run_is_no_longer_than_from_there_on() -> None:
    shown = data(page(begun_late()))
    assert (shown["begin"], shown["end"]) == (4e6, 14e6)
    assert str(shown["subtitle"]).startswith("10.0 s of virtual time, from 4.000 s of its run on")


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_what_was_begun_during_a_run_plays_from_there(tmp_path: Path) -> None:
    dom = shown_by_browser(page(begun_late()), "", tmp_path)
    assert '<output id="now">4.000 s</output>' in dom


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_a_narrow_page_is_no_wider_than_its_window(tmp_path: Path) -> None:
    text = page(timeline_of(shared_group_run().events)).replace("</style>", "main { width: 320px; }</style>")
    told = "const main = document.querySelector('main'); document.title = `${main.scrollWidth} wide`"
    dom = shown_by_browser(text.replace("</body>", f"<script>{told}</script></body>"), "6.5", tmp_path)
    assert "<title>320 wide</title>" in dom


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
@pytest.mark.parametrize("width", ["auto", "0"])  # a frame or a tab that is not shown yet has none
def test_a_browser_shows_what_waits_at_a_moment(width: str, tmp_path: Path) -> None:
    text = page(timeline_of(shared_group_run().events))
    styled = text.replace("</style>", f"main {{ width: {width}; }}</style>")
    dom = shown_by_browser(styled, "6.5", tmp_path)
    assert '<output id="now">6.500 s</output>' in dom
    assert re.search(
        r"<b>scan_callback</b><span class=\"waits\">waits 2\.\d+ s: group A held by timer_callback", dom
    )
    assert re.search(r"<b>timer_callback</b><span class=\"\">has run for 2\.5", dom)


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_what_goes_on_at_the_end_is_told_there_too(tmp_path: Path) -> None:
    told = told_by_browser(shown_by_browser(page(still_calling()), "3", tmp_path))
    assert told == {
        "reply of /gripper": "waits 1.70 s: group A held by pick",
        "pick": "has run for 2.00 s, blocked in the call of /gripper",
        "move": "—",
        "/gripper": "called by pick at 1.000 s: replied after 300 ms",
        "/nowhere": "called from outside at 2.000 s: no reply for 1.00 s; 2 calls so far, 2 without a reply",
    }


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_a_call_is_told_while_it_has_no_reply(tmp_path: Path) -> None:
    told = told_by_browser(shown_by_browser(page(still_calling()), "1.2", tmp_path))
    assert told["/gripper"] == "called by pick at 1.000 s: no reply for 200 ms"
    assert told["/nowhere"] == "—"


def test_calls_have_rows_with_who_called_and_what_came_back() -> None:
    rows = {row["name"]: row for row in data(page(still_calling()))["rows"]}  # type: ignore[attr-defined]
    assert [call[:3] for call in rows["/gripper"]["calls"]] == [[1e6, 1.3e6, "called by pick"]]
    assert [call[:2] for call in rows["/nowhere"]["calls"]] == [[2e6, None], [2.5e6, None]]
    assert rows["pick"]["blocks"] == rows["ThreadPoolExecutor-0_0"]["blocks"] != []


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_what_was_found_before_a_recording_begins_leads_nowhere(tmp_path: Path) -> None:
    dom = shown_by_browser(page(begun_late(6.0)), "", tmp_path)
    early = re.findall(r"<(\w+)>([\d.]+) s, before this recording begins:", dom)
    assert early
    assert all(tag == "p" and float(at) < 6.0 for tag, at in early)
    assert all(float(at) >= 6.0 for at in re.findall(r"<button>([\d.]+) s", dom))


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_rows_of_a_narrow_page_have_names_that_differ_and_no_text_is_cut(tmp_path: Path) -> None:
    run = still_calling()
    drawn = drawn_by_browser(page(run), tmp_path, 362)
    names = [text for text, x, _ in drawn if x <= 12]
    assert len(names) == len(set(names)) == len(data(page(run))["rows"])  # type: ignore[arg-type]
    assert all(end <= 362 for _, _, end in drawn)
    long = drawn_by_browser(page(timeline_of(shared_group_run().events)), tmp_path, 362)
    assert {"odom_callback", "scan_callback", "timer_callback"} <= {text for text, x, _ in long if x <= 12}
    assert all(end <= 362 for _, _, end in long)


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_the_robot_is_drawn_from_the_first_moment_on(tmp_path: Path) -> None:
    spy = """const round = CanvasRenderingContext2D.prototype.arc; let circles = 0;
      CanvasRenderingContext2D.prototype.arc = function (...all) { circles++; round.apply(this, all); };
      now = run.begin; drawRobot(); document.title = `${circles} circles`"""  # the obstacle and the robot
    first = (each for each in shared_group_run().events if not isinstance(each, RobotMoved) or each.t)
    text = page(timeline_of([*first]))
    dom = shown_by_browser(text.replace("</body>", f"<script>{spy}</script></body>"), "0", tmp_path)
    assert "<title>2 circles</title>" in dom


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_a_run_in_which_nothing_is_found_says_so(tmp_path: Path) -> None:
    run = Run("quiet")
    run.over(1.0)
    assert "No problems found." in re.sub(
        "<script.*", "", shown_by_browser(page(timeline_of(run.events)), "0", tmp_path)
    )


def test_what_is_true_of_a_whole_run_has_no_moment() -> None:
    found = data(page(timeline_of(run_lesson("split-groups", 3.0).events)))["findings"]
    assert [each["at"] for each in found] == [None]  # type: ignore[attr-defined]


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_a_callback_that_awaits_is_told_with_the_group_that_it_keeps(tmp_path: Path) -> None:
    point = """const box = $("lanes").getBoundingClientRect(), edge = left(box.width);
      const told = run.rows.map((row, place) => { $("about").textContent = "";
        describe({ clientX: box.left + edge + (now - start) / length * (box.width - edge),
          clientY: box.top + ROW * (place + .5) }); return $("about").textContent; });
      document.title = told.join("; ")"""
    text = page(timeline_of(small_run())).replace("</body>", f"<script>{point}</script></body>")
    dom = shown_by_browser(text, "1.3", tmp_path)
    assert told_by_browser(dom)["later"] == "awaits for 200 ms"
    assert "C exclusive: kept by later, which awaits for 500 ms from 1.100 s" in dom
    assert "later: awaits for 500 ms from 1.100 s" in dom


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
@pytest.mark.parametrize(
    ("replied", "drawn"),
    [(2.01, "×2"), (None, "2 calls, the first called from outside, no reply by the end")],
)
def test_one_mark_of_two_calls_tells_their_number(replied: float | None, drawn: str, tmp_path: Path) -> None:
    run = Run("twice")
    run.thread("MainThread")
    for _ in range(2):
        run.call("/gripper", 2.0, replied)
    run.over(9.0)
    texts = [text for text, *_ in drawn_by_browser(page(timeline_of(run.events)), tmp_path, 900)]
    assert drawn in texts
