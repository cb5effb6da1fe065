"""The window with a run's diagnosis: what happened, why, what to do, and where."""

from collections.abc import Sequence

from textual import on
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from cbtui.keys.action import Scope
from cbtui.keys.keymap import Keymap
from cbtui.looks.theme import GLYPHS, Charset
from cbtui.runs.live.findings import ExplainedFinding, problem_count_text
from cbtui.screens.window import WindowScreen
from cbtui.text.cells import visible
from cbtui.widgets.key_bar import KeyBar
from sim.diagnosis import location_text, sentence
from sim.durations import timestamp
from sim.plural import counted

_ALL_IS_WELL = "✓ Nothing has gone wrong so far: the rules have found no problem, and nothing to remark on."
_TIME = 10


class DiagnosesScreen(WindowScreen[ExplainedFinding]):
    """Lists findings, problems first; its result is the finding to go to, None to stay."""

    SCOPE = Scope.DIAGNOSES

    def __init__(self, findings: Sequence[ExplainedFinding], charset: Charset) -> None:
        super().__init__(charset)
        self._findings = findings
        self.heading = title_of(findings)

    def content(self) -> ComposeResult:
        """Lay out the list, and what there is to say of the highlighted one."""
        if self._findings:
            yield FindingList(*(Option(row_of(each, self._charset)) for each in self._findings))
            with VerticalScroll(can_focus=False):
                yield Static(classes="told")
        else:
            yield Static(_ALL_IS_WELL, classes="well", markup=False)

    def on_mount(self) -> None:
        """Highlight the worst."""
        for listed in self.query(FindingList):
            listed.highlighted = 0

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer ``go`` if the finding has a moment or a place in the code."""
        match action:
            case "previous" | "next":
                return len(self._findings) > 1
            case "go":
                return self._chosen is not None and self._chosen.leads_somewhere
        return True

    @on(OptionList.OptionHighlighted)
    def _tell(self, event: OptionList.OptionHighlighted) -> None:
        self.query_one(".told", Static).update(details_of(self._findings[event.option_index], self._charset))
        self.query_one(VerticalScroll).scroll_home(animate=False)
        self.query_one(KeyBar).changed()

    def action_previous(self) -> None:
        """Highlight what is above."""
        self.query_one(FindingList).action_cursor_up()

    def action_next(self) -> None:
        """Highlight what is below."""
        self.query_one(FindingList).action_cursor_down()

    def action_go(self) -> None:
        """Go to what is highlighted."""
        self.dismiss(self._chosen)

    @property
    def _chosen(self) -> ExplainedFinding | None:
        place = next((listed.highlighted for listed in self.query(FindingList)), None)
        return None if place is None else self._findings[place]


class FindingList(OptionList, inherit_bindings=False):
    """The list of findings; its highlight is moved by the screen's keys and by clicks."""


def title_of(findings: Sequence[ExplainedFinding]) -> str:
    """Return the heading: ``Diagnoses: 2 problems, 1 remark``."""
    problems = sum(each.is_problem for each in findings)
    counts = ((problems, "problem"), (len(findings) - problems, "remark"))
    words = [counted(count, name) for count, name in counts if count]
    return f"Diagnoses: {', '.join(words)}" if words else "Diagnoses"


def row_of(each: ExplainedFinding, charset: Charset) -> Content:
    """Return a finding's line: ``!`` for a problem, ``·`` for a remark; when; what."""
    sign, style = ("!", "bold $text-warning") if each.is_problem else ("·", "$text-muted")
    time = "" if each.at is None else f"{timestamp(each.at)}"
    return Content.assemble(
        (f"{sign} ", style),
        (f"{time:>{_TIME}}  ", "$text-muted"),
        visible(each.explanation.what, charset),
    )


def details_of(each: ExplainedFinding, charset: Charset) -> Content:
    """Return what happened, why, what to do, and where in the code and when."""
    explained = each.explanation
    parts = [
        (f"{visible(explained.what, charset)}.", "bold"),
        (f"\n{visible(sentence(explained.why), charset)}", ""),
        (f"\n→ {visible(explained.cure, charset)}.", "$text-success"),
    ]
    where = location_text(each.finding, explained)
    if where:
        parts.append((f"\n{visible(where, charset)}", "$text-muted"))
    return Content.assemble(*parts)


def problems_note(findings: Sequence[ExplainedFinding], keymap: Keymap, charset: Charset) -> str:
    """Return how many problems there are, and the key that lists them: ``2 problems · d``; "" for none."""
    count = problem_count_text(findings)
    opens = keymap.sign(Scope.LESSON, "diagnoses", charset)
    return f"{count} {GLYPHS[charset].between} {opens}" if count else ""
