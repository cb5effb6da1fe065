"""Repeats a recorded run: its set-up, or another program's, with the recorded inputs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import msgspec

from cbtui.runs.recorded.reading_progress import batches_with_progress
from cbtui.runs.recorded.recording_file import setup_of
from cbtui.runs.setup.lesson_setup import RunRequest
from sim.engine.inputs import UnknownInputError, inputs_of, stops
from sim.engine.setup import Keyboard, RobotUse, RunSetup
from sim.files.untrusted import MAX_PROGRAM_BYTES, read_bytes
from sim.quantities.nanoseconds import nearest_ns
from sim.recording import Recording, RecordingError, read
from sim.trace.events import AnyEvent, Notice, RunEnded


def why_unrepeatable(events: Iterable[AnyEvent]) -> str | None:
    """Return why no other run will be exactly the same, in the engine's words; None if there is no known
    reason.
    """
    return next((each.text for each in events if isinstance(each, Notice) and each.unrepeatable), None)


class CannotRepeatError(Exception):
    """A recording cannot be repeated; the text is a sentence that says why."""


def repeated_setup(path: Path, request: RunRequest, *, tell: Callable[[str], None]) -> RunSetup:
    """The set-up of a run that gets the inputs of a recorded one instead of its own.

    The recorded program runs again if the request names none. Its ``seconds`` None: as long as the recording.
    ``tell`` gets a sentence if inputs may be missing, or if the repetition will not be exact.

    Raises:
        CannotRepeatError: the recording cannot be read, was made on the real clock, lacks its set-up, or its
            program is not there any more, or not as it was.
    """
    try:
        recording = read(path)
        known = _RecordedFacts()
        inputs = inputs_of(map(known.seen, chain.from_iterable(batches_with_progress(recording))))
    except (RecordingError, UnknownInputError) as error:
        raise CannotRepeatError(str(error)) from None
    except OSError as error:
        raise CannotRepeatError(f"{path} cannot be read to its end: {error.strerror}") from None
    if recording.damage is not None:
        tell(f"{path}: {recording.damage}")
    recorded = setup_of(recording.about)
    if recorded is None:
        raise CannotRepeatError(f"{path} does not tell how its run was set up, so it cannot be repeated")
    if recorded.clock != "virtual":
        raise CannotRepeatError(f"{path} is of a real-clock run; only virtual runs can be repeated exactly")
    if not request.names_program:
        _check_programs(recorded, recording)
        if known.unrepeatable:
            why = known.unrepeatable
            tell(f"{path} is of a program that is not repeatable ({why}); it is run again all the same")
    if request.seconds is None:
        until = recorded.until if recorded.until is not None or known.ended else known.last
    else:
        until = nearest_ns(request.seconds)
        inputs = tuple(each for each in inputs if not stops(each))
    return msgspec.structs.replace(
        request.setup() if request.names_program else _again(recorded, request),
        clock="virtual",
        until=until,
        calls=recorded.calls,
        lines=recorded.lines,
        typed=recorded.typed,
        keyboard=Keyboard.NOBODY if recorded.keyboard is Keyboard.NOBODY else Keyboard.REPEATED,
        inputs=inputs,
        contents=recorded.contents or request.contents,
    )


def _again(recorded: RunSetup, request: RunRequest) -> RunSetup:
    """The recorded program, run as requested."""
    robot = recorded.robot if request.robot else RobotUse.NEVER
    return msgspec.structs.replace(request.changes.applied(recorded), speed=request.speed, robot=robot)


@dataclass
class _RecordedFacts:
    """Facts about a recorded run, collected from its events."""

    last: int = 0
    """The latest time of the recording, in nanoseconds."""
    ended: bool = False
    """Whether the run ended by then."""
    unrepeatable: str | None = None
    """Why no other run will be exactly the same."""

    def seen(self, event: AnyEvent) -> AnyEvent:
        """Collect the facts of an event."""
        self.last = max(self.last, event.t)
        self.ended = self.ended or isinstance(event, RunEnded)
        self.unrepeatable = self.unrepeatable or why_unrepeatable([event])
        return event


def _check_programs(recorded: RunSetup, recording: Recording) -> None:
    for program in (each for each in recorded.programs if each.path not in recorded.texts):
        path = Path(program.path)
        try:
            content = read_bytes(path, MAX_PROGRAM_BYTES)
        except OSError:
            sentence = (
                f"the recorded program {path} is not there any more; name the file that is to run instead"
            )
            raise CannotRepeatError(sentence) from None
        known = recording.sources.get(program.path)
        if known is not None and known.encode() != content:
            sentence = (
                f"{path} has changed since it was recorded; name it behind the options to run it as it is"
            )
            raise CannotRepeatError(sentence)
