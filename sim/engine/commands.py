"""What the console can tell a running engine; each is put on the trace at the run time it took effect."""

from typing import TypeAlias

import msgspec


class Pause(msgspec.Struct, frozen=True, tag="pause"):
    """Stop time for every thread."""


class Resume(msgspec.Struct, frozen=True, tag="resume"):
    """Let time go on."""


class SetSpeed(msgspec.Struct, frozen=True, tag="speed"):
    """Run ``speed`` virtual seconds per real second; None: as fast as it can."""

    speed: float | None


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


class ResetWorld(msgspec.Struct, frozen=True, tag="reset_world"):
    """Put the robot back to its start, as a call of ``/reset_world`` would."""


class Stop(msgspec.Struct, frozen=True, tag="stop"):
    """End the run."""


Command: TypeAlias = (
    Pause | Resume | SetSpeed | CallService | RunLine | InterruptLine | CompleteLine | ResetWorld | Stop
)

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
    return _decoder.decode(packed)
