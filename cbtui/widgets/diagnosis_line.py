"""The line at the bottom that says in words what the moment on screen means."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.theme import GLYPHS, Charset, Ink, Role, Run
from cbtui.widgets.cells import fit
from cbtui.widgets.diagnosis import Diagnosis, Weight
from cbtui.widgets.painted import Painted

_INKS = {
    Weight.FINE: Ink(Role.TEXT),
    Weight.WAITS: Ink(Role.STRONG),
    Weight.TROUBLE: Ink(Role.WARN),
}
_SIGNS = {Weight.FINE: "✓", Weight.WAITS: "·", Weight.TROUBLE: "!"}
_PLAIN_SIGNS = {Weight.FINE: "+", Weight.WAITS: "-", Weight.TROUBLE: "!"}


class DiagnosisLine(Painted):
    """Shows a diagnosis, and at the right how the latest service call stands."""

    diagnosis: reactive[Diagnosis] = reactive(Diagnosis("", Weight.FINE))
    note: reactive[str] = reactive("")
    charset: reactive[Charset] = reactive(Charset.BRAILLE)

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint the line; the note gives way when there is not room for both."""
        return [diagnosis_row(self.diagnosis, self.note, size.width, self.charset)]

    def watch_diagnosis(self) -> None:
        """Say something else."""
        self.changed()

    def watch_note(self) -> None:
        """Say something else of the latest call."""
        self.changed()

    def watch_charset(self) -> None:
        """Paint in other glyphs."""
        self.changed()


def diagnosis_row(diagnosis: Diagnosis, note: str, width: int, charset: Charset) -> list[Run]:
    """Return the line in exactly ``width`` columns."""
    signs = _PLAIN_SIGNS if charset is Charset.ASCII else _SIGNS
    text = f" {signs[diagnosis.weight]} {diagnosis.text}"
    right = f"{note} " if note else ""
    room = width - len(text) - 3
    if not right or room < 12:
        return [Run(fit(text, width, charset), _INKS[diagnosis.weight])]
    right = fit(right, min(len(right), room), charset)
    return [
        Run(fit(text, width - len(right), charset), _INKS[diagnosis.weight]),
        Run(right, Ink(Role.FAINT)),
    ]
