"""What the console can tell a running engine; each is put on the trace at the run time it took effect."""

from typing import TypeAlias

import msgspec


class Pause(msgspec.Struct, frozen=True, tag="pause"):
    """Stop time for every thread."""


class Resume(msgspec.Struct, frozen=True, tag="resume"):
    """Let time go on."""


class SetSpeed(msgspec.Struct, frozen=True, tag="speed"):
    """Run ``speed`` seconds per real second; None: as fast as it can, which the real clock cannot."""

    speed: float | None


class Step(msgspec.Struct, frozen=True, tag="step"):
    """Go on to the next scheduling decision and let time stand there.

    That is where a callback begins, ends, leaves its thread or comes back to it, where a message, request or
    reply arrives, or where time has jumped. Virtual clock only.
    """


class RunUntil(msgspec.Struct, frozen=True, tag="run_until"):
    """Go on until all that happens up to ``moment`` (nanoseconds) has happened; let time stand there.

    Virtual time gets there as fast as it can, the real clock at its speed.
    """

    moment: int


class Choose(msgspec.Struct, frozen=True, tag="choose"):
    """Have the option with this index, from 0, go on where the run asks who is to."""

    option: int


class CallService(msgspec.Struct, frozen=True, tag="call"):
    """Call a SetBool service from outside, as ``ros2 service call`` would; None: the program's first."""

    name: str | None
    data: bool


class RunLine(msgspec.Struct, frozen=True, tag="line"):
    """Carry out a ``ros2`` line; ``line`` is a number of the sender's choice that no other line has."""

    line: int
    text: str


class InterruptLine(msgspec.Struct, frozen=True, tag="interrupt_line"):
    """End a ``ros2`` line that goes on, as Ctrl-C would."""

    line: int


class CompleteLine(msgspec.Struct, frozen=True, tag="complete"):
    """Tell what could stand at ``cursor`` (characters from the beginning) of a ``ros2`` line."""

    line: int
    text: str
    cursor: int


class TerminalInput(msgspec.Struct, frozen=True, tag="type"):
    """Type text at the terminal of the run's programs; with ``ends``, no more will come."""

    text: str
    ends: bool = False


class ResetWorld(msgspec.Struct, frozen=True, tag="reset_world"):
    """Put the robot back to its start, as a call of ``/reset_world`` would."""


class KeepContents(msgspec.Struct, frozen=True, tag="contents"):
    """Have what published messages hold on the trace from now on, or no longer."""

    wanted: bool


class Stop(msgspec.Struct, frozen=True, tag="stop"):
    """End the run."""


PaceCommand: TypeAlias = Pause | Resume | SetSpeed | Step | RunUntil | Choose

InputCommand: TypeAlias = (
    CallService | RunLine | InterruptLine | TerminalInput | ResetWorld | KeepContents | Stop
)
"""What changes a run: given again at the same moments, it brings about the same events."""

WorldCommand: TypeAlias = InputCommand | CompleteLine

Command: TypeAlias = PaceCommand | WorldCommand

INTERRUPT = "\x03"
"""What ctrl+c types."""
END_OF_INPUT = "\x04"
"""What ctrl+d types: it submits an unfinished line; on an empty line it ends the input."""

_encoder = msgspec.msgpack.Encoder()
_decoder: msgspec.msgpack.Decoder[Command] = msgspec.msgpack.Decoder(Command)


def encode(command: Command) -> bytes:
    """Pack a command for the pipe."""
    return _encoder.encode(command)


def decode(packed: bytes) -> Command:
    """Unpack what ``encode`` packed.

    Raises:
        msgspec.DecodeError: the bytes are no command.
    """
    try:
        return _decoder.decode(packed)
    except (UnicodeDecodeError, RecursionError) as error:
        raise msgspec.DecodeError(f"the bytes are no command: {error}") from None


_input_decoder: msgspec.json.Decoder[InputCommand] = msgspec.json.Decoder(InputCommand)


def input_text(command: InputCommand) -> str:
    """An input as the trace and set-ups have it: JSON."""
    return msgspec.json.encode(command).decode()


def input_of(text: str) -> InputCommand:
    """The input of which ``input_text`` made this text.

    Raises:
        msgspec.DecodeError: the text is no input that this version knows.
    """
    try:
        return _input_decoder.decode(text)
    except (UnicodeError, RecursionError) as error:
        raise msgspec.DecodeError(f"the text is no input: {error}") from None
