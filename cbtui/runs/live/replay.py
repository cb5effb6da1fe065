"""A recording on screen: its reader, its run, and the program that it shows."""

import threading
from pathlib import Path

from cbtui.engines.session import Deliver, Ended
from cbtui.runs.live.disk_space import DiskSpaceWatch
from cbtui.runs.live.live_export import ExportableRun
from cbtui.runs.live.live_recording import FinishFile
from cbtui.runs.live.live_run import SPEEDS, RunState, neighbouring_speed
from cbtui.runs.live.playhead import Playhead
from cbtui.runs.recorded.recording_file import date_text, setup_of
from cbtui.runs.setup.own_files import PROGRAMS
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.text.markdown import as_it_is
from lessons.catalogue import lessons
from sim.engine.setup import RunSetup
from sim.files.untrusted import read_text
from sim.recording import Recording, RecordingError, RecordingMetadata, read
from sim.trace.events import AnyEvent
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_BATCH = 2000
"""Events per batch: as many as the screen processes between two frames."""
_STOP_TIMEOUT = 0.4
"""Seconds to wait for the reader to stop."""

_LONGEST_SOURCE = 500_000
"""The longest source in bytes that is shown; recordings hold no longer ones."""
_GUIDE = """# Recording of {title}

{facts}

Every pane shows the moment that the status line tells.

- `space` plays it from here, from its beginning at its end; `+` and `-` change how fast.
- `[` and `]` go back and on, `,` and `.` by one event, `G` to a moment, `0` to the end.
- `left` and `right` show another stretch of time, and leave that moment.
"""


class RecordingReader:
    """Reads a recording on a thread of its own, on which ``deliver`` and ``ended`` are called.

    ``ended`` gets a sentence on the unreadable part of the recording, or None.
    """

    def __init__(self, recording: Recording, deliver: Deliver, ended: Ended) -> None:
        self._recording = recording
        self._deliver = deliver
        self._ended = ended
        self._stopping = threading.Event()
        self._reader = threading.Thread(target=self._read, name="recording-reader", daemon=True)

    def start(self) -> None:
        """Start reading."""
        self._reader.start()

    def stop(self) -> None:
        """Stop reading. Idempotent."""
        self._stopping.set()
        self._reader.join(_STOP_TIMEOUT)

    def _read(self) -> None:
        try:
            self._deliver_all()
        except RecordingError as error:
            self._ended(str(error))
        except OSError as error:
            self._ended(f"{self._recording.path} cannot be read to its end: {error.strerror}")
        else:
            damage = self._recording.damage
            self._ended(None if damage is None else f"{self._recording.path.name}: {damage}")

    def _deliver_all(self) -> None:
        waiting: list[AnyEvent] = []
        for events in self._recording.batches():
            waiting += events
            if len(waiting) >= _BATCH:
                self._deliver(waiting)
                waiting = []
            if self._stopping.is_set():
                return
        if waiting:
            self._deliver(waiting)


