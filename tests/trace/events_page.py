"""Writes ``EVENTS.md`` from the classes of events: ``python -m tests.trace.events_page``."""

import ast
import inspect
from collections.abc import Iterable
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from textwrap import fill
from typing import get_args

from sim.export.jsonl import JsonField, json_fields
from sim.trace.events import AnyEvent, JsonForm, Shown, TimePassed, fields, kinds

PAGE = Path(str(files("sim.trace") / "EVENTS.md"))

_INTRODUCTION = """\
# Events as lines of JSON

`cbtui run … --events FILE.jsonl` writes one JSON object a line, one for each event of the run, in the order
in which they happened. Every line begins with `t`, seconds since the run began, and `event`, the event's
name. Then come the fields below, in this order; those marked `?` are there only when they apply. Infinite
numbers and NaN are `null`.

This page is written from the classes in [events](events): `python -m tests.trace.events_page`.

## Fields of many events

| fields | what they tell |
| --- | --- |
"""


def kinds_with_lines() -> tuple[type[AnyEvent], ...]:
    """The kinds of events that have a line of JSON, in the order of the page."""
    return tuple(kind for kind in kinds() if kind is not TimePassed)


def page() -> str:
    """The whole page."""
    shared = "".join(f"| `{names}` | {text} |\n" for names, text in _shared().items())
    modules = groupby(kinds_with_lines(), key=inspect.getmodule)
    return (
        _INTRODUCTION + shared + "".join(_module(inspect.getdoc(module) or "", of) for module, of in modules)
    )


def unexplained() -> list[str]:
    """Fields of which the page says nothing: neither their types nor their events have a text."""
    shared = {names.rstrip("?") for names in _shared()}
    return [
        f"{kind.__name__}.{field.attribute}"
        for kind in kinds_with_lines()
        for field in json_fields(kind)
        if field.attribute not in _texts(_definition(kind)) and field.form.names not in shared
    ]


def _shared() -> dict[str, str]:
    """The texts of the types of fields, by the names of the fields."""
    texts = _texts(ast.parse(inspect.getsource(fields)))
    forms = {name: _form(get_args(getattr(fields, name, None))) for name in texts}
    return {form: _markdown(texts[name]) for name, form in forms.items() if form}


def _form(marks: tuple[object, ...]) -> str:
    names = next((mark.names for mark in marks if isinstance(mark, JsonForm)), "")
    return f"{names}?" if Shown.IF_ANY in marks else names


def _module(about: str, kinds_of_it: Iterable[type[AnyEvent]]) -> str:
    return f"\n## {about.rstrip('.')}\n" + "".join(map(_section, kinds_of_it))


def _section(kind: type[AnyEvent]) -> str:
    texts = _texts(_definition(kind))
    told = " ".join(name for field in json_fields(kind) for name in field.names)
    items = "".join(
        fill(f"- {_names(field)}: {_markdown(texts[field.attribute])}", 110, subsequent_indent="  ") + "\n"
        for field in json_fields(kind)
        if field.attribute in texts
    )
    about = inspect.cleandoc(kind.__doc__ or "").split("\n\n")
    paragraphs = "\n\n".join(fill(_markdown(paragraph), 110) for paragraph in about)
    return f"\n### {kind.__struct_config__.tag}\n\n{paragraphs}\n\n`{told}`\n" + (items and f"\n{items}")


def _names(field: JsonField) -> str:
    names = ", ".join(f"`{name.rstrip('?')}`" for name in field.names)
    return f"{names} ({field.form.unit})" if field.form.unit else names


def _definition(kind: type) -> ast.ClassDef:
    (found,) = ast.parse(inspect.getsource(kind)).body
    assert isinstance(found, ast.ClassDef)
    return found


def _texts(scope: ast.Module | ast.ClassDef) -> dict[str, str]:
    """The texts that stand below the names of a module or class."""
    found = {}
    for named, text in zip(scope.body, scope.body[1:], strict=False):
        match named, text:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(told))),
            ):
                found[name] = told
    return found


def _markdown(text: str) -> str:
    return " ".join(text.split()).replace("``", "`")


if __name__ == "__main__":
    PAGE.write_text(page())
