"""Source code that is equivalent to a person's changes at the keyboard."""

import re
from collections.abc import Iterator
from pathlib import Path

from cbtui.runs.setup.changeable import ChangeableSetup
from cbtui.runs.setup.changes import CallbackPlace, Changes
from cbtui.text.callback_names import short_name
from sim.diagnosis.edits.code_edit import diff
from sim.files.untrusted import program_text
from sim.quantities.nanoseconds import SECOND
from sim.releases.distros import COMPARED_DISTROS
from sim.releases.profile import Profile
from sim.trace.events import EntityKind

_EXCLUSIVE = "MutuallyExclusiveCallbackGroup()"
_REENTRANT = "ReentrantCallbackGroup()"
_SOME_MAKING = "create_…(…, {}, …"
_MAKING = {
    EntityKind.TIMER: "create_timer(…, {}",
    EntityKind.SUBSCRIPTION: "create_subscription(…, {}, …",
    EntityKind.SERVICE: "create_service(…, {}",
    EntityKind.CLIENT: "create_client(…, {}",
    EntityKind.GUARD: "create_guard_condition({}",
}
_MODULES = {
    "MutuallyExclusiveCallbackGroup": "rclpy.callback_groups",
    "MultiThreadedExecutor": "rclpy.executors",
}


def code_of(changes: Changes, about: ChangeableSetup) -> list[str]:
    """Return the statements for all changes, some of several lines."""
    statements = [
        statement
        for place, wish in changes.groups.items()
        for statement in code_of_group(*_callback_of(place, about), wish)
    ]
    for place, period in changes.periods.items():
        name, _, maker = _callback_of(place, about)
        statements.append(code_of_period(name, period, maker))
    statements += _command_line(changes, about)
    if changes.threads is not None and about.threads_argument is None:
        statements.append(code_of_threads(changes.threads, about))
    if changes.sensor_rate is not None:
        statements.append(code_of_sensor_rate(changes.sensor_rate))
    if changes.distro is not None:
        statements.append(code_of_release(changes.distro))
    return list(dict.fromkeys(statements))


def edits_of(changes: Changes) -> Iterator[str]:
    """Yield a comment on each file of which an edited copy is run, and how the copy differs from the file."""
    for file, text in changes.texts.items():
        name = Path(file).name
        yield f"# an edited copy of {name} is run, {name} is unchanged; to take it over, write these lines:"
        yield diff(file, program_text(Path(file)) or "", text)


def code_of_cure(changes: Changes, about: ChangeableSetup, source: str = "") -> list[str]:
    """Return the statements for all changes, with the imports that ``source`` lacks.

    For threads, those that spin the new executor are among them.
    """
    statements = code_of(changes, about)
    if changes.threads is not None and about.threads_argument is None:
        is_spun = about.executor_now.startswith("MultiThreadedExecutor")
        statements += [] if is_spun else ["executor.add_node(node)", "executor.spin()"]
    needed = [name for name in _MODULES if any(name in each for each in statements)]
    lacking = [name for name in needed if not re.search(rf"import\b[^=.:]*\b{name}\b", source)]
    return [f"from {_MODULES[name]} import {name}" for name in lacking] + statements


def code_of_threads(threads: int, about: ChangeableSetup) -> str:
    """Return the line that gives the executor a number of threads."""
    if about.threads_argument is not None:
        return code_of_argument(about.threads_argument, threads)
    return f"executor = MultiThreadedExecutor(num_threads={threads})"


def code_of_period(callback: str, period: int, maker: str) -> str:
    """Return the line in which ``maker`` makes a timer with a period in nanoseconds."""
    return f"{maker}.create_timer({period / SECOND:g}, {_function(callback, maker)}, …)"


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


def code_of_group(callback: str, kind: EntityKind, maker: str, wish: str) -> list[str]:
    """Return the statements in which ``maker`` puts a callback into a group; a waitable's are generic."""
    what = f'"{callback}"' if kind is EntityKind.CLIENT else _function(callback, maker)
    making = f"{maker}.{_MAKING.get(kind, _SOME_MAKING).format(what)}"
    match wish:
        case "default":
            return [f"{making})  # no group named"]
        case "own":
            name, made = _group_name(callback), _EXCLUSIVE
        case "shared":
            name, made = "shared_group", _EXCLUSIVE
        case _:
            name, made = "reentrant_group", _REENTRANT
    name = f"{_owner(maker)}{name}"
    return [f"{name} = {made}", f"{making},\n    callback_group={name})"]


def _command_line(changes: Changes, about: ChangeableSetup) -> Iterator[str]:
    given = dict(changes.settings)
    if changes.threads is not None and about.threads_argument is not None:
        given[about.threads_argument] = changes.threads
    if given:
        yield "node.py … " + " ".join(f"{name} {number:g}" for name, number in given.items())


def _callback_of(place: CallbackPlace, about: ChangeableSetup) -> tuple[str, EntityKind, str]:
    """The full name, kind and maker of a callback: of a node, or of the first that has such a one."""
    node, name = place
    fitting = (
        (each.name, each.kind, each.maker)
        for each in about.callbacks
        if name in {each.name, short_name(each.name)} and node in {"", each.place[0]}
    )
    return next(fitting, (name, EntityKind.WAITABLE, "self"))


def _owner(maker: str) -> str:
    """What methods and attributes are named by where ``maker`` makes a callback; "" outside a class."""
    return "self." if maker.partition(".")[0] == "self" else ""


def _function(callback: str, maker: str) -> str:
    return f"{_owner(maker)}{callback}" if callback.isidentifier() else "…"


def _group_name(callback: str) -> str:
    word = callback.rsplit("/", 1)[-1].removesuffix("_callback")
    return f"{word}_group" if word.isidentifier() else "own_group"
