"""The panes of a run: which is current, which has the focus, and their titles."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from textual.screen import Screen
from textual.widget import Widget

from cbtui.keys.action import Scope
from cbtui.keys.keymap import keymap_of
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.terminal.editor import EditorError, edit
from cbtui.terminal.textual_internals import set_title
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.choice import ChoiceOptions
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.factory import FactoryView
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.keys import lane_keys
from cbtui.widgets.log import LogLines, LogView
from cbtui.widgets.robot import RobotView
from cbtui.widgets.shell import ShellOutput
from cbtui.widgets.tabs import Tabs, title_of

PANE_ALONE = "-maximised"
LANES_ALONE = "-lanes-alone"
"""Style classes of a screen that one pane, or the lanes, fill."""
WITHOUT_ROBOT = "-without-robot"
"""Style class of a screen without a robot."""
_BEHIND = {"log": "shell", "checks": "guide", "choice": "guide", "code": "robot"}
"""Panes of the grid that are replaced by another pane while that is current, or make room for it."""
_INSIDES: dict[str, type[Widget]] = {"log": LogLines, "shell": ShellOutput, "choice": ChoiceOptions}
"""The widget inside a pane that takes the focus."""


@dataclass
class PaneLayout(ScreenPart):
    """Arranges the panes ``names`` of a screen; the current one, or the lanes, can fill it.

    ``changes`` returns the user's changes to the run in words. ``arranged`` is called when others are shown.
    """

    screen: Screen[None]
    host: ScreenHost
    names: tuple[str, ...]
    current: str
    changes: Callable[[], str]
    arranged: Callable[[], object] = lambda: None

    def pane(self, name: str) -> Widget:
        """Return a pane."""
        return self.screen.query_one(f"#{name}")

    def show(self, name: str) -> None:
        """Make a pane the current one."""
        screen = self.screen
        if screen.has_class(LANES_ALONE):
            self.enlarge("")
        self.current = name
        for each in self.names:
            self.pane(each).set_class(each == name, "-current")
            self.pane(each).set_class(_BEHIND.get(each) == name, "-behind")
        self.arranged()
        screen.query_one(Tabs).current = name
        self.update_titles()
        if not self.pane(name).has_focus_within:
            inside = _INSIDES.get(name)
            (self.pane(name) if inside is None else screen.query_one(inside)).focus()
        self.host.redraw()

    def follow_focus(self, focused: Widget) -> None:
        """Make the pane with the focus current."""
        ids = (widget.id for widget in focused.ancestors_with_self)
        name = next((each for each in ids if each in self.names), None)
        if name is not None and name != self.current:
            self.show(name)

    def update_titles(self) -> None:
        """Show the notes of panes in their frames and in the tabs."""
        notes = {}
        for name in self.names:
            pane = self.pane(name)
            if isinstance(pane, CodeView | FactoryView | LogView | ChecksView):
                notes[name] = pane.note
                set_title(pane, f"{title_of(name)} {pane.note}".rstrip())
        words = self.changes()
        changed = f"changed: {words}" if words else ""
        self.screen.query_one(Tabs).note = " · ".join(filter(None, (notes.get(self.current), changed)))

    def enlarge(self, alone: str) -> None:
        """Let the current pane or the lanes fill the screen; "" for neither."""
        screen = self.screen
        for name in (PANE_ALONE, LANES_ALONE):
            screen.set_class(name == alone, name)
        self.arranged()
        more = ("lane_above", "lane_below") if alone == LANES_ALONE else ("enlarge_lanes",)
        keys = lane_keys(keymap_of(screen.app), Scope.LESSON, self.host.charset, *more)
        screen.query_one(Lanes).keys = keys
        self.host.redraw()

    def set_robot(self, is_here: bool) -> None:
        """Show the robot's pane, or give its room to the code."""
        if is_here is self.screen.has_class(WITHOUT_ROBOT):
            self.screen.set_class(not is_here, WITHOUT_ROBOT)
            self.screen.query_one(Tabs).empty = "" if is_here else "robot"
            self.arranged()

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the existing panes, and the camera where there is a robot."""
        if action == "cycle_camera":
            return not self.screen.has_class(WITHOUT_ROBOT)
        return action != "show_pane" or not parameters or parameters[0] in self.names

    def action_show_pane(self, name: str) -> None:
        """Go to a pane; that of a robot stays closed where there is none."""
        if name == self.screen.query_one(Tabs).empty != self.current:
            self.host.tell(f"There is no {name} in this run.")
        else:
            self.show(name)

    def action_next_pane(self) -> None:
        """Go to the next pane."""
        place = self.names.index(self.current) + 1
        following = (*self.names[place:], *self.names[:place])
        self.show(next(name for name in following if name != self.screen.query_one(Tabs).empty))

    def action_maximise(self) -> None:
        """Let the current pane, or the lanes if they have the focus, fill the screen, or undo that."""
        if self.screen.query_one(Lanes).has_focus:
            self.action_enlarge_lanes()
        else:
            self.enlarge("" if self.screen.has_class(PANE_ALONE) else PANE_ALONE)

    def action_enlarge_lanes(self) -> None:
        """Go to the lanes and let them fill the screen, or go back to the current pane."""
        if self.screen.has_class(LANES_ALONE):
            self.show(self.current)
        else:
            self.enlarge(LANES_ALONE)
            self.screen.query_one(Lanes).focus()

    def action_cycle_camera(self) -> None:
        """Show the robot's map, the camera's picture, or both."""
        self.screen.query_one(RobotView).cycle_camera()
        self.name_robot()

    def name_robot(self) -> None:
        """Call the robot's pane a scene while it shows one."""
        robot = self.screen.query_one(RobotView)
        has_scene = robot.shows_scene
        set_title(robot, title_of("robot", has_scene))
        self.screen.query_one(Tabs).has_scene = has_scene

    def action_filter_log(self) -> None:
        """Let the person type a filter for the log."""
        self.show("log")
        self.screen.query_one(LogView).focus_filter()

    def action_no_follow(self) -> None:
        """Say where the log is followed."""
        log = self.host.key("show_pane('log')")
        self.host.tell(f"Only the log is followed or stays: {log} goes there.")

    def action_open_source(self) -> None:
        """Open the code in the user's editor, at the diagnosis or the line chosen in the code.

        The run continues meanwhile.
        """
        self.screen.run_worker(self._edit(), group="editor", exclusive=True)

    async def _edit(self) -> None:
        code, told = self.screen.query_one(CodeView), self.screen.query_one(DiagnosisLine).diagnosis.place
        path, line = code.place
        if told is not None and code.picked is None and not code.has_focus:
            path, line = Path(told.file), told.first_line
        try:
            await edit(self.screen.app, path, line)
        except EditorError as error:
            self.host.tell(str(error))
        code.check_disk()
