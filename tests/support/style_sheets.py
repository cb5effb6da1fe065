"""Textual reads its style sheets anew in every console; the same ones are the same in a thousand tests."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet
from textual.css.types import CSSLocation


@contextmanager
def read_once() -> Iterator[None]:
    """Have all consoles of the process share what was read; nobody changes rules that are read.

    Colours are part of rules: they are read again for every theme. Sheets at fault are read every time.
    """
    read = Stylesheet._parse_rules
    known: dict[tuple[object, ...], list[RuleSet]] = {}

    def look_up(
        sheet: Stylesheet,
        css: str,
        read_from: CSSLocation,
        is_default_rules: bool = False,
        tie_breaker: int = 0,
        scope: str = "",
    ) -> list[RuleSet]:
        told = (css, read_from, is_default_rules, tie_breaker, scope)
        key = (*told, frozenset(sheet._variables.items()))
        if key not in known:
            known[key] = read(sheet, *told)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Stylesheet, "_parse_rules", look_up)
        yield
