"""Keys that take what is on screen elsewhere."""

from collections.abc import Iterator

from cbtui.screens.lesson.selecting import SelectingScreen
from cbtui.text.durations import duration
from cbtui.widgets.diagnosis import call_note, diagnose
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.details import details_of_selection
from sim.trace.descriptions import executor_label, name_of, why_waiting
from sim.trace.model import Nanoseconds


class TakingScreen(SelectingScreen):
    """Copies what is selected, or else what the moment on screen means, as plain text."""

    def action_copy_details(self) -> None:
        """Put it into the terminal's clipboard (OSC 52, which works over ssh)."""
        timeline = self._run.timeline
        now = self._playhead.now(timeline.end)
        selection = self.query_one(Lanes).selection
        if selection is None:
            lines = list(self._summary(now))
            what = f"the moment {now / 1e9:.3f} s"
        else:
            details = details_of_selection(
                timeline, selection.renewed(timeline), now, self.query_one(Lanes).keys
            )
            lines = [details.title, *(f"  {fact}" for fact in details.facts)]
            what = details.title
        self.app.copy_to_clipboard("\n".join(lines))
        self._tell(f"copied {what}")

    def _summary(self, now: Nanoseconds) -> Iterator[str]:
        """Say what the moment means, who runs and who waits for what."""
        timeline = self._run.timeline
        label = executor_label(timeline)
        yield f"{self._subject.heading}, t {now / 1e9:.3f} s" + (f", {label}" if label else "")
        yield diagnose(timeline, now, self._concurrency).text
        note = call_note(timeline, now)
        if note:
            yield note
        moment = timeline.moment(now)
        for span in moment.running.values():
            thread = timeline.threads.get(span.thread)
            where = "" if thread is None else f" on {thread.name}"
            yield f"  {name_of(span.entity, timeline)} runs{where} for {duration(now - span.start)}"
        for wait in moment.waiting.values():
            took = duration(max(0, now - wait.since))
            yield f"  {name_of(wait.entity, timeline)} waits {took}: {why_waiting(wait, timeline)}"
