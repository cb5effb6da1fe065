"""Runs a program without the console: log to stderr, summary and diagnosis to stdout, events to files."""

from collections.abc import Sequence
from contextlib import ExitStack, closing, nullcontext
from pathlib import Path
from signal import Signals
from typing import TYPE_CHECKING

from cbtui.engines.follow import EngineLostError, FollowedRun, RunTimeoutError
from cbtui.engines.listening import ListeningSession
from cbtui.engines.session import PROGRAM_EXIT_TIMEOUT
from cbtui.runs.headless.deadlock_news import DeadlockNews
from cbtui.runs.headless.program_log import ProgramLog
from cbtui.runs.headless.standard_input import StandardInput
from cbtui.runs.judged.schedule_text import unplayed_text
from cbtui.runs.live.disk_space import DiskSpaceWatch
from cbtui.runs.setup.unmet_changes import UnmetChanges
from cbtui.terminal.interrupts import deferred_interrupt, ending_signals
from cbtui.text.output import CannotSayError, complain, say
from sim.diagnosis import Weight, diagnose, findings_text
from sim.engine.commands import Stop
from sim.engine.setup import Keyboard, RunSetup
from sim.quantities.durations import timestamp
from sim.trace.events import AnyEvent, CallbackStarted, NoticeKind
from sim.trace.figures.summary import summarise
from sim.trace.figures.summary_text import plain_text
from sim.trace.timeline import Timeline

if TYPE_CHECKING:
    from cbtui.runs.recorded.events_file import EventsFile
    from sim.recording import RecordingWriter


def run_headless(
    setup: RunSetup,
    *,
    events_path: str | None = None,
    summary_path: str | None = None,
    recording_path: str | None = None,
    replace_recording: bool = False,
    chains: Sequence[Sequence[str]] = (),
    fail_on_problem: bool = False,
) -> int:
    """Run a set-up to its end; returns the exit code.

    0: well, 1: failed, or with ``fail_on_problem`` a problem was found, 2: a file cannot be written, or a
    callback that was to be changed is not there.

    Ctrl-C, ``kill`` and a closed terminal end the run early; its summary is still printed and its recording
    finished, and the exit code is 128 plus the signal's number. A live keyboard reads this process's standard
    input. A recording replaces an existing file only with ``replace_recording``.
    """
    with ExitStack() as files:
        try:
            file = None if events_path is None else _events_file(Path(events_path))
        except OSError as error:
            complain(f"cannot write events to {events_path}: {error.strerror}")
            return 2
        if file is not None:
            files.callback(file.close)
        recorder: RecordingWriter | None = None
        if recording_path is not None:
            from cbtui.runs.recorded.recording_file import CannotRecordError, start_recording

            try:
                with deferred_interrupt():
                    recorder = start_recording(Path(recording_path), setup, replace=replace_recording)
                    files.callback(_close, recorder)
            except CannotRecordError as error:
                complain(str(error))
                return 2
        if file is not None:
            file.begin()
        try:
            run = _Headless(setup, file, recorder, chains)
            code = run.run()
            if fail_on_problem and run.has_problem:
                code = max(code, 1)
            if summary_path is None or code == 2:
                return code
            return max(code, run.save_summary(Path(summary_path)))
        except (BrokenPipeError, CannotSayError):
            raise  # warns about standard output, not about the run
        except OSError as error:
            complain(f"the run was cut short: {error.strerror}")
            return 1


