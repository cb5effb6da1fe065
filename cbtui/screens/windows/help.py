"""The help: the signs of the screen, then every key by what it is for, with a search."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, TypeAlias

from textual import on
from textual.app import ComposeResult
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.widgets import Input, Static

from cbtui.keys.action import KeyAction, Scope, group_by
from cbtui.keys.actions import ACTIONS, TASKS, actions_of
from cbtui.keys.keymap import Keymap, keymap_of, keys_of
from cbtui.keys.refused import OWN_TIME
from cbtui.keys.signs import signs_of
from cbtui.learning.stage import Stage, meaning_of
from cbtui.looks.theme import Charset
from cbtui.screens.layout import Layout
from cbtui.screens.windows.signs import SignList, code_signs, factory_signs, lane_signs
from cbtui.screens.windows.window import WindowScreen
from cbtui.text.cells import lines_of_text
from cbtui.widgets.key_bar import KeyBar

_SHOWN = (
    Scope.CHECKS,
    Scope.CHOICE,
    Scope.CODE,
    Scope.LOG,
    Scope.FILTER,
    Scope.PROMPT,
    Scope.KEYBOARD,
    Scope.COMPARE,
    Scope.MENU,
    Scope.SEARCH,
    Scope.OPENING,
    Scope.EVERYWHERE,
)
"""The scopes that follow the lesson's tasks."""
_WIDEST = 160
"""The most columns of the window."""
_IN_A_RUN = "In a run: "
"""Comes before the names of a run's tasks where the help is over another screen."""

_AbsenceOf: TypeAlias = Callable[[Sequence[KeyAction]], str | None]


class _HelpRow(NamedTuple):
    """A key or a sign, and what it means."""

    sign: str
    meaning: str
    absence: str | None = None
    """What is added to the meaning of a key that does nothing at the moment."""
    labels: str = ""
    """The words of the footer, which a search finds too."""


class _Section(NamedTuple):
    """Rows under a heading."""

    heading: str
    rows: Sequence[_HelpRow]


class _HelpPage(NamedTuple):
    """The sections of the help: what comes first, the keys by task, and those of other places."""

    first: Sequence[_Section]
    tasks: Sequence[_Section]
    others: Sequence[_Section]


class HelpScreen(WindowScreen[None]):
    """Lists signs and keys; a search leaves the rows that contain all of its words.

    A wide window has the keys by task beside the signs. Keys that do nothing now are in brackets.
    """

    SCOPE = Scope.HELP
    HAS_HELP = False
    heading = "Signs and keys · in brackets: not now"

    def content(self) -> ComposeResult:
        """Lay out the search and the list."""
        yield Input(placeholder="words to look for", compact=True)
        with VerticalScroll(), Horizontal():
            yield Static(id="found")
            yield Static(id="beside")

    def on_mount(self) -> None:
        """Show everything."""
        below = self.app.screen_stack[-2]
        scope = getattr(below, "SCOPE", None)

        bar = below.query_one(KeyBar)
        does = {(key, action.name) for key, action in bar.in_force().items()}
        here = {each.scope for each in actions_of(bar.scope)}
        if scope is Scope.COMPARE:
            here.add(Scope.LESSON)  # somebody who compares comes from a run, and tries its keys

        def absence(actions: Sequence[KeyAction]) -> str | None:
            meant = {(key, action.name) for action in actions for key in keys_of(action)}
            if actions[0].scope not in here or meant & does:
                return None
            is_timed = scope is Scope.LESSON and actions[0].name in OWN_TIME
            is_real = is_timed and below.check_action("no_time", (actions[0].name,))
            return " (not on real ROS 2)" if is_real else ""

        self._page = _page(scope, keymap_of(self.app), self._charset, absence)
        self._headings: list[tuple[int, str]] = []
        """The headings, and the rows on which they stand."""
        self.query_one(Input).display = False
        self.query_one(VerticalScroll).focus()
        self.watch(self.query_one(VerticalScroll), "scroll_y", self._name_what_follows, init=False)

    def laid_out(self) -> None:
        """Break the lines for the new size."""
        self.call_next(self._show)

    def action_search(self) -> None:
        """Let words be typed."""
        search = self.query_one(Input)
        search.display = True
        search.focus()

    def action_close(self) -> None:
        """End the search; without one close the window."""
        search = self.query_one(Input)
        if not search.display:
            super().action_close()
            return
        search.value = ""
        search.display = False
        self.query_one(VerticalScroll).focus()

    def action_line_up(self) -> None:
        """Scroll up by a line."""
        self.query_one(VerticalScroll).scroll_up(animate=False)

    def action_line_down(self) -> None:
        """Scroll down by a line."""
        self.query_one(VerticalScroll).scroll_down(animate=False)

    def action_next_heading(self) -> None:
        """Scroll to the next heading, from the end to the start."""
        scroll = self.query_one(VerticalScroll)
        below = (row for row, _ in sorted(self._headings) if row > scroll.scroll_y)
        scroll.scroll_to(
            y=0 if scroll.scroll_y >= scroll.max_scroll_y else next(below, 0), animate=False, immediate=True
        )

    @on(Input.Changed)
    def _show(self) -> None:
        wanted = self.query_one(Input).value.casefold().split()
        first, tasks, others = (_with(wanted, sections) for sections in self._page)
        is_wide = self.layout_now is Layout.GRID
        columns = ([*first, *others], tasks) if is_wide else ([*first, *tasks, *others], [])
        found, beside = self.query_one("#found", Static), self.query_one("#beside", Static)
        beside.display = is_wide and bool(tasks)
        frame = 5
        width = (min(self.app.size.width, _WIDEST) - frame) // 2 - 2 if beside.display else 80 - frame - 2
        self._headings = []
        for column, sections in zip((found, beside), columns, strict=True):
            rows: list[Content] = []
            for section in sections:
                self._headings.append((len(rows), section.heading))
                rows += _shown(section, width, self._charset)
            column.update(Content("\n").join(rows))
        if not any(columns):
            found.update("No sign or key has all of these words.")
        self.query_one(VerticalScroll).scroll_home(animate=False)
        self.call_after_refresh(self._name_what_follows)

    def _name_what_follows(self) -> None:
        """Say in the frame which headings come below what is in sight."""
        scroll = self.query_one(VerticalScroll)
        bottom = scroll.scroll_y + scroll.scrollable_content_region.height
        below = [heading for row, heading in sorted(self._headings) if row >= bottom]
        self.query_one(".window").border_subtitle = f"below: {', '.join(below)}" if below else ""

    @on(Input.Submitted)
    def _read(self) -> None:
        self.query_one(VerticalScroll).focus()


