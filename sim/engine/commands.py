"""The commands of the console to a running engine; each is recorded at the time at which it takes effect."""

from typing import TypeAlias

import msgspec


class Pause(msgspec.Struct, frozen=True, tag="pause"):
    """Stop time for every thread."""


class Resume(msgspec.Struct, frozen=True, tag="resume"):
    """Let time pass again."""


class SetSpeed(msgspec.Struct, frozen=True, tag="speed"):
    """Run ``speed`` seconds per real second; None: as fast as it can, which the real clock cannot."""

    speed: float | None


class Step(msgspec.Struct, frozen=True, tag="step"):
    """Continue to the next scheduling decision, and stop time there.

    A decision is the start, end, suspension or resumption of a callback, the arrival of a message, request or
    reply, or a jump of time. Virtual clock only.
    """


class RunUntil(msgspec.Struct, frozen=True, tag="run_until"):
    """Continue until everything up to ``moment`` (nanoseconds) has happened, and stop time there.

    Virtual time gets there as fast as possible, the real clock at its speed.
    """

    moment: int


class Choose(msgspec.Struct, frozen=True, tag="choose"):
    """Let the option with this index, from 0, continue where the run asks which thread does."""

    option: int


class CallService(msgspec.Struct, frozen=True, tag="call"):
    """Call a SetBool service from outside, as ``ros2 service call`` would; None: the program's first."""

    name: str | None
    data: bool


class RunLine(msgspec.Struct, frozen=True, tag="line"):
    """Carry out a ``ros2`` line; ``line`` is a number that the sender chooses and uses once."""

    line: int
    text: str


class InterruptLine(msgspec.Struct, frozen=True, tag="interrupt_line"):
    """End a running ``ros2`` line, as Ctrl-C would."""

    line: int


class CompleteLine(msgspec.Struct, frozen=True, tag="complete"):
    """Complete the word at ``cursor`` (characters from the beginning) of a ``ros2`` line."""

    line: int
    text: str
    cursor: int


class TerminalInput(msgspec.Struct, frozen=True, tag="type"):
    """Type text at the terminal of the run's programs; ``ends``: it is the last."""

    text: str
    ends: bool = False


class ResetWorld(msgspec.Struct, frozen=True, tag="reset_world"):
    """Put the robot back to its start, as a call of ``/reset_world`` would."""


class KeepContents(msgspec.Struct, frozen=True, tag="contents"):
    """Record the contents of published messages from now on, or no longer."""

    wanted: bool


class Stop(msgspec.Struct, frozen=True, tag="stop"):
    """End the run."""


PaceCommand: TypeAlias = Pause | Resume | SetSpeed | Step | RunUntil | Choose

InputCommand: TypeAlias = (
    CallService | RunLine | InterruptLine | TerminalInput | ResetWorld | KeepContents | Stop
)
"""Commands that change a run: repeated at the same moments, they produce the same events."""

WorldCommand: TypeAlias = InputCommand | CompleteLine

Command: TypeAlias = PaceCommand | WorldCommand

INTERRUPT = "\x03"
"""The character that ctrl+c types."""
END_OF_INPUT = "\x04"
"""The character that ctrl+d types: it submits an unfinished line; on an empty line it ends the input."""

_encoder = msgspec.msgpack.Encoder()
_decoder: msgspec.msgpack.Decoder[Command] = msgspec.msgpack.Decoder(Command)


def encode(command: Command) -> bytes:
    """Pack a command for the pipe."""
    return _encoder.encode(command)


def decode(packed: bytes) -> Command:
    """Unpack what ``encode`` packed.

    Raises:
        msgspec.DecodeError: the bytes are not a command.
    """
    try:
        return _decoder.decode(packed)
    except (UnicodeDecodeError, RecursionError) as error:
        raise msgspec.DecodeError(f"the bytes are no command: {error}") from None


_input_decoder: msgspec.json.Decoder[InputCommand] = msgspec.json.Decoder(InputCommand)


def input_text(command: InputCommand) -> str:
    """Return an input as JSON, as the trace and set-ups have it."""
    return msgspec.json.encode(command).decode()


def input_of(text: str) -> InputCommand:
    """Decode what ``input_text`` encoded.

    Raises:
        msgspec.DecodeError: the text is not an input that this version knows.
    """
    try:
        return _input_decoder.decode(text)
    except (UnicodeError, RecursionError) as error:
        raise msgspec.DecodeError(f"the text is no input: {error}") from None