class RecordedRun:
    """A recorded run. It is played by moving the cursor; there is no engine.

    ``damage`` is a sentence on its unreadable part, once it has been read to its end.
    """

    alive = False
    asked = None
    recording = None
    can_be_paced = True
    speeds = SPEEDS[:-1]
    """The available playback speeds."""

    def __init__(self, recording: Recording, setup: RunSetup, deliver: Deliver, ended: Ended) -> None:
        self.setup = setup
        self.timeline = Timeline(until_ending=setup.until is not None)
        self.loss: str | None = None
        self.paused = True
        self.speed: float | None = 1.0
        self.damage: str | None = None
        self.is_read = False
        """Whether it has been read to its end."""
        self._path = recording.path
        self._disk_space = DiskSpaceWatch(self.timeline)
        self._reader = RecordingReader(recording, deliver, ended)

    @property
    def state(self) -> RunState:
        """Whether it is being played."""
        return RunState.REPLAY_STANDS if self.paused else RunState.REPLAY_PLAYS

    @property
    def virtual(self) -> bool:
        """Whether it ran on virtual time."""
        return self.setup.clock == "virtual"

    def start(self) -> None:
        """Start reading."""
        self._reader.start()

    def take(self, events: list[AnyEvent]) -> str | None:
        """Add events that were read."""
        self.timeline.extend(events)
        return self._disk_space.news(None, 0)

    def over(self, trouble: str | None) -> FinishFile | None:
        """Note that it has been read to its end; returns what reports the unreadable part, or None."""
        self.is_read = True
        self.damage = trouble
        return None if trouble is None else lambda: trouble

    def stop(self) -> None:
        """Stop reading."""
        self._reader.stop()

    def material(self) -> ExportableRun:
        """The whole recording, for an export."""
        return ExportableRun(self.setup.title, lambda: read(self._path).batches(), self.timeline.end)

    def pause(self) -> None:
        """Pause playback."""
        self.paused = True

    def resume(self) -> None:
        """Resume playback."""
        self.paused = False

    def change_speed(self, steps: int) -> None:
        """Go up (> 0) or down in ``speeds``."""
        self.speed = neighbouring_speed(self.speed, self.speeds, steps)

    def played(self, playhead: Playhead, elapsed: Nanoseconds) -> Playhead:
        """Advance a playhead by ``elapsed`` nanoseconds of real time; playback pauses at the end."""
        end = self.timeline.end
        moved = playhead.moved_to(playhead.now(end) + round(elapsed * (self.speed or 1.0)), end)
        if moved.at is None:
            self.paused = True
        return moved


def of_recording(recording: Recording) -> ShownProgram:
    """Return a recording as a program to show, with the recorded sources."""
    about = recording.about
    path, source = _source_of(recording)
    setup = setup_of(about) or RunSetup(title=about.title, programs=(), clock=about.clock or "virtual")
    title = _plain(about.title) or _plain(recording.path.name)
    return ShownProgram(
        heading=title,
        guide=_GUIDE.format(title=as_it_is(title), facts="\n".join(facts_on(recording))),
        node_path=path,
        service="" if setup.service is None else setup.service.name,
        executor="",
        set_up=lambda _threads, _speed: setup,
        source=source,
        sources=recording.sources,
        scene=next((lesson.scene for lesson in lessons() if lesson.id == about.title), ()),
    )


def _source_of(recording: Recording) -> tuple[Path, str]:
    """The first program's path and source; a placeholder if the source is neither recorded nor here."""
    names = [*recording.about.programs, *recording.sources]
    name = next((name for name in names if name in recording.sources), next(iter(names), ""))
    path = Path(_plain(name) or recording.path.name)
    if name in recording.sources:
        return path, recording.sources[name]
    return path, _program_text(path) or _NO_SOURCE


def _program_text(path: Path) -> str:
    """The source of a program that a recording names, if this machine has it; the name may be any file."""
    try:
        return read_text(path, _LONGEST_SOURCE, "replace") if path.suffix in PROGRAMS else ""
    except (OSError, ValueError):
        return ""


_NO_SOURCE = "# The recording holds no source of this program, and this machine has none.\n"


def facts_on(recording: Recording) -> list[str]:
    """Return the facts about a recorded run as a list in Markdown."""
    about = recording.about
    facts = [f"- file: {as_it_is(_plain(str(recording.path)))}"]
    if about.recorded:
        facts.append(f"- recorded: {date_text(about.recorded)} by cbtui {as_it_is(_plain(about.version))}")
    facts.append(f"- clock: {as_it_is(_plain(about.clock)) or 'unknown'}")
    facts.append(f"- threads: {_threads(about)}")
    facts += [f"- program: {as_it_is(_plain(program))}" for program in about.programs]
    if about.arguments:
        facts.append(f"- arguments: {as_it_is(_plain(' '.join(about.arguments)))}")
    return facts


def _threads(about: RecordingMetadata) -> str:
    return "the program's own number" if about.threads is None else str(about.threads)


def _plain(text: str) -> str:
    """A recorded text without unprintable characters."""
    return "".join(character for character in text if character.isprintable())
