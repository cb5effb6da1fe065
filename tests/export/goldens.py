"""The small run as each text format has it: ``python -m tests.export.goldens`` writes the files anew.

Look at what changed before keeping it, at the picture too.
"""

from io import StringIO
from pathlib import Path

from sim.export.chrome import ChromeFile
from sim.export.csv import CallTable
from sim.export.markdown import report
from sim.export.svg import svg
from sim.trace.model import Window
from tests.export.examples import small_run, timeline_of
from tests.export.reading import written
from tests.support.runs import ns

FOLDER = Path(__file__).with_name("golden")
NAMES = ("calls.csv", "lanes.svg", "report.md", "trace.json")


def made(name: str) -> str:
    """What a file should hold."""
    events = small_run()
    match name:
        case "calls.csv":
            file = StringIO(newline="")
            table = CallTable(file)
            table.take(events)
            table.finish()
            return file.getvalue()
        case "lanes.svg":
            return svg(timeline_of(events), Window(0, ns(2.5)))
        case "report.md":
            return report(timeline_of(events), "lanes.svg")
        case _:
            return written(events, ChromeFile).decode()


if __name__ == "__main__":
    for name in NAMES:
        (FOLDER / name).write_bytes(made(name).encode())
