"""Texts that want a terminal, a reader or a screen to do something, and files that are full of them."""

import unicodedata
from collections.abc import Iterable
from enum import Enum
from pathlib import Path

import msgspec

from sim.recording import RecordingMetadata, RecordingWriter
from sim.trace.events import AnyEvent
from tests.export.examples import small_run
from tests.trace.samples import FULL

HOSTILE = (
    "\x1b]52;c;ZXZpbA==\x07\x1b]0;title\x1b\\\x1b[2J\x1b[31m\x9b31m\x9d0;t\x9c\x08\x7f\r\u202egnp.exe\u2066\u200b"
    "[red]r[/red][@click=app.quit]q[/][/] **bold** <b>x</b> $(touch x) 界e\u0301"
)
"""Copies to the clipboard, clears, paints, goes back, turns text round, hides, and looks like mark-up."""
_TURNING = {*range(0x202A, 0x202F), *range(0x2066, 0x206A), 0x200B, 0x200E, 0x200F, 0x2060, 0xFEFF}


def obeyed(text: str) -> set[str]:
    """The characters of a text that a terminal obeys, or that deceive its reader; lines may end."""
    return {
        character
        for character in text
        if (unicodedata.category(character) in {"Cc", "Cs"} and character != "\n")
        or ord(character) in _TURNING
    }


def events() -> list[AnyEvent]:
    """A run in which every text goes on with something hostile."""
    return [_hostile(event) for event in small_run()]


def every_event() -> list[AnyEvent]:
    """One event of each kind, with something hostile in every text."""
    return [_hostile(event) for event in FULL]


def _hostile(event: AnyEvent) -> AnyEvent:
    texts = {
        name: f"{value}{HOSTILE}"
        for name, value in msgspec.structs.asdict(event).items()
        if isinstance(value, str) and not isinstance(value, Enum)
    }
    return msgspec.structs.replace(event, **texts)


def recording(path: Path, told: Iterable[AnyEvent] | None = None) -> Path:
    """A recording with something hostile wherever it has text, paths out of its folder among it."""
    about = RecordingMetadata(
        title=f"../../title{HOSTILE}",
        clock=f"virtual{HOSTILE}",
        programs=(f"../../../x{HOSTILE}.py",),
        arguments=(HOSTILE, "--ros-args"),
        setup=f'{{"title": "{HOSTILE}"}}',
        version=HOSTILE,
        recorded=2**62,
    )
    recorder = RecordingWriter(path, about)
    recorder.take(list(events() if told is None else told))
    recorder.close()
    assert recorder.failure is None
    return path


LESSON = """\
id = "{id}"
number = 1
unit = {text}
title = {text}
teaches = {text}
executor = {text}
groups = {text}
task = {text}
[setup]
node = "node.py"
[service]
name = "/motor_power"
type = "std_srvs/srv/SetBool"
[[try]]
key = {text}
text = {text}
[[prediction]]
question = {text}
answers = [{text}, "other"]
right = 1
because = {text}
shown = "first_answer"
[exercise]
asks = {text}
hints = [{text}, {text}, {text}]
"""


def lesson(folder: Path, code: str = "") -> Path:
    """A lesson whose texts are hostile; all of its Python is ``code``. Returns its folder."""
    place = folder / "bad-lesson"
    place.mkdir(parents=True)
    escaped = "".join(f"\\U{ord(character):08X}" for character in HOSTILE)
    (place / "lesson.toml").write_text(LESSON.format(id=place.name, text=f'"{escaped}"'), encoding="utf-8")
    for name in ("node.py", "checks.py", "starter.py", "solution.py", "__init__.py", "conftest.py"):
        (place / name).write_text(code)
    for name in ("guide.md", "explain.md"):
        (place / name).write_text(
            f"# {HOSTILE}\n\n[{HOSTILE}](file:///etc/passwd) {HOSTILE}\n", encoding="utf-8"
        )
    return place
