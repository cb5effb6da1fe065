"""The line at the bottom that says in words what the moment on screen means."""

from collections.abc import Sequence

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
_SIGNS = {Weight.FINE: "✓", Weight.WAITS: "·", Weight.TROUBLE: "!"}


class DiagnosisLine(Painted):
    """Shows a diagnosis, and at the right how the latest service call stands."""

    diagnosis: reactive[Diagnosis] = reactive(Diagnosis("", Weight.FINE))
    note: reactive[str] = reactive("")

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint the line; the note gives way when there is not room for both."""
        return [diagnosis_row(self.diagnosis, self.note, size.width)]

    def watch_diagnosis(self) -> None:
        """Say something else."""
        self.changed()

    def watch_note(self) -> None:
        """Say something else of the latest call."""
        self.changed()


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
