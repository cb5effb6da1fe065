"""Examines the terminal: its presence, colours, glyphs and size, and multiplexers in between."""

import os
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from cbtui.doctor.examination import Examination, fault, note, well
from cbtui.terminal.capabilities import is_dumb

WIDTH, HEIGHT = 80, 24
"""The smallest terminal."""
_SAMPLE = "⣿⣷⣶⣤⣀ ▏▎▍▌▋▊▉█ ╱╲╳ ─│┊ ▲◂▸"


class TerminalFacts(NamedTuple):
    """The terminal's environment, charset and size.

    ``size`` is None if a standard stream is not a terminal.
    """

    environment: Mapping[str, str]
    charset: str
    size: os.terminal_size | None


def screen(shown_on: TerminalFacts) -> Iterator[Examination]:
    """Examine the terminal."""
    yield _terminal(shown_on)
    if not is_dumb(shown_on.environment):
        yield _colours(shown_on.environment)
    yield _signs(shown_on)
    yield from _between(shown_on.environment)


def _terminal(shown_on: TerminalFacts) -> Examination:
    name = shown_on.environment.get("TERM", "")
    if is_dumb(shown_on.environment):
        return fault(
            "terminal", f"TERM={name} cannot place its cursor", "use another terminal, or cbtui run LESSON"
        )
    if shown_on.size is None:
        return note(
            "terminal",
            "input or output is no terminal, and the console needs one",
            "type cbtui doctor in a terminal, without < > |",
        )
    columns, rows = shown_on.size
    said = f"{name or 'TERM is not set'}, {columns} columns and {rows} rows"
    if columns < WIDTH or rows < HEIGHT:
        return note(
            "terminal", said, f"make it {WIDTH} columns and {HEIGHT} rows at least, or its letters smaller"
        )
    if not name:
        return note("terminal", said, "export TERM=xterm-256color, or what your terminal says that it is")
    return well("terminal", said)


def _colours(environment: Mapping[str, str]) -> Examination:
    if environment.get("NO_COLOR"):
        return well("colours", "greys alone, as NO_COLOR asks; letters and textures say the rest")
    if environment.get("COLORTERM", "").lower() in {"truecolor", "24bit"}:
        return well("colours", "16 million")
    name = environment.get("TERM", "")
    if "256color" in name or "direct" in name or "kitty" in name:
        return well("colours", "256 (export COLORTERM=truecolor if the terminal has more)")
    return note("colours", "16", "export COLORTERM=truecolor if the terminal has more, as most have")


def _signs(shown_on: TerminalFacts) -> Examination:
    if shown_on.charset == "ascii":
        return note(
            "signs",
            "ASCII alone, as where the locale, or what Python writes with, is not UTF-8",
            "export LANG=C.UTF-8, and leave LC_ALL and PYTHONIOENCODING unset",
        )
    return well("signs", f"{_SAMPLE}  (a box or ? among them: another font, or --charset block or ascii)")


def _between(environment: Mapping[str, str]) -> Iterator[Examination]:
    where = [
        *(["ssh"] if environment.get("SSH_CONNECTION") or environment.get("SSH_TTY") else []),
        *(["tmux"] if environment.get("TMUX") else []),
        *(["screen"] if environment.get("STY") else []),
    ]
    if where:
        yield well("between", " and ".join(where))
    if environment.get("TMUX"):
        yield note(
            "clipboard",
            "tmux keeps what is copied, unless told to hand it on",
            "type tmux set -s set-clipboard on",
        )
    elif environment.get("STY"):
        yield note("clipboard", "screen keeps what is copied", "copy with the mouse and shift, or use tmux")
    else:
        yield well("clipboard", "is asked by OSC 52, which the terminal may have to allow in its settings")
