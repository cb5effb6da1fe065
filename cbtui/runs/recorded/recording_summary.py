"""The content of a recording, as plain text."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cbtui.runs.recorded.reading_progress import batches_with_progress
from cbtui.runs.recorded.recording_file import date_text, setup_of
from cbtui.runs.setup.changes import changes_in
from cbtui.text.output import complain, say, say_data, shown
from sim.export.summary_json import summary_json
from sim.quantities.durations import timestamp
from sim.recording import Recording, RecordingError, Topic, read
from sim.trace.events import AnyEvent, ContentsLost, EventsLost, RunEnded, RunEnding, RunStarted
from sim.trace.figures.chains_text import chain_report
from sim.trace.timeline import Timeline

_LABEL = "{:<11}{}\n"


def tell(path: Path, chains: Sequence[Sequence[str]] = (), *, as_json: bool = False) -> int:
    """Print the content of a recording and its chains, or with ``as_json`` its run's summary and diagnosis.

    Returns the exit code: 0 all can be read, 1 some of it, 2 nothing.
    """
    timeline = Timeline(until_ending=True) if chains or as_json else None
    try:
        recording = read(path)
        tally = _tally_of(recording, timeline)
        topics = recording.topics()
        size = path.stat().st_size
    except RecordingError as error:
        complain(str(error))
        return 2
    except OSError as error:
        complain(f"{path} cannot be read to its end: {error.strerror}")
        return 2
    if timeline is None or not as_json:
        say("".join(_lines(recording, tally, topics, size)))
    if timeline is not None and as_json:
        say_data(summary_json(timeline).decode())
    elif timeline is not None:
        say("".join(f"\n{chain_report(timeline, names)}" for names in chains))
    if recording.damage is not None:
        complain(f"{path}: {recording.damage}")
        return 1
    return 0


@dataclass
class _Tally:
    """Counts of one pass over the events."""

    events: int = 0
    last: int = 0
    lost: int = 0
    contents_lost: int = 0
    started: RunStarted | None = None
    told_to_end: RunEnding | None = None
    ended: RunEnded | None = None

    @property
    def length(self) -> int:
        """Nanoseconds of the run, without its program's own ending."""
        return self.last if self.told_to_end is None else self.told_to_end.t

    def take(self, events: list[AnyEvent]) -> None:
        """Count a batch."""
        self.events += len(events)
        for event in events:
            self.last = max(self.last, event.t)
            match event:
                case RunStarted():
                    self.started = event
                case RunEnding():
                    self.told_to_end = event
                case RunEnded():
                    self.ended = event
                case EventsLost(count=count):
                    self.lost = max(self.lost, count)
                case ContentsLost(count=count):
                    self.contents_lost = max(self.contents_lost, count)


def _tally_of(recording: Recording, timeline: Timeline | None) -> _Tally:
    tally = _Tally()
    for events in batches_with_progress(recording):
        tally.take(events)
        if timeline is not None:
            timeline.extend(events)
    return tally


def _lines(recording: Recording, tally: _Tally, topics: list[Topic], size: int) -> Iterator[str]:
    about = recording.about
    started = tally.started
    title = about.title or (started.target if started else "a run")
    clock = about.clock or (started.clock if started else "unknown")
    yield _line("run", f"{title}, {clock} clock")
    if started is not None and started.distro:
        yield _line("like", f"rclpy of {started.distro}")
    if about.recorded:
        yield _line("recorded", f"{date_text(about.recorded)} by cbtui {about.version}")
    for program in about.programs:
        yield _line("program", program + (", with its source" if program in recording.sources else ""))
    if about.arguments:
        yield _line("arguments", " ".join(about.arguments))
    changed = _changed(recording)
    if changed:
        yield _line("changed", changed)
    ending = "it was going on" if tally.ended is None else tally.ended.reason
    begun = started.known_from if started is not None else 0
    late = f", from {timestamp(begun)} of its run on" if begun else ""
    yield _line("lasts", f"{timestamp(tally.length - begun)}{late}; {ending}")
    yield _line("events", f"{tally.events:,}; the file has {size:,} bytes")
    if tally.lost:
        yield _line("lost", f"{tally.lost:,} events came too fast to be kept")
    if tally.contents_lost:
        yield _line("lost", f"{tally.contents_lost:,} messages came too fast for their contents to be kept")
    yield from _topic_lines(topics)


def _changed(recording: Recording) -> str:
    """The person's changes to the program, except its arguments."""
    setup = setup_of(recording.about)
    return "" if setup is None else changes_in(setup).words


def _topic_lines(topics: list[Topic]) -> Iterator[str]:
    if not topics:
        yield _line("topics", "none")
        return
    names = max(len(topic.name) for topic in topics)
    types = max(len(topic.type) for topic in topics)
    for place, topic in enumerate(sorted(topics, key=lambda topic: topic.name)):
        text = f"{topic.name:{names}}  {topic.type:{types}}  {topic.count:>9,}"
        yield _line("topics" if place == 0 else "", text)


def _line(label: str, text: str) -> str:
    return _LABEL.format(label, shown(text.replace("\n", " ")))