def _with(wanted: Sequence[str], sections: Iterable[_Section]) -> list[_Section]:
    """Return the rows that have all of some words, under their headings."""
    return [
        _Section(each.heading, rows)
        for each in sections
        if (rows := [row for row in each.rows if _has(row, each.heading, wanted)])
    ]


def _has(row: _HelpRow, heading: str, words: Sequence[str]) -> bool:
    text = f"{row.sign} {row.meaning} {row.labels} {heading.removeprefix(_IN_A_RUN)}".casefold()
    return all(word in text for word in words)


def _shown(section: _Section, width: int, charset: Charset) -> list[Content]:
    """Return the lines of a section, and an empty one."""
    lines = [Content.styled(section.heading, "bold $text-primary")]
    for row in section.rows:
        is_absent = row.absence is not None
        styles = ("$text-muted",) * 2 if is_absent else ("bold $text-accent", "$text")
        for place, text in enumerate(lines_of_text(f"{row.meaning}{row.absence or ''}", width - 11, charset)):
            sign = "" if place else f"({row.sign})" if is_absent else row.sign
            lines.append(Content.assemble((f"{sign:>9}", styles[0]), (f"  {text}", styles[1])))
    return [*lines, Content("")]


def _page(scope: Scope | None, keymap: Keymap, charset: Charset, absence: _AbsenceOf) -> _HelpPage:
    """Return the help over a screen of ``scope``, whose own keys come before those of others."""
    place = "" if scope is Scope.LESSON else _IN_A_RUN
    tasks = [_of_task(f"{place}{task}", ids, keymap, charset, absence) for task, ids in TASKS.items()]
    lanes, *panes = (_of_signs(of(charset)) for of in (lane_signs, factory_signs, code_signs))
    others = {each: _of_scope(each, keymap, charset, absence) for each in _SHOWN}
    if scope in (Scope.MENU, Scope.SEARCH):
        first = [_stages(), others.pop(scope), lanes]
        return _HelpPage(first, tasks, [*panes, *others.values()])
    if scope in others:
        tasks.insert(0, others.pop(scope))
    own = [] if scope in (None, Scope.LESSON, *_SHOWN) else [_of_scope(scope, keymap, charset, absence)]
    return _HelpPage([*own, lanes], tasks, [*panes, *others.values(), _stages()])


def _stages() -> _Section:
    return _Section("Signs of the menu", [_HelpRow(stage.value, meaning_of(stage)) for stage in Stage])


def _of_signs(signs: SignList) -> _Section:
    return _Section(signs.heading, [_HelpRow(*row) for row in signs.rows])


def _of_task(
    task: str,
    ids: Sequence[str],
    keymap: Keymap,
    charset: Charset,
    absence: _AbsenceOf,
) -> _Section:
    actions = [action for action in ACTIONS if action.scope is Scope.LESSON and action.name in ids]
    actions.sort(key=lambda action: ids.index(action.name))
    return _keys(task, actions, keymap, charset, absence)


def _of_scope(scope: Scope, keymap: Keymap, charset: Charset, absence: _AbsenceOf) -> _Section:
    own = [action for action in ACTIONS if action.scope is scope and not action.refused]
    return _keys(scope.value, own, keymap, charset, absence)


def _keys(
    heading: str,
    actions: Sequence[KeyAction],
    keymap: Keymap,
    charset: Charset,
    absence: _AbsenceOf,
) -> _Section:
    groups = group_by(keymap.of(actions), "line")
    return _Section(
        heading,
        [
            _HelpRow(
                signs_of(group, charset),
                group[0].line,
                absence(group),
                " ".join(action.label for action in group),
            )
            for group in groups
        ],
    )
