"""The texts of the diagnosis window: the rows of its list, and the details of a finding or a cure."""

from collections.abc import Sequence
from textwrap import wrap

from textual.content import Content

from cbtui.keys.action import Scope
from cbtui.keys.keymap import Keymap
from cbtui.looks.theme import GLYPHS, Charset
from cbtui.runs.judged.cures import Cure
from cbtui.runs.live.findings import ExplainedFinding, problem_count_text
from cbtui.text.cells import visible
from sim.diagnosis import location_text, sentence, with_stop
from sim.quantities.durations import timestamp
from sim.quantities.plural import counted

_IN_VAIN = "what was tried is not enough here; in all: "
_TIME = 10


def title_of(findings: Sequence[ExplainedFinding]) -> str:
    """Return the heading: ``Diagnoses: 2 problems, 1 remark``."""
    problems = sum(each.is_problem for each in findings)
    counts = ((problems, "problem"), (len(findings) - problems, "remark"))
    words = [counted(count, name) for count, name in counts if count]
    return f"Diagnoses: {', '.join(words)}" if words else "Diagnoses"


def row_of(each: ExplainedFinding, charset: Charset) -> Content:
    """Return a finding's line: ``!`` for a problem, ``·`` for a remark; when; what."""
    sign, style = ("!", "bold $text-warning") if each.is_problem else ("·", "$text-muted")
    time = "" if each.at is None else timestamp(each.at)
    return Content.assemble(
        (f"{sign} ", style), (f"{time:>{_TIME}}  ", "$text-muted"), visible(each.explanation.what, charset)
    )


def step_row(text: str, charset: Charset) -> Content:
    """Return the line of a step below its finding: ``→ try it: …``."""
    return Content.assemble((" " * (_TIME + 4) + "→ ", "bold"), (visible(text, charset), "$text-success"))


def details_of(
    each: ExplainedFinding, charset: Charset, about_trial: str = "", *, in_vain: bool = False
) -> Content:
    """Return what happened, the sentence on trials of cures, why, what to do, and where and when.

    ``in_vain``: what to do was tried, and is not enough.
    """
    explained = each.explanation
    parts = [(visible(with_stop(explained.what), charset), "bold")]
    if about_trial:
        parts.append((f"\n· {about_trial}", ""))
    parts += [
        (f"\n{visible(sentence(explained.why), charset)}", ""),
        (f"\n→ {_IN_VAIN * in_vain}{visible(with_stop(explained.cure), charset)}", "$text-success"),
    ]
    where = location_text(each.finding, explained)
    if where:
        parts.append((f"\n{visible(where, charset)}", "$text-muted"))
    return Content.assemble(*parts)


_DIFF_STYLES = {"+": "$text-success", "-": "$text-error", "@": "$text-muted"}


def cure_details(cure: Cure, charset: Charset, width: int = 0) -> Content:
    """Return what a cure changes: in words, the lines that it edits, as far left as they can be, and code.

    A line that is longer than the width, if there is one, goes on in a line that begins with an ellipsis.
    """
    parts = [(visible(sentence(cure.words), charset), "bold")]
    if cure.diff:
        parts.append(("\nYour file stays as it is; a copy is run, with these lines:", ""))
    edited = [(line[0], line[1:]) for line in cure.diff.splitlines()[2:]]
    code = [text for sign, text in edited if sign != "@" and text.strip()]
    indent = min((len(text) - len(text.lstrip()) for text in code), default=0)
    for sign, text in edited:
        shown = visible(sign + (text if sign == "@" else text[indent:]), charset)
        parts.append((_folded(shown, width, charset), _DIFF_STYLES.get(sign, "")))
    if cure.code:
        parts.append(("\nYour file stays as it is; to have this in it, write:", ""))
        lines = (line for each in cure.code for line in each.splitlines())
        parts += [(_folded(visible(each, charset), width, charset), "$text-success") for each in lines]
    return Content.assemble(*parts)


def _folded(line: str, width: int, charset: Charset) -> str:
    """Return a line of code with line breaks where it is too long, and one before it."""
    pieces = wrap(line, width - 1, drop_whitespace=False, replace_whitespace=False) if width > 1 else [line]
    return "\n" + f"\n{GLYPHS[charset].ellipsis}".join(pieces)


def problems_note(findings: Sequence[ExplainedFinding], keymap: Keymap, charset: Charset) -> str:
    """Return how many problems there are, and the key that lists them: ``2 problems · d``; "" for none."""
    count = problem_count_text(findings)
    opens = keymap.sign(Scope.LESSON, "diagnoses", charset)
    return f"{count} {GLYPHS[charset].between} {opens}" if count else ""
