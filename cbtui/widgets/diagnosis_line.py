"""The diagnosis line at the bottom, with the number of problems."""

from collections.abc import Iterator, Sequence
from re import finditer, search, sub
from textwrap import wrap

from textual.events import Resize
from textual.geometry import Size
from textual.message import Message
from textual.reactive import reactive

from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.text.callback_names import short_name
from cbtui.text.cells import fit
from cbtui.widgets.diagnosis import Diagnosis, DiagnosisLevel
from cbtui.widgets.painted_widget import PaintedWidget, painted

_INKS = {
    DiagnosisLevel.FINE: Ink(Role.TEXT),
    DiagnosisLevel.PENDING: Ink(Role.TEXT),
    DiagnosisLevel.WAITS: Ink(Role.STRONG),
    DiagnosisLevel.TROUBLE: Ink(Role.WARN),
}
_INDENT = 3
_GAP = 2
"""Columns between the sentence and the text at the right."""
_MOST = 4
"""The most lines of a sentence."""
_SIGNS = {
    DiagnosisLevel.FINE: "✓",
    DiagnosisLevel.PENDING: "·",
    DiagnosisLevel.WAITS: "·",
    DiagnosisLevel.TROUBLE: "!",
}


class DiagnosisLine(PaintedWidget):
    """Shows a diagnosis; at the right the state of the latest service call, and the number of problems.

    ``note`` has the texts of the former, the fullest first.
    """

    diagnosis: reactive[Diagnosis] = painted(Diagnosis("", DiagnosisLevel.FINE))
    note: reactive[tuple[str, ...]] = painted(())
    problems: reactive[str] = painted("")

    class Clicked(Message):
        """The user clicked on the line."""

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the line; the note is dropped first if there is too little room."""
        return diagnosis_rows(self.diagnosis, self.note, self.problems, size.width)

    def watch_diagnosis(self) -> None:
        """Show another diagnosis, on as many lines as it takes."""
        self._take_room(self.size)

    def watch_problems(self) -> None:
        """Show another number of problems."""
        self._take_room(self.size)

    def on_resize(self, event: Resize) -> None:
        """Break the lines anew."""
        self._take_room(event.size)

    def on_click(self) -> None:
        """Post ``Clicked``."""
        self.post_message(self.Clicked())

    def _take_room(self, size: Size) -> None:
        rows = diagnosis_rows(self.diagnosis, self.note, self.problems, size.width) if size.width else [[]]
        if self.styles.height is None or self.styles.height.value != len(rows):
            self.styles.height = len(rows)
            for notifications in self.screen.query("ToastRack"):
                notifications.styles.margin = (0, 0, len(rows) + 1, 0)


def diagnosis_rows(
    diagnosis: Diagnosis, note: tuple[str, ...], problems: str, width: int
) -> list[list[TextRun]]:
    """Return the lines, each in exactly ``width`` columns: several only for a diagnosis that stays."""
    taken = " " * (_GAP + len(problems) + 1 if problems else 0)
    room = max(20, width - _INDENT)
    lines = wrap(diagnosis.text, room, initial_indent=taken, max_lines=_MOST, placeholder=" …")
    first, *others = lines or [""]
    if not diagnosis.stays or not others:
        return [diagnosis_row(diagnosis, note, problems, width)]
    ink = _INKS[diagnosis.level]
    head = diagnosis_row(Diagnosis(first.strip(), diagnosis.level), (), problems, width)
    kept = [TextRun(fit(" " * _INDENT + line, width, Charset.BRAILLE), ink) for line in others]
    return [head, *([run] for run in kept)]


def diagnosis_row(diagnosis: Diagnosis, note: tuple[str, ...], problems: str, width: int) -> list[TextRun]:
    """Return the line in exactly ``width`` columns; of the text at the right only the problems always fit.

    Where nothing is wrong, the note is worth more than the further clauses of the diagnosis.
    """
    ink = _INKS[diagnosis.level]
    at_right = f"{problems} " if problems else ""
    gap = _GAP if problems else 0
    room = width - len(at_right) - gap
    sign = f" {_SIGNS[diagnosis.level]} "
    texts = (sign + each for each in _ways_to_say(diagnosis))
    place = diagnosis.place
    cut = diagnosis.text
    if place is not None:
        cut = sub(rf" in the loop of line {place.first_line}\b", "", cut.removeprefix(diagnosis.time))
        cut = f"line {place.first_line}: {cut}"
    fitting = [each for each in texts if len(each) <= room] or [sign + cut]
    beside = {each: room - len(each) - _INDENT for each in fitting}
    with_note = (each for way in note for each in fitting if len(way) < beside[each])
    text = next(with_note, fitting[0]) if diagnosis.level.is_calm else fitting[0]
    shown_note = next((f"{way} " for way in note if len(way) < room - len(text) - _INDENT), "")
    runs = [
        TextRun(fit(text, room - len(shown_note), Charset.BRAILLE), ink),
        TextRun(shown_note + " " * gap, Ink(Role.FAINT)),
        TextRun(at_right, Ink(Role.STRONG)),
    ]
    return [run for run in runs if run.text]


def _ways_to_say(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield texts of a diagnosis, the fullest first; those that name its place before all others."""
    every = list(_texts(diagnosis))
    if (place := diagnosis.place) is not None:
        for where in (f" ({place})", f", line {place.first_line}"):
            for text in every:
                yield text if search(rf"(:|line ){place.first_line}\b", text) else text + where
    yield from every


def _texts(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield texts, the fullest first: short names, no time, the first clauses, nothing in brackets, not
    who keeps the threads busy.
    """
    yield from filter(None, (diagnosis.at_length, diagnosis.text))
    brief = [sub(r"\w+_callback\b(?!\.py)", lambda found: short_name(found[0]), diagnosis.text)]
    brief.append(brief[0].removeprefix(diagnosis.time))
    brief.append(sub(r" \(\d+ \w+ in all\)$", "", brief[-1]))
    yield from brief
    for text in brief:
        for end in reversed(list(finditer(r"[;.] ", text))):
            yield text[: end.start()]
    bare = sub(r" \([^)]*\)", "", brief[-1])
    yield bare
    yield sub(r"(threads are busy|no thread is free) (with|for it:) .*", r"\1", bare)
