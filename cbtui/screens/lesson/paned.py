"""The panes of a run: which of them is shown, which has the keys, and what stands in its frame."""

from collections.abc import Iterator, Mapping

from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.containers import Container
from textual.events import DescendantFocus
from textual.widget import Widget

from cbtui.keys.actions import Scope
from cbtui.keys.keymap import keymap_of
from cbtui.screens.lesson.running import RunningScreen
from cbtui.terminal.editor import EditorError, edit
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.factory import FactoryView
from cbtui.widgets.guide import Guide
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.keys import lane_keys
from cbtui.widgets.log import LogFilter, LogLines, LogView
from cbtui.widgets.robot import RobotView
from cbtui.widgets.shell import ProgramKeyboard, Prompt, ShellOutput, ShellView
from cbtui.widgets.status_line import StatusLine
from cbtui.widgets.tabs import Tabs, title_of

_SCOPES: dict[type[Widget], Scope] = {
    Prompt: Scope.PROMPT,
    ProgramKeyboard: Scope.KEYBOARD,
    LogLines: Scope.LOG,
    LogFilter: Scope.FILTER,
    CodeView: Scope.CODE,
    ChecksView: Scope.CHECKS,
}
"""Whose keys are told of while it has the focus."""

_PANE_ALONE = "-maximised"
_LANES_ALONE = "-lanes-alone"
"""Classes of a screen that one pane, or the lanes, fill."""


class PanedScreen(RunningScreen):
    """Lays out lines, lanes and panes."""

    def compose(self) -> ComposeResult:
        """Lay out lines, lanes and panes."""
        yield StatusLine()
        yield Lanes()
        yield Tabs(self.PANES_HERE)
        with Container(id="panes"):
            yield from self._panes()
        yield DiagnosisLine()
        yield KeyBar(Scope.LESSON, self._charset)

    def _panes(self) -> Iterator[Widget]:
        factory, robot = FactoryView(id="factory"), RobotView(id="robot")
        factory.can_focus = robot.can_focus = True
        guide = Guide(self._page, id="guide")
        subject = self._subject
        code = CodeView(subject.node_path, subject.source, subject.sources, id="code")
        for pane in (guide, code, robot, factory, LogView(id="log"), ShellView(id="shell")):
            assert pane.id is not None
            pane.border_title = title_of(pane.id)
            pane.add_class("pane")
            yield pane

    @property
    def _page(self) -> Mapping[str, str]:
        """The parts of the guide that can be read now."""
        return {"guide": self._subject.guide}

    def _widget(self, pane: str) -> Widget:
        return self.query_one(f"#{pane}")

    def _show(self, pane: str) -> None:
        """Make a pane the current one."""
        if self.has_class(_LANES_ALONE):
            self._enlarge("")
        self._pane = pane
        for name in self.PANES_HERE:
            self._widget(name).set_class(name == pane, "-current", update=False)
        self._widget("log").set_class(pane == "shell", "-behind", update=False)
        self.update_node_styles(animate=False)
        self.query_one(Tabs).current = pane
        self._entitle()
        place = self._focus_of(pane)
        if not self._widget(pane).has_focus_within:
            place.focus()
        self._stale = True

    def _focus_of(self, pane: str) -> Widget:
        """What of a pane takes the keys."""
        insides: dict[str, type[Widget]] = {"log": LogLines, "shell": ShellOutput}
        return self.query_one(insides[pane]) if pane in insides else self._widget(pane)

    @property
    def _notes(self) -> dict[str, str]:
        """What panes say of themselves."""
        return {"code": self.query_one(CodeView).note, "log": self.query_one(LogView).note}

    def _entitle(self) -> None:
        """Say in frames and tabs what panes say of themselves."""
        notes = self._notes
        for pane, note in notes.items():
            self._widget(pane).border_title = Text(f"{title_of(pane)} {note}")
        changed = f"changed: {self._changes.words}" if self._changes.words else ""
        self.query_one(Tabs).note = " · ".join(filter(None, (notes.get(self._pane), changed)))

    @on(Tabs.Picked)
    def _pick(self, message: Tabs.Picked) -> None:
        self._show(message.pane)

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Make the pane current that the person clicked on."""
        ids = (widget.id for widget in event.widget.ancestors_with_self)
        pane = next((each for each in ids if each in self.PANES_HERE), None)
        if pane is not None and pane != self._pane:
            self._show(pane)
        scopes = (scope for kind, scope in _SCOPES.items() if isinstance(self.focused, kind))
        self.query_one(KeyBar).show(next(scopes, Scope.LESSON))

    @on(Prompt.Given)
    def _give_line(self, message: Prompt.Given) -> None:
        self._run.give_line(message.text)

    @on(ProgramKeyboard.Given)
    def _type_for_program(self, message: ProgramKeyboard.Given) -> None:
        self._run.type(message.text)

    @on(Prompt.Interrupted)
    def _interrupt_line(self) -> None:
        self._run.interrupt_line()

    @on(Prompt.CompletionWanted)
    def _complete_line(self, message: Prompt.CompletionWanted) -> None:
        self._run.complete_line(message.text, message.cursor)

    def action_prompt(self) -> None:
        """Let the person type a ros2 line."""
        self._show("shell")
        self.query_one(ShellView).focus_prompt()

    def action_type(self) -> None:
        """Let the person type for the program that reads."""
        self._show("shell")
        self.query_one(ShellView).focus_keyboard()

    def action_filter_log(self) -> None:
        """Let the person type a filter for the log."""
        self._show("log")
        self.query_one(LogView).focus_filter()

    @on(CodeView.EditorWanted)
    def action_open_source(self) -> None:
        """Open the code in the person's editor; the run goes on meanwhile."""
        self.run_worker(self._open_source(), group="editor", exclusive=True)

    async def _open_source(self) -> None:
        path, line = self.query_one(CodeView).place
        try:
            await edit(self.app, path, line)
        except EditorError as error:
            self._tell(str(error))
        self.query_one(CodeView).look_at_disk()

    def action_show_pane(self, pane: str) -> None:
        """Go to a pane."""
        self._show(pane)

    def action_next_pane(self) -> None:
        """Go to the next pane."""
        panes = self.PANES_HERE
        self._show(panes[(panes.index(self._pane) + 1) % len(panes)])

    def action_maximise(self) -> None:
        """Let the current pane, or the lanes if they have the keys, fill the screen; or none of them."""
        if self.query_one(Lanes).has_focus:
            self.action_enlarge_lanes()
        else:
            self._enlarge("" if self.has_class(_PANE_ALONE) else _PANE_ALONE)

    def action_enlarge_lanes(self) -> None:
        """Go to the lanes and let them fill the screen, or go back to the current pane."""
        if self.has_class(_LANES_ALONE):
            self._show(self._pane)
        else:
            self._enlarge(_LANES_ALONE)
            self.query_one(Lanes).focus()

    def _enlarge(self, alone: str) -> None:
        """Let the current pane or the lanes fill the screen; "" for neither."""
        for name in (_PANE_ALONE, _LANES_ALONE):
            self.set_class(name == alone, name, update=False)
        self.update_node_styles(animate=False)
        more = ("lane_above", "lane_below") if alone == _LANES_ALONE else ("enlarge_lanes",)
        self.query_one(Lanes).keys = lane_keys(keymap_of(self.app), Scope.LESSON, self._charset, *more)
        self._stale = True

    def action_cycle_camera(self) -> None:
        """Show the robot's map, the camera's picture, or both."""
        self.query_one(RobotView).cycle_camera()
