"""The line at the bottom that says in words what the moment on screen means."""

from collections.abc import Sequence
from dataclasses import replace
from textwrap import wrap

from textual.events import Resize
from textual.geometry import Size
from textual.reactive import reactive

from cbtui.theme import Charset, Ink, Role, Run
from cbtui.widgets.cells import fit
from cbtui.widgets.diagnosis import Diagnosis, Weight
from cbtui.widgets.painted import Painted

_INKS = {
    Weight.FINE: Ink(Role.TEXT),
    Weight.WAITS: Ink(Role.STRONG),
    Weight.TROUBLE: Ink(Role.WARN),
}
_INDENT = 3
_MOST = 4
"""Lines that a sentence may take."""
_SIGNS = {Weight.FINE: "✓", Weight.WAITS: "·", Weight.TROUBLE: "!"}


class DiagnosisLine(Painted):
    """Shows a diagnosis, and at the right how the latest service call stands."""

    diagnosis: reactive[Diagnosis] = reactive(Diagnosis("", Weight.FINE))
    note: reactive[str] = reactive("")

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint the line; the note gives way when there is not room for both."""
        return diagnosis_rows(self.diagnosis, self.note, size.width)

    def watch_diagnosis(self) -> None:
        """Say something else, on as many lines as it takes."""
        self._take_room(self.size)
        self.changed()

    def on_resize(self, event: Resize) -> None:
        """Break the lines anew."""
        self._take_room(event.size)

    def _take_room(self, size: Size) -> None:
        lines = len(diagnosis_rows(self.diagnosis, self.note, size.width)) if size.width else 1
        if self.styles.height is None or self.styles.height.value != lines:
            self.styles.height = lines

    def watch_note(self) -> None:
        """Say something else of the latest call."""
        self.changed()


def diagnosis_rows(diagnosis: Diagnosis, note: str, width: int) -> list[list[Run]]:
    """Return the lines, each in exactly ``width`` columns: one, but for a sentence that stays."""
    first, *others = wrap(diagnosis.text, max(20, width - _INDENT)) or [""]
    if not diagnosis.stays or not others:
        return [diagnosis_row(diagnosis, note, width)]
    ink = _INKS[diagnosis.weight]
    head = diagnosis_row(replace(diagnosis, text=first), "", width)
    kept = [Run(fit(" " * _INDENT + line, width, Charset.BRAILLE), ink) for line in others[: _MOST - 1]]
    return [head, *([run] for run in kept)]


def diagnosis_row(diagnosis: Diagnosis, note: str, width: int) -> list[Run]:
    """Return the line in exactly ``width`` columns."""
    text = f" {_SIGNS[diagnosis.weight]} {diagnosis.text}"
    right = f"{note} " if note else ""
    room = width - len(text) - 3
    if not right or room < 12:
        return [Run(fit(text, width, Charset.BRAILLE), _INKS[diagnosis.weight])]
    right = fit(right, min(len(right), room), Charset.BRAILLE)
    return [
        Run(fit(text, width - len(right), Charset.BRAILLE), _INKS[diagnosis.weight]),
        Run(right, Ink(Role.FAINT)),
    ]
