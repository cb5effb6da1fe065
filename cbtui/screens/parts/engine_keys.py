"""Keys that command an engine: time, service, robot, keyboard of the programs, and recording."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from cbtui.runs.live.live_recording import FinishFile
from cbtui.runs.live.live_run import LiveRun, RunState, ShownRun, has_robot
from cbtui.runs.recorded.recording_file import CannotRecordError
from cbtui.runs.setup.changeable import is_set_bool
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import DrawnHost, RunHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.widgets.shell import ShellOutput, ShellView

_GOES_ON = "Real ROS 2 goes on by itself: only the model's time can be stopped, stepped or changed."


@dataclass
class PaceKeys(ScreenPart):
    """Pauses and resumes a run, and changes its speed; ``resumed`` is called when it was resumed."""

    host: DrawnHost
    runs: RunController[ShownRun]
    resumed: Callable[[], object] = lambda: None

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the actions that would have an effect."""
        run = self.runs.run
        changes = {
            "pause": not run.paused,
            "resume": run.paused,
            "slower": run.speed != run.speeds[0],
            "faster": run.speed != run.speeds[-1],
        }
        return run.can_be_paced and changes[action]

    def action_pause(self) -> None:
        """Stop time."""
        self.runs.run.pause()
        self.host.redraw()

    def action_resume(self) -> None:
        """Let time go on."""
        self.runs.run.resume()
        self.resumed()
        self.host.redraw()

    def action_slower(self) -> None:
        """Let time pass more slowly."""
        self.runs.run.change_speed(-1)
        self.host.redraw()

    def action_faster(self) -> None:
        """Let time pass faster."""
        self.runs.run.change_speed(1)
        self.host.redraw()


@dataclass
class TimeRefusals(ScreenPart):
    """Explains why actions that need a time of their own do not exist on real ROS 2.

    ``is_available`` tells whether an action does something.
    """

    host: RunHost
    runs: RunController[LiveRun]
    is_available: Callable[[str], bool]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the refusal where the action itself is not offered."""
        [wanted] = parameters
        return self.runs.run.setup.real is not None and not self.is_available(str(wanted))

    def action_no_time(self, _wanted: str) -> None:
        """Show the explanation."""
        self.host.tell(_GOES_ON)


class Finisher(Protocol):
    """Finishes files in the background."""

    def finish(self, finish: FinishFile | None) -> None:
        """Finish a file and report the result; does nothing for None."""


@dataclass
class RecordingKey(ScreenPart):
    """Records periods of a run to files in the current folder."""

    host: RunHost
    runs: RunController[LiveRun]
    finisher: Finisher

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it while the engine lives."""
        return self.runs.run.alive

    def action_record(self) -> None:
        """Begin a recording of this run, or end it."""
        run = self.runs.run
        if run.recording.count is not None:
            self.finisher.finish(run.end_recording())
        else:
            try:
                self.host.tell(run.record(self.host.key("record")))
            except CannotRecordError as error:
                self.host.tell(str(error))
        self.host.redraw()


@dataclass
class WorldKeys(ScreenPart):
    """Calls the service that the run was set up with, and puts the robot back."""

    host: RunHost
    runs: RunController[LiveRun]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer them while the engine lives; resetting the robot needs one that answers."""
        run = self.runs.run
        if action == "reset_world":
            return run.alive and has_robot(run) and run.state is not RunState.SILENT
        can_call = run.setup.service is not None or any(map(is_set_bool, run.timeline.entities.values()))
        return run.alive and can_call is not action.startswith("no_")

    def action_call_service(self) -> None:
        """Call the lesson's service with true."""
        self._call(True)

    def action_call_service_off(self) -> None:
        """Call the lesson's service with false."""
        self._call(False)

    def _call(self, data: bool) -> None:
        """Call the service, and say so if that is not to be seen at once."""
        run = self.runs.run
        run.call(data)
        if run.state is RunState.PAUSED:
            when = f"when the run goes on: {self.host.key('resume')}"
            self.host.tell(f"The service is called {when}.")
        elif run.state is RunState.STARTING:
            when = "as soon as the program has started"
            self.host.tell(f"The service is called {when}.")

    def action_no_call_service(self) -> None:
        """Say that the programs offer no SetBool service."""
        key = self.host.key("prompt")
        self.host.tell(
            f"There is no SetBool service to call; {key} takes ros2 service call for any other one."
        )

    def action_no_call_service_off(self) -> None:
        """Say the same."""
        self.action_no_call_service()

    def action_reset_world(self) -> None:
        """Put the robot back to its start, which waits for a paused run to go on."""
        self.runs.run.reset_world()
        if self.runs.run.state is RunState.PAUSED:
            self.host.tell(f"The robot is back at its start when the run goes on: {self.host.key('resume')}.")


@dataclass
class TypingKeys(ScreenPart):
    """Moves the focus to the prompt for ``ros2`` lines, or to the input of the programs."""

    runs: RunController[LiveRun]
    panes: PaneLayout
    shell: Callable[[], ShellView]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the prompt while the engine lives, and typing while a program reads."""
        run = self.runs.run
        match action:
            case "prompt":
                return run.alive
            case "prompt_here":
                return run.alive and self.shell().query_one(ShellOutput).has_focus
        return run.asked is not None

    def action_prompt(self) -> None:
        """Focus the prompt for ``ros2`` lines."""
        self.panes.show("shell")
        self.shell().focus_prompt()

    action_prompt_here = action_prompt

    def action_type(self) -> None:
        """Focus the input of the program that reads."""
        self.panes.show("shell")
        self.shell().focus_keyboard()
