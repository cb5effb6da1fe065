"""Source code that is equivalent to a person's changes at the keyboard."""

from collections.abc import Iterator

from cbtui.runs.setup.changeable import ChangeableSetup
from cbtui.runs.setup.changes import CallbackPlace, Changes
from sim.quantities.nanoseconds import SECOND
from sim.releases.distros import COMPARED_DISTROS
from sim.releases.profile import Profile
from sim.trace.events import EntityKind

_EXCLUSIVE = "MutuallyExclusiveCallbackGroup()"
_REENTRANT = "ReentrantCallbackGroup()"
_SOME_MAKER = "self.create_…(…, {}, …"
_MAKERS = {
    EntityKind.TIMER: "self.create_timer(…, {}",
    EntityKind.SUBSCRIPTION: "self.create_subscription(…, {}, …",
    EntityKind.SERVICE: "self.create_service(…, {}",
    EntityKind.CLIENT: "self.create_client(…, {}",
    EntityKind.GUARD: "self.create_guard_condition({}",
}


def code_of(changes: Changes, about: ChangeableSetup) -> list[str]:
    """Return the statements for all changes, some of several lines."""
    kinds = {callback.place: callback.kind for callback in about.callbacks}
    statements = [
        statement
        for place, wish in changes.groups.items()
        for statement in code_of_group(place[1], _kind(place, kinds), wish)
    ]
    statements += [code_of_period(place[1], period) for place, period in changes.periods.items()]
    statements += _command_line(changes, about)
    if changes.threads is not None and about.threads_argument is None:
        statements.append(code_of_threads(changes.threads, about))
    if changes.sensor_rate is not None:
        statements.append(code_of_sensor_rate(changes.sensor_rate))
    if changes.distro is not None:
        statements.append(code_of_release(changes.distro))
    return list(dict.fromkeys(statements))


def code_of_cure(changes: Changes, about: ChangeableSetup) -> list[str]:
    """Return the statements for all changes; for threads, also those that spin the new executor."""
    statements = code_of(changes, about)
    if changes.threads is not None and about.threads_argument is None:
        is_spun = about.executor_now.startswith("MultiThreadedExecutor")
        statements += [] if is_spun else ["executor.add_node(node)", "executor.spin()"]
    return statements


def code_of_threads(threads: int, about: ChangeableSetup) -> str:
    """Return the line that gives the executor a number of threads."""
    if about.threads_argument is not None:
        return code_of_argument(about.threads_argument, threads)
    return f"executor = MultiThreadedExecutor(num_threads={threads})"


def code_of_period(callback: str, period: int) -> str:
    """Return the line that makes a timer with a period in nanoseconds."""
    return f"self.create_timer({period / SECOND:g}, {_method(callback)}, …)"


def code_of_argument(argument: str, number: float) -> str:
    """Return the command line that passes a number to a program."""
    return f"node.py … {argument} {number:g}"


def code_of_sensor_rate(rate: float) -> str:
    """Return a comment instead of code: the sensors are not part of the program."""
    return f"# no line of the node: the robot's sensors measure {rate:g} times a second"


def code_of_release(release: str) -> str:
    """Return the line that makes a file run as on a release, and the sources of that release's behaviour."""
    was_run = Profile.named(release).distro in COMPARED_DISTROS
    caveat = "" if was_run else "\n# it follows documentation and source, not runs"
    return f"# cbtui: distro = {release}{caveat}"


def code_of_group(callback: str, kind: EntityKind, wish: str) -> list[str]:
    """Return the statements that put a callback into a group; a waitable's are generic."""
    what = f'"{callback}"' if kind is EntityKind.CLIENT else _method(callback)
    making = _MAKERS.get(kind, _SOME_MAKER).format(what)
    match wish:
        case "default":
            return [f"{making})  # no group named"]
        case "own":
            name, made = f"self.{_group_name(callback)}", _EXCLUSIVE
        case "shared":
            name, made = "self.shared_group", _EXCLUSIVE
        case _:
            name, made = "self.reentrant_group", _REENTRANT
    return [f"{name} = {made}", f"{making},\n    callback_group={name})"]


def _command_line(changes: Changes, about: ChangeableSetup) -> Iterator[str]:
    given = dict(changes.settings)
    if changes.threads is not None and about.threads_argument is not None:
        given[about.threads_argument] = changes.threads
    if given:
        yield "node.py … " + " ".join(f"{name} {number:g}" for name, number in given.items())


def _kind(place: CallbackPlace, kinds: dict[CallbackPlace, EntityKind]) -> EntityKind:
    """The kind of a callback's entity: of a node, or of the first node with such a callback."""
    node, name = place
    fitting = (kind for (owner, callback), kind in kinds.items() if callback == name and node in {"", owner})
    return next(fitting, EntityKind.WAITABLE)


def _method(callback: str) -> str:
    return f"self.{callback}" if callback.isidentifier() else "…"


def _group_name(callback: str) -> str:
    word = callback.rsplit("/", 1)[-1].removesuffix("_callback")
    return f"{word}_group" if word.isidentifier() else "own_group"