class _Headless:
    """One run, followed on this thread."""

    def __init__(
        self,
        setup: RunSetup,
        file: "EventsFile | None",
        recorder: "RecordingWriter | None",
        chains: Sequence[Sequence[str]],
    ) -> None:
        self._setup = setup
        self._chains = chains
        self._run = FollowedRun(setup, ListeningSession)
        self._timeline = Timeline(until_ending=True)
        self._file = file
        self._recorder = recorder
        self._disk_space = DiskSpaceWatch(self._timeline)
        self._deadlocks = DeadlockNews(self._timeline) if setup.clock == "real" else None
        self._input = StandardInput(self._run.session.send) if setup.keyboard is Keyboard.LIVE else None
        self._log = ProgramLog(echo=self._input is None)
        self._signal: Signals | None = None
        self.has_problem = False
        self._has_changes = bool(setup.groups or setup.periods) and setup.real is None
        """Whether names of callbacks are still to be compared with those that there are."""

    def run(self) -> int:
        """Run to the end, then print the summary and the diagnosis, unless a change was not met."""
        keyboard = nullcontext() if self._input is None else closing(self._input)
        with self._run, keyboard, ending_signals(self._end_early):
            complaint = self._run.start()
            if complaint is not None:
                complain(complaint)
            loss = self._follow()
        self._log.finish()
        if not self._is_unmatched:
            say(plain_text(summarise(self._timeline)))
            findings = diagnose(self._timeline)
            self.has_problem = any(each.weight_in(self._timeline) is Weight.PROBLEM for each in findings)
            found = findings_text(findings, self._timeline)
            say(f"\n{found}" if found else "")
            self._tell_chains()
        if self._setup.seed and any(notice.unrepeatable for notice in self._timeline.notices):
            seed = self._setup.seed
            complain(f"this program is not repeatable: seed {seed} orders its threads, and nothing else")
        if unplayed := unplayed_text(self._setup.seed, self._timeline.choices):
            complain(unplayed)
        return self._verdict(loss) if self._signal is None else 128 + self._signal

    def save_summary(self, path: Path) -> int:
        """Write the summary of the ended run as JSON; returns 1 if that cannot be done, else 0."""
        from sim.export.summary_json import summary_json

        try:
            path.write_bytes(summary_json(self._timeline))
        except OSError as error:
            complain(f"cannot write the summary to {path}: {error.strerror}")
            return 1
        return 0

    def _tell_chains(self) -> None:
        if self._chains:
            from sim.trace.figures.chains_text import chain_report

            for names in self._chains:
                say(f"\n{chain_report(self._timeline, names)}")

    def _end_early(self, signal: Signals) -> None:
        """Stop the engine; its last events are still received."""
        self._signal = signal
        self._run.limit(PROGRAM_EXIT_TIMEOUT)
        self._run.session.send(Stop())

    def _follow(self) -> str | None:
        """Process every batch of events; returns a sentence if the engine was lost."""
        try:
            for events in self._run:
                with deferred_interrupt():
                    self._keep(events)
                sentences = () if self._deadlocks is None else self._deadlocks.news(events)
                self._log.print(events if self._deadlocks is None else self._deadlocks.without_told(events))
                self._compare_names(events)
                if self._input is not None:
                    self._input.follow(events)
                self._warn_of_full_disk()
                for sentence in sentences:
                    complain(sentence)
        except EngineLostError as error:
            return str(error)
        except RunTimeoutError:
            pass  # after a signal, if the engine does not exit
        return None

    def _compare_names(self, events: list[AnyEvent]) -> None:
        """Stop the run at its first callback if a change names none; the engine then tells which."""
        if self._has_changes and any(isinstance(each, CallbackStarted) for each in events):
            self._has_changes = False
            unmet = UnmetChanges(self._setup).now(self._timeline)
            if any(each.is_wrong for each in unmet):
                self._run.session.send(Stop())
            elif self._setup.clock == "real":  # else the end, where the engine tells, is near
                for each in unmet:
                    complain(each.sentence())

    @property
    def _is_unmatched(self) -> bool:
        return any(notice.kind is NoticeKind.UNMATCHED for notice in self._timeline.notices)

    def _warn_of_full_disk(self) -> None:
        if self._recorder is None:
            news = self._disk_space.news(None, 0)
        else:
            news = self._disk_space.news(self._recorder.path, self._recorder.size)
        if news is not None:
            complain(news)

    def _keep(self, events: list[AnyEvent]) -> None:
        if self._recorder is not None:
            self._recorder.take(events)
        self._timeline.extend(events)
        if self._file is not None:
            self._file.take(events)

    def _verdict(self, loss: str | None) -> int:
        if loss is not None:
            complain(f"{loss} at {timestamp(self._timeline.end)}; run it again")
            return 1
        ended = self._timeline.ended
        if ended is not None and ended.failed:
            if all(notice.text != ended.reason for notice in self._timeline.notices):
                complain(" ".join(ended.reason.split()))
            return 1
        return max(2 * self._is_unmatched, self._events_verdict(), self._recording_verdict())

    def _events_verdict(self) -> int:
        if self._file is None:
            return 0
        self._file.close()
        if self._file.failure is not None:
            complain(f"the events in the file are not whole: {self._file.failure}")
            return 1
        return 0

    def _recording_verdict(self) -> int:
        if self._recorder is None:
            return 0
        if self._timeline.contents_lost:
            complain(
                f"{self._timeline.contents_lost} messages came faster than they could be recorded; "
                "the recording tells that they were sent, not what they held"
            )
        _close(self._recorder)
        if self._recorder.failure is not None:
            complain(f"the recording is not whole: {self._recorder.failure}")
            return 1
        return 0


def _events_file(path: Path) -> "EventsFile":
    from cbtui.runs.recorded.events_file import EventsFile

    return EventsFile(path)


def _close(recorder: "RecordingWriter") -> None:
    """Finish a recording even if Ctrl-C is pressed meanwhile."""
    with deferred_interrupt():
        recorder.close()
