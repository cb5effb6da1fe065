"""The help: the signs of the screen, then every key by what it is for, with a search."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from textual import on
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Input, Static

from cbtui.keys.action import KeyAction, Scope, group_by
from cbtui.keys.actions import ACTIONS, OWN_TIME, TASKS
from cbtui.keys.keymap import Keymap, keymap_of
from cbtui.keys.signs import signs_of
from cbtui.learning.stage import Stage, meaning_of
from cbtui.looks.theme import GLYPHS, Charset
from cbtui.screens.windows.window import WindowScreen
from sim.trace.events import Reason

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


class _HelpRow(NamedTuple):
    """A key or a sign, and what it means."""

    sign: str
    meaning: str
    is_refused: bool = False
    """Whether real ROS 2 rules it out."""
    labels: str = ""
    """The words of the footer, which a search finds too."""


class _Section(NamedTuple):
    """Rows under a heading."""

    heading: str
    rows: Sequence[_HelpRow]


class HelpScreen(WindowScreen[None]):
    """Lists signs and keys; a search leaves the rows that contain all of its words."""

    SCOPE = Scope.HELP
    HAS_HELP = False
    heading = "Signs and keys"

    def content(self) -> ComposeResult:
        """Lay out the search and the list."""
        yield Input(placeholder="words to look for", compact=True)
        with VerticalScroll():
            yield Static(id="found")

    def on_mount(self) -> None:
        """Show everything."""
        below = self.app.screen_stack[-2]
        scope = getattr(below, "SCOPE", None)

        def is_refused(action: KeyAction) -> bool:
            return (
                scope is Scope.LESSON
                and action.name in OWN_TIME
                and below.check_action("no_time", (action.name,)) is True
            )

        self._sections = tuple(_sections(scope, keymap_of(self.app), self._charset, is_refused))
        self.query_one(Input).display = False
        self.query_one(VerticalScroll).focus()
        self._show("")

    def action_search(self) -> None:
        """Let words be typed."""
        search = self.query_one(Input)
        search.display = True
        search.focus()

    @on(Input.Changed)
    def _search_for(self, event: Input.Changed) -> None:
        self._show(event.value)

    @on(Input.Submitted)
    def _read(self) -> None:
        self.query_one(VerticalScroll).focus()

    def _show(self, words: str) -> None:
        wanted = words.casefold().split()
        found = [
            _Section(each.heading, rows)
            for each in self._sections
            if (rows := [row for row in each.rows if _has(row, each.heading, wanted)])
        ]
        text = (
            Content("\n").join(map(_shown, found))
            if found
            else Content("No sign or key has all of these words.")
        )
        self.query_one("#found", Static).update(text)
        self.query_one(VerticalScroll).scroll_home(animate=False)


def _has(row: _HelpRow, heading: str, words: Sequence[str]) -> bool:
    text = f"{row.sign} {row.meaning} {row.labels} {heading}".casefold()
    return all(word in text for word in words)


def _shown(section: _Section) -> Content:
    rows = (
        Content.styled(f"{row.sign:>9}  {row.meaning} (not on real ROS 2)", "$text-muted")
        if row.is_refused
        else Content.assemble((f"{row.sign:>9}", "bold $text-accent"), f"  {row.meaning}")
        for row in section.rows
    )
    heading = Content.styled(section.heading, "bold $text-primary")
    return Content("\n").join([heading, *rows, Content("")])


def _sections(
    scope: Scope | None, keymap: Keymap, charset: Charset, is_refused: Callable[[KeyAction], bool]
) -> Iterator[_Section]:
    """Yield the signs, then the keys: first those of the screen below, of ``scope``."""
    if scope not in (None, Scope.LESSON, *_SHOWN):
        yield _of_scope(scope, keymap, charset)
    in_menu = scope in (Scope.MENU, Scope.SEARCH)
    signs = (_stages(), _lane_signs(charset)) if in_menu else (_lane_signs(charset), _stages())
    yield from signs
    others = [_of_scope(each, keymap, charset) for each in sorted(_SHOWN, key=lambda each: each is not scope)]
    tasks = [_of_task(task, ids, keymap, charset, is_refused) for task, ids in TASKS.items()]
    yield from [*others[:1], *tasks, *others[1:]] if scope in _SHOWN else [*tasks, *others]


def _stages() -> _Section:
    return _Section("Signs of the menu", [_HelpRow(stage.value, meaning_of(stage)) for stage in Stage])


def _lane_signs(charset: Charset) -> _Section:
    glyphs = GLYPHS[charset]
    bar, line = glyphs.left[8], glyphs.line
    return _Section(
        "Signs of the lanes",
        [
            _HelpRow(
                f"{glyphs.left[4]} {bar * 4}", "a callback runs; letter, colour and fill are its group's"
            ),
            _HelpRow(glyphs.textures, "the fills of long bars: groups A to F, then the same again"),
            _HelpRow(glyphs.hatch[Reason.GROUP_HELD] * 4, "a callback waits: another one holds its group"),
            _HelpRow(glyphs.hatch[Reason.NO_FREE_WORKER] * 4, "a callback waits: every thread is busy"),
            _HelpRow(glyphs.hatch[Reason.EVENT_QUEUE] * 4, "a callback waits: others came before it"),
            _HelpRow(glyphs.hatch[Reason.NOBODY_SPINS] * 4, "a callback waits: nobody spins its node"),
            _HelpRow(glyphs.blocked * 4, "a thread is blocked in a call, or by a lock"),
            _HelpRow(glyphs.inner, "a callback runs inside that of the bar, which spins"),
            _HelpRow(
                f"{glyphs.point} {line * 4}", "a callback holds its group, for a moment or for long; or runs"
            ),
            _HelpRow(glyphs.double_line * 4, "several callbacks of a group run at once"),
            _HelpRow(glyphs.lost, "a message is lost: its queue was full"),
            _HelpRow(glyphs.cross, "a callback raised an exception"),
            _HelpRow("excl reen", "a group's kind where names are short: exclusive, reentrant"),
            _HelpRow("25% busy", "how much of the time on screen a thread worked"),
            _HelpRow("late", "a timer was called later than its period says"),
            _HelpRow(
                f"{glyphs.up} {glyphs.back}", "a service is called and replies; your own call has its key"
            ),
            _HelpRow(glyphs.up, "what else you did: a reset, a ros2 command"),
            _HelpRow(glyphs.cursor, "the moment on screen, which every pane shows"),
        ],
    )


def _of_task(
    task: str,
    ids: Sequence[str],
    keymap: Keymap,
    charset: Charset,
    is_refused: Callable[[KeyAction], bool],
) -> _Section:
    actions = [action for action in ACTIONS if action.scope is Scope.LESSON and action.name in ids]
    actions.sort(key=lambda action: ids.index(action.name))
    return _keys(task, actions, keymap, charset, is_refused)


def _of_scope(scope: Scope, keymap: Keymap, charset: Charset) -> _Section:
    return _keys(scope.value, [action for action in ACTIONS if action.scope is scope], keymap, charset)


def _keys(
    heading: str,
    actions: Sequence[KeyAction],
    keymap: Keymap,
    charset: Charset,
    is_refused: Callable[[KeyAction], bool] = lambda _: False,
) -> _Section:
    groups = group_by(keymap.of(actions), "line")
    return _Section(
        heading,
        [
            _HelpRow(
                signs_of(group, charset),
                group[0].line,
                is_refused(group[0]),
                " ".join(action.label for action in group),
            )
            for group in groups
        ],
    )
