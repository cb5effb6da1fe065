"""Whatever a submission does, it earns nothing by it, and the others keep their marks."""

import os
import signal
from xml.etree import ElementTree

import pytest

from tests.grading.classroom import NEIGHBOURS, Classroom, Graded
from tests.grading.forgeries import ENDING, ON_THE_TRACE, REACHING_OUT, SOLUTION, STARTER

pytestmark = pytest.mark.slow

_REACHING_OUT = ("overwrites a neighbour", "writes to the table", "kills its parent", "executes the solution")
_ON_THE_TRACE = ("writes to the pipe", "changes the code of a function")


def neighbours_keep_their_marks(graded: Graded) -> bool:
    return all(graded.rows[name]["passed"] == graded.rows[name]["total"] == "1" for name in NEIGHBOURS)


def test_forgeries_earn_nothing_and_cost_nobody_anything(classroom: Classroom) -> None:
    for name in _REACHING_OUT:
        classroom.hand_in(name, REACHING_OUT[name])
    for name in _ON_THE_TRACE:
        classroom.hand_in(name, ON_THE_TRACE[name])
    graded = classroom.grade()
    assert graded.code == 3
    assert neighbours_keep_their_marks(graded)
    assert set(graded.rows) == {*NEIGHBOURS, *_REACHING_OUT, *_ON_THE_TRACE}
    forged = [graded.rows[name] for name in (*_REACHING_OUT, *_ON_THE_TRACE)]
    assert {(row["passed"], row["total"]) for row in forged} == {("0", "1")}
    suspicious = {name for name, row in graded.rows.items() if row["suspicious"]}
    marks, _, _ = graded.out.partition("\n\nMissed most:\n")
    assert len(marks.splitlines()) == len(graded.rows)
    if classroom.confined:
        assert graded.err == ""
        assert suspicious == {*_ON_THE_TRACE}
        return
    assert suspicious == {*_REACHING_OUT, *_ON_THE_TRACE}
    assert "bwrap (of the package bubblewrap) is not installed: each submission runs on a copy" in graded.err
    ann = classroom.targets.neighbour
    assert graded.rows["overwrites a neighbour"]["suspicious"] == f"{ann} was changed while it ran"
    assert graded.rows["kills its parent"]["suspicious"].startswith("it ended or disturbed the process")


def test_in_namespaces_nothing_of_others_is_there(confined_classroom: Classroom) -> None:
    targets = confined_classroom.targets
    paths = [targets.checks, targets.solution, targets.neighbour, targets.table]
    looks = (
        "import os, socket\n"
        f"seen = [path for path in {[*map(str, paths)]!r} if os.path.exists(path)]\n"
        "seen += [pid for pid in os.listdir('/proc') if pid.isdigit() and b'homework' in "
        "open(f'/proc/{pid}/cmdline', 'rb').read()]\n"
        "seen += [name for _, name in socket.if_nameindex() if name != 'lo']\n"
        "for place in ('/usr/x', os.path.dirname(os.__file__) + '/x', '/x', '/proc/x'):\n"
        "    try:\n        open(place, 'w')\n        seen.append(place)\n    except OSError:\n        pass\n"
        "open('mine', 'w').write('x'), open('/tmp/mine', 'w').write('x')\n"
        "from importlib.util import find_spec\n"
        "seen += filter(find_spec, ['lessons.judge'] if find_spec('lessons') else [])\n"
        "raise SystemExit(f'seen: {seen}')\n"
    )
    confined_classroom.hand_in("looks", looks)
    graded = confined_classroom.grade()
    assert graded.err == ""
    assert graded.rows["looks"]["problem"] == "the program ended: seen: [] (blinking.py:14)"


def test_grading_stops_where_the_checks_are_changed_and_goes_on_when_they_are_whole_again(
    open_classroom: Classroom,
) -> None:
    checks = open_classroom.targets.checks
    whole = checks.read_text()
    open_classroom.hand_in("mallory", ENDING["appends to the checks"])
    junit = open_classroom.table.with_suffix(".xml")
    graded = open_classroom.grade("--junit", str(junit))
    assert graded.code == 4
    ((ann, mallory),) = ElementTree.parse(junit).getroot()
    assert (len(ann), [each.tag for each in mallory]) == (0, ["error"])
    assert f"{checks} changed while blinking.py of mallory ran" in graded.err
    assert [*graded.rows] == ["ann", "mallory"]
    assert graded.rows["mallory"]["suspicious"] == f"{checks} was changed while it ran"
    assert graded.rows["mallory"]["passed"] == "0"
    checks.write_text(whole)
    resumed = open_classroom.grade("--resume")
    assert resumed.code == 3
    assert resumed.out == "1/1  zoe  blinking\n"
    assert [*resumed.rows] == ["ann", "mallory", "zoe"]


def test_who_kills_the_grader_is_named_and_keeps_nobody_else_from_being_graded(
    open_classroom: Classroom,
) -> None:
    kills = """
import os, pathlib, signal
for process in pathlib.Path("/proc").glob("[0-9]*"):
    if b"grade\\0" + HOMEWORK in (process / "cmdline").read_bytes():
        os.kill(int(process.name), signal.SIGKILL)
"""
    open_classroom.hand_in("mallory", kills.replace("HOMEWORK", repr(os.fsencode(open_classroom.homework))))
    graded = open_classroom.grade()
    assert graded.code == -signal.SIGKILL
    assert open_classroom.table.read_text().endswith("\nmallory,blinking,")
    resumed = open_classroom.grade("--resume")
    assert "grading was cut short while blinking of mallory ran, which now comes last" in resumed.err
    assert resumed.out == "1/1  zoe  blinking\n"
    assert [*resumed.rows] == ["ann", "zoe", "mallory"]


def test_what_was_graded_is_not_graded_again_unless_it_is_another_file(open_classroom: Classroom) -> None:
    open_classroom.hand_in("bob", STARTER)
    assert open_classroom.grade().code == 1
    table = open_classroom.table
    text = table.read_text()
    table.write_text(text[: text.rindex("zoe") + 20])
    open_classroom.hand_in("bob", SOLUTION)
    graded = open_classroom.grade("--resume")
    assert (graded.code, graded.out) == (0, "1/1  bob  blinking\n1/1  zoe  blinking\n")
    assert sorted(graded.rows) == ["ann", "bob", "zoe"]


def test_links_are_not_followed_and_modules_take_nobody_elses_place(open_classroom: Classroom) -> None:
    homework = open_classroom.homework
    (homework / "bob").mkdir()
    (homework / "bob" / "blinking.py").symlink_to(open_classroom.targets.neighbour)
    (homework / "cyd").symlink_to(homework / "ann")
    folder = open_classroom.hand_in("dan", f"import helper\n{SOLUTION}").parent
    (folder / "helper.py").touch()
    (folder / "passwd").symlink_to("/etc/passwd")
    for name in ("sitecustomize", "usercustomize", "threading", "lessons", "cbtui", "msgspec"):
        (folder / f"{name}.py").write_text("raise SystemExit('shadowed')\n")
    graded = open_classroom.grade()
    problems = {name: row["problem"] for name, row in graded.rows.items() if row["problem"]}
    assert [*problems] == ["bob", "cyd"]
    assert all("is a link" in each for each in problems.values())
    assert graded.rows["dan"]["passed"] == "1"
