"""What a run is set up with: the program, its clock, its robot and the inputs it is to get."""

import msgspec


class ServiceChoice(msgspec.Struct, frozen=True):
    """The SetBool service that the call key fires."""

    name: str
    type: str


class TimedCall(msgspec.Struct, frozen=True):
    """A SetBool call to be made at ``at`` nanoseconds with ``data``."""

    at: int
    data: bool


class RunSetup(msgspec.Struct, frozen=True, kw_only=True):
    """All that an engine needs to know to run one program.

    ``speed`` is virtual seconds per real second, None for as fast as it can; the real clock ignores it.
    ``until`` is nanoseconds of run time after which the run ends, None for no end. ``threads`` replaces
    the number of threads of the program's executor, None leaves the program's own. ``service`` None means
    the program's first SetBool service.
    """

    title: str
    node_path: str
    arguments: tuple[str, ...] = ()
    service: ServiceChoice | None = None
    clock: str = "virtual"
    speed: float | None = 1.0
    until: int | None = None
    threads: int | None = None
    calls: tuple[TimedCall, ...] = ()
    robot: bool = True
