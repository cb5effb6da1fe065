"""The page that plays a run: nothing comes from outside, nothing breaks out, and a browser shows the run."""

import json
import re
import subprocess
from pathlib import Path

import pytest
from msgspec.structs import replace

from sim.export.html import page
from sim.trace.events import Logged, Printed, RunEnded, RunStarted
from sim.trace.timeline import Timeline
from tests.export.examples import NASTY, small_run, timeline_of
from tests.support.builder import ns
from tests.support.lesson_runs import shared_group_run
from tests.web.chromium import PROGRAM


def begun_late() -> Timeline:
    """The last ten seconds of a run, as a recording has them that was begun late."""
    events = [each for each in shared_group_run().events if each.t <= ns(14.0)]
    run = [replace(each, known_from=ns(4.0)) if isinstance(each, RunStarted) else each for each in events]
    return timeline_of([*run, RunEnded(ns(14.0), "", failed=False)])


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


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium")
def test_a_log_without_lines_says_so(tmp_path: Path) -> None:
    quiet = [event for event in small_run() if not isinstance(event, Logged | Printed)]
    assert "<span>nothing so far</span>" in shown_by_browser(page(timeline_of(quiet)), "0", tmp_path)


def test_what_was_begun_during_a_run_is_no_longer_than_from_there_on() -> None:
    shown = data(page(begun_late()))
    assert (shown["begin"], shown["end"]) == (4e6, 14e6)
    assert str(shown["subtitle"]).startswith("10.0 s of")


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
