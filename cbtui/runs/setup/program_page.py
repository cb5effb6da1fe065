"""The guide to a learner's own file as Markdown: what was found in its run, and what to try."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from itertools import islice

from cbtui.runs.setup.changeable import is_set_bool, programs_own
from cbtui.runs.setup.unmet_changes import UnmetChange
from cbtui.text.markdown import as_it_is
from sim.diagnosis import Explanation, with_stop
from sim.quantities.durations import duration
from sim.quantities.plural import counted, plural
from sim.trace.descriptions import executor_label, executor_made, silent_topics
from sim.trace.events import EntityKind, NodeId, Reason
from sim.trace.model import EntityInfo
from sim.trace.timeline import Timeline

MOST = 20
"""The most nodes, groups, and callbacks of one group that are listed: a program may create any number."""

_ABOUT = """# {name}

Your own file, on {clock} time. Save it, and it runs again; `o` opens it in your editor.
"""
_SIGNS = """## What you see

Every thread that runs callbacks has a lane; below are the callback groups, in the order in which the program
fills them, with what waits in them and why. `?` explains each sign.
"""


def page_of_program(
    name: str,
    clock: str,
    timeline: Timeline,
    problems: Sequence[Explanation] = (),
    *,
    has_cures: bool = False,
    unmet: Sequence[UnmetChange] = (),
) -> Mapping[str, str]:
    """Return the sections of the page; ``problems`` are what went wrong, the worst first.

    ``has_cures``: whether the first problem has cures that can be tried; ``unmet`` are changes for callbacks
    that there are not.
    """
    tries = "\n".join(f"- {line}" for line in _tries(timeline, problems, has_cures=has_cures))
    return {
        "about": _ABOUT.format(name=name, clock=clock),
        "found": f"## What was found\n\n{_found(timeline, unmet)}\n",
        "tries": f"## What to try\n\n{tries}\n",
        "signs": _SIGNS,
    }


def unspun_nodes(timeline: Timeline) -> Set[NodeId]:
    """Return the nodes with a callback that waits now as nobody spins them."""
    waits = timeline.moment(timeline.end).waiting.values()
    return {timeline.entities[each.entity].node for each in waits if each.reason is Reason.NOBODY_SPINS}


def nodes_spun(timeline: Timeline, unspun: Set[NodeId]) -> Mapping[NodeId, str]:
    """Return what is known of who spins the first nodes."""
    return {node: _spun(node, unspun, timeline) for node in islice(timeline.nodes, MOST)}


def _spun(node: NodeId, unspun: Set[NodeId], timeline: Timeline) -> str:
    """In which executor a node's callbacks ran last; one without workers uses the thread that spins it."""
    if not timeline.executors:
        return "in no executor yet"
    if node not in timeline.ran_on:
        return "spun by nobody so far" if node in unspun else "of which nothing has run so far"
    thread = timeline.threads.get(timeline.ran_on[node])
    pools = {each.executor for each in timeline.threads.values()}
    known = timeline.executors.get(thread.executor) if thread else None
    spinning = [known] if known else [each for each in timeline.executors.values() if each.id not in pools]
    return f"in {' or '.join(dict.fromkeys(map(executor_made, spinning))) or executor_label(timeline)}"


def _found(timeline: Timeline, unmet: Sequence[UnmetChange]) -> str:
    """The nodes with their executors, and the groups with their callbacks; what was to be changed in vain."""
    if not timeline.nodes:
        ended = timeline.ended
        return "No node yet: the program starts." if ended is None else f"It made no node: {ended.reason}"
    states = nodes_spun(timeline, unspun_nodes(timeline))
    more = ", …" if len(timeline.nodes) > len(states) else ""
    lines = []
    for state in dict.fromkeys(states.values()):
        alike = [f"``{timeline.nodes[node]}``" for node, its in states.items() if its == state]
        lines.append(f"- {plural(len(alike), 'node')} {_listed(iter(alike))}{more}, {state}")
    for group in islice(timeline.groups.values(), MOST):
        own = _listed(_callback(each) for each in timeline.group_members(group.id) if programs_own(each))
        if own:
            lines.append(f"- group {group.letter}, {group.kind.value}: {own}")
    lines += (f"- {each.sentence('``')}: nothing is changed there" for each in unmet)
    return "\n".join(lines)


def _listed(names: Iterator[str]) -> str:
    listed = list(islice(names, MOST + 1))
    counts = Counter(listed[:MOST])
    each = (f"{name} × {count}" if count > 1 else name for name, count in counts.items())
    return ", ".join([*each, *(["…"] if len(listed) > MOST else [])])


def _callback(entity: EntityInfo) -> str:
    match entity.kind:
        case EntityKind.TIMER:
            return f"``{entity.spoken_name}`` every {duration(entity.period)}"
        case EntityKind.CLIENT:
            return f"client of ``{entity.name}``"
        case _ if entity.name and entity.callback:
            return f"``{entity.function}`` for ``{entity.name}``"
    return f"``{entity.spoken_name}``"


def _tries(timeline: Timeline, problems: Sequence[Explanation], *, has_cures: bool) -> Iterator[str]:
    """Suggestions for this program, the most useful first."""
    own = [each for each in timeline.entities.values() if programs_own(each)]
    if problems:
        more = f", and {counted(len(problems) - 1, 'further problem')}" if len(problems) > 1 else ""
        line = "" if problems[0].place is None else "its line and "
        what = "tries a cure" if has_cures else "says what to do"
        yield f"{with_stop(as_it_is(problems[0].what))} `d` {line and 'shows '}{line}{what}{more}."
    unspun = unspun_nodes(timeline)
    answers = timeline.ended is None and timeline.executors  # nothing does before a spin and after the end
    met = [each for each in own if each.node not in unspun] if answers else []
    services = [each for each in met if each.kind is EntityKind.SERVICE]
    calls = next((each.name for each in services if is_set_bool(each)), None)
    if calls is not None:
        yield f"`s` calls ``{calls}`` with true, `S` with false."
    elif services:
        service = services[0]
        yield (
            f"`:` and ``ros2 service call {service.name} {service.interface_type}`` call its service; "
            "`tab` completes the rest."
        )
    if met and (silent := silent_topics(timeline)):
        yield (
            f"Nothing has come on ``{silent[0]}`` yet: `:` and ``ros2 topic pub {silent[0]}``; "
            "`tab` completes the rest."
        )
    if own:
        yield (
            "`t` gives the executor other threads, `g` the selected callback another group, `p` timers other "
            "periods: each runs it again and tells the line of code that does so; `C` compares both runs."
        )
    if timeline.arena is None:
        yield "`r` runs it again. The lessons' robot comes when your file uses ``/odom`` or ``/cmd_vel``."
    else:
        yield "`r` puts the robot back to its start, and runs the file again when it is over."
