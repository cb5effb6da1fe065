"""What the console uses of Textual's private parts: where, and whether Textual's code is still the same."""

import ast
import inspect
import tomllib
from collections.abc import Callable, Iterator
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest
from textual._compositor import Compositor
from textual._styles_cache import StylesCache
from textual.app import App
from textual.command import CommandPalette
from textual.driver import Driver
from textual.drivers._writer_thread import WriterThread
from textual.drivers.linux_driver import LinuxDriver
from textual.drivers.web_driver import WebDriver
from textual.message_pump import MessagePump
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import OptionList
from textual.widgets._toast import Toast, ToastRack

import cbtui.app
import cbtui.screens.exercise
import cbtui.screens.replay
import cbtui.terminal.browser_driver
import cbtui.terminal.driver  # noqa: F401

_ROOT = Path(__file__).parents[2]
_ROOM = "cbtui/terminal/"

WORKAROUNDS: dict[str, tuple[str, list[Callable[..., Any]]]] = {
    "compositing: partial pictures are larger than what changed": (
        "0c0c18526abe",
        [Compositor.render_partial_update, Compositor._regions_to_spans],
    ),
    "compositing: a layout that was looked at before it is made counts as made": (
        "2efd5e570c8f",
        [Compositor.reflow, vars(Compositor)["full_map"].fget, Compositor.update_widgets],
    ),
    "late_painting: each change of a widget takes two messages": (
        "aa402358738b",
        [Widget.refresh, Widget._set_dirty, Widget._exchange_repaint_regions, Screen._on_update],
    ),
    "driver: SIGCONT takes the terminal twice, or waits for its own lock; a closed terminal raises": (
        "e4056131b503",
        [
            LinuxDriver._sigcont_application,
            LinuxDriver._sigtstp_application,
            LinuxDriver.suspend_application_mode,
            LinuxDriver.write,
            WriterThread,
        ],
    ),
    "browser_driver: the console outlives the server": (
        "8ad9bc857052",
        [WebDriver.__init__, WebDriver.run_input_thread],
    ),
    "ending: a fault is printed with all of its traceback; widgets miss others while the app ends": (
        "67886ba8e36c",
        [App._handle_exception, App._fatal_error, App.exit],
    ),
    "pending_keys: keys reach a screen before it is whole; clicks reach what is gone": (
        "3dbf14d69491",
        [App.on_event],
    ),
    "textual_internals.SafeCommandPalette": (
        "a1540bec7776",
        [CommandPalette._gather_commands, CommandPalette._action_command_list, CommandPalette._on_click],
    ),
    "textual_internals.resize_content": ("edb9f6257285", [Widget._scroll_update]),
    "textual_internals.paint_now: nothing is drawn before the message on hand has been handled": (
        "a0d863d867bc",
        [Screen._compositor_refresh, App._display, Compositor.update_widgets],
    ),
    "textual_internals.update_now: a picture waits for the next of sixty a second": (
        "421401660de1",
        [Screen._on_timer_update],
    ),
    "textual_internals.set_title: a new title draws the whole widget": (
        "56fa711aecd9",
        [type(vars(Widget)["border_title"]).__set__],
    ),
    "textual_internals.take_back": ("0ca739607455", [App._unnotify]),
    "textual_internals.clear_read": ("0ca739607455", [App._unnotify]),
    "textual_internals.make_room_for": ("6aeb8eba3002", [App._unnotify, Toast._on_mount, Toast._expire]),
    "textual_internals.clear_hints": ("68eb0959a230", [App.clear_notifications]),
    "textual_internals._remove_holders: toasts go without what holds them": (
        "764c33fbdc91",
        [ToastRack.show],
    ),
    "textual_internals.is_being_removed": ("be1dc93ca461", [App._prune]),
    "textual_internals.forget_drawn_styles": ("d2509f3e7966", [StylesCache.get_inner_outer.__wrapped__]),
    "widgets.options: paging fails where no line is visible": ("85f7f3300576", [OptionList._move_page]),
}


@pytest.mark.parametrize("workaround", WORKAROUNDS)
def test_textual_is_as_it_was_when_the_workaround_was_written(workaround: str) -> None:
    """After an upgrade: look whether the workaround may go or must change, then note the new digest."""
    digest, code = WORKAROUNDS[workaround]
    assert sha256("".join(map(inspect.getsource, code)).encode()).hexdigest()[:12] == digest, workaround


def test_the_version_of_textual_is_pinned() -> None:
    project = tomllib.loads((_ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"textual=={version('textual')}" in project["dependencies"]


def test_private_modules_of_textual_are_imported_in_one_room() -> None:
    for path in (_ROOT / "cbtui").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("textual._"):
                assert path.relative_to(_ROOT).as_posix().startswith(_ROOM), f"{path}:{node.lineno}"


def test_private_methods_of_textual_are_overridden_in_one_room() -> None:
    for own in _below(MessagePump, Driver, Compositor):
        if own.__module__.startswith("cbtui.") and not own.__module__.startswith("cbtui.terminal."):
            inherited = [vars(base) for base in own.__mro__ if base.__module__.startswith("textual")]
            for name, value in vars(own).items():
                if inspect.isfunction(value) and name.startswith("_") and not name.startswith("__"):
                    assert not any(name in base for base in inherited), f"{own.__qualname__}.{name}"


def _below(*classes: type[Any]) -> Iterator[type[Any]]:
    for each in classes:
        for own in each.__subclasses__():
            yield own
            yield from _below(own)
