"""Runs on virtual time are the same byte for byte, and one that cannot be says so once."""

from pathlib import Path

import msgspec
import pytest

from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.trace.events import Notice, Printed
from tests.clock.stdlib_table import PRELUDE, ROWS, Does
from tests.support.engine_runs import SECOND, Run, run_to_end

_DATES = """
print(datetime.datetime.now(), time.strftime("%c"), logging.makeLogRecord({}).created)
print({"a", "b", "c", "d", "e"}, random.Random().random(), uuid.uuid1(), secrets.token_hex())
class Own(random.Random):
    pass
print(Own().random(), random.SystemRandom().choice("abcdef"))
random.seed()
print(random.random(), random.gauss(0, 1))
"""


def run(folder: Path, source: str, until: int = 30 * SECOND) -> Run:
    path = folder / "program.py"
    path.write_text(PRELUDE + source, encoding="utf-8")
    return run_to_end(
        RunSetup(
            title="program.py",
            programs=(ProgramSetup(str(path)),),
            clock="virtual",
            speed=None,
            robot=RobotUse.NEVER,
            until=until,
        )
    )


def printed(ended: Run) -> str:
    return "".join(event.text for event in ended.events if isinstance(event, Printed))


def reasons(ended: Run) -> list[str]:
    return [event.text for event in ended.events if isinstance(event, Notice) and event.unrepeatable]


@pytest.mark.slow
@pytest.mark.usefixtures("fresh_engines")
def test_whatever_is_random_or_tells_the_time_is_the_same_in_five_runs(tmp_path: Path) -> None:
    rows = [row.body for row in ROWS if row.does in {Does.VIRTUAL, Does.SEEDED}]
    source = "\n".join([*rows, _DATES])
    runs = [run(tmp_path, source) for _ in range(5)]
    assert "the program returned" in runs[0].ending.reason
    assert "2023-11-14" in printed(runs[0])
    assert reasons(runs[0]) == []
    assert len({msgspec.json.encode(each.events) for each in runs}) == 1


def test_what_is_not_repeatable_is_said_once_with_the_line(tmp_path: Path) -> None:
    line = PRELUDE.count("\n") + 1
    ended = run(tmp_path, "tempfile.mkdtemp()\nsubprocess.run(['sleep', '0.2'])\n")
    (reason,) = reasons(ended)
    assert reason.startswith(f"program.py:{line}, in <module>: temporary files get new names in each run")
    assert reason.endswith(", so no other run will be exactly like this one")


def test_a_run_whose_time_is_up_ends_while_a_process_runs(tmp_path: Path) -> None:
    source = """
process = subprocess.Popen(["sleep", "9"])
try:
    process.wait(8)
finally:
    process.kill()
    print("killed", process.wait())
"""
    ended = run(tmp_path, source, until=SECOND // 2)
    assert ended.ending.reason == "its time was up"
    assert SECOND // 2 <= ended.ending.t < 8 * SECOND
    assert [each for each in reasons(ended) if "subprocess starts a process" in each]


def test_an_alarm_without_a_handler_ends_the_program(tmp_path: Path) -> None:
    ended = run(tmp_path, "signal.alarm(2)\ntime.sleep(9)\n")
    assert "SIGALRM has no handler" in ended.ending.reason
    assert ended.ending.t == 2 * SECOND
