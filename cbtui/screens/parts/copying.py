"""The key that copies what is on screen as plain text."""

from collections.abc import Iterator
from dataclasses import dataclass

from textual.screen import Screen

from cbtui.runs.live.live_run import ShownRun
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.widgets.diagnosis import call_note, diagnosis_at
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.details import details_of_selection
from sim.quantities.durations import duration, timestamp
from sim.trace.descriptions import executor_label, name_of, why_waiting
from sim.trace.figures.concurrency import Concurrency
from sim.trace.figures.waiting import waited_so_far, waits_at
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


@dataclass
class DetailsCopy(ScreenPart):
    """Copies the selected bar's details, or else a summary of the moment on screen."""

    screen: Screen[None]
    host: ScreenHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation
    subject: ShownProgram

    def action_copy_details(self) -> None:
        """Copy to the terminal's clipboard (OSC 52, which works over ssh)."""
        timeline, now = self.runs.timeline, self.navigation.now
        lanes = self.screen.query_one(Lanes)
        selection = lanes.selection_now
        if selection is None:
            lines = list(summary(self.subject, timeline, now, self.runs.concurrency))
            what = f"the moment {timestamp(now)}"
        else:
            details = details_of_selection(timeline, selection, now, lanes.keys)
            lines = [details.title, *(f"  {fact}" for fact in details.facts)]
            what = details.title
        self.screen.app.copy_to_clipboard("\n".join(lines))
        self.host.tell(f"copied {what}")


def summary(
    subject: ShownProgram, timeline: Timeline, now: Nanoseconds, concurrency: Concurrency
) -> Iterator[str]:
    """Yield the lines of a summary: the diagnosis, what runs, and what waits for what."""
    label = executor_label(timeline)
    yield f"{subject.heading_of(timeline)}, t {timestamp(now)}" + (f", {label}" if label else "")
    yield diagnosis_at(timeline, now, concurrency).text
    yield from call_note(timeline, now)[:1]
    yield from (f"  {each}" for each in what_runs(timeline, now))
    moment = timeline.moment(now)
    for wait in waits_at(moment, timeline):
        waits = f"waits {waited_so_far(wait, moment, timeline)}: {why_waiting(wait, timeline)}"
        yield f"  {name_of(wait.entity, timeline)} {waits}"


def what_runs(timeline: Timeline, now: Nanoseconds) -> Iterator[str]:
    """Yield which callback runs on which thread, and for how long already."""
    for span in timeline.moment(now).running.values():
        thread = timeline.threads.get(span.thread)
        where = "" if thread is None else f" on {thread.name}"
        yield f"{name_of(span.entity, timeline)} runs{where} for {duration(now - span.start)}"
