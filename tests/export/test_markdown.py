"""The report: all its parts, and texts that stay texts."""

import re
from pathlib import Path

from sim.diagnosis import diagnose, findings_text
from sim.export.markdown import report
from sim.export.texts import markdown
from tests.export.examples import small_run, timeline_of
from tests.support.engine_runs import run_program
from tests.support.runs import Run, shared_group_run


def test_a_report_has_set_up_statistics_waits_notices_and_picture() -> None:
    text = report(timeline_of(small_run()), "pictures/lanes <1>.svg")
    heads = re.findall(r"^#+ .*$", text, re.MULTILINE)
    assert heads == [
        "# small run",
        "## Set-up",
        "## Diagnosis",
        "## Callbacks",
        "## Waits",
        "## Threads",
        "## Services and robot",
        "## Notices",
        "## Commands and errors",
        "## Picture",
    ]
    assert "| odom_callback | 900 ms | 900 ms | group A held by timer_callback |" in text
    assert "MultiThreadedExecutor, 2 threads" in text
    assert "](<pictures/lanes %3C1%3E.svg>)" in text


def test_a_report_tells_what_went_wrong_where_and_what_to_do() -> None:
    text = report(timeline_of(shared_group_run().events))
    assert "at 4.003 s): odom_callback and scan_callback waited up to 20.0 s: group A was" in text
    assert "What to do: give timer_callback a callback group of its own" in text
    assert "- **Remark** (node.py:120, at 4.000 s): timer_callback took 10.0 s" in text
    assert "No problems found." in report(timeline_of([]))


def test_a_problem_that_ends_in_a_question_gets_no_full_stop(tmp_path: Path) -> None:
    timeline = run_program(tmp_path, "message = 1\nmesage").timeline
    for text in (report(timeline), findings_text(diagnose(timeline), timeline)):
        assert "did you mean 'message'?\n" in text


def test_every_table_has_as_many_cells_in_each_line() -> None:
    tables = re.findall(r"(?:^\|.*\n)+", report(timeline_of(small_run())), re.MULTILINE)
    assert len(tables) >= 4
    for table in tables:
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table.splitlines()}) == 1


def test_a_timer_tells_how_old_its_data_was() -> None:
    text = report(timeline_of(shared_group_run().events))
    assert "| timer_callback | odom_callback |" in text


def test_a_run_without_waits_says_so_and_an_empty_one_makes_a_report() -> None:
    assert "None, every callback ran as soon as it was ready." in report(timeline_of(Run().events))
    assert report(timeline_of([])).startswith("# A run\n")


def test_texts_have_no_mark_up_of_their_own() -> None:
    assert markdown("_a_ odom_callback `x` | <b>\n[a](b)") == r"\_a\_ odom_callback \`x\` \| \<b\> \[a\](b)"
    assert "<b>" not in report(timeline_of(small_run()))
