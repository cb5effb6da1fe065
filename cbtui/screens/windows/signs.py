"""The signs that lanes, factory and code draw, and what each means."""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from cbtui.looks.theme import GLYPHS, Charset
from cbtui.widgets.code.signs import CODE_SIGNS
from cbtui.widgets.factory.glyphs import FACTORY_GLYPHS
from sim.trace.events import Reason

MeaningRow: TypeAlias = tuple[str, str]
"""A sign, or several that belong together, and the meaning."""


class SignList(NamedTuple):
    """The signs of a pane under a heading."""

    heading: str
    rows: Sequence[MeaningRow]


def lane_signs(charset: Charset) -> SignList:
    """Return what the lanes draw."""
    glyphs = GLYPHS[charset]
    bar, line = glyphs.left[8], glyphs.line
    rows = [
        (
            f"{glyphs.left[1]} {glyphs.left[4]} {bar * 4}",
            "a callback runs; letter, colour and fill are its group's",
        ),
        (glyphs.textures, "the fills of long bars: groups A to F, then the same again"),
        (glyphs.hatch[Reason.GROUP_HELD] * 4, "a callback waits: another one holds its group"),
        (glyphs.hatch[Reason.NO_FREE_WORKER] * 4, "a callback waits: every thread is busy"),
        (glyphs.hatch[Reason.EVENT_QUEUE] * 4, "a callback waits: others came before it"),
        (glyphs.hatch[Reason.NOBODY_SPINS] * 4, "a callback waits: nobody spins its node"),
        (glyphs.blocked * 4, "a thread waits inside a callback: for a reply, a lock, an event"),
        (glyphs.inner, "a callback runs inside that of the bar, which spins"),
        (f"{glyphs.point} {line * 4}", "a callback holds its group, for a moment or for long; or runs"),
        (glyphs.double_line * 4, "several callbacks of a group run at once"),
        (glyphs.lost, "a message is lost: its queue was full"),
        (glyphs.cross, "a callback raised an exception"),
        ("excl reen", "a group's kind where names are short: exclusive, reentrant"),
        ("25% busy", "how much of the time on screen a thread was in a callback"),
        ("late !", "a timer was called later than its period says; ! for short"),
        (f"{glyphs.up} {glyphs.back}", "a service is called and replies; your own call has its key"),
        (glyphs.up, "what else you did: a reset, a ros2 command"),
        (glyphs.cursor, "the moment on screen, which every pane shows"),
        (f"{glyphs.now}now", "that moment on the axis"),
        (f"{line * 4} {glyphs.sleeps * 4}", "below a thread: its callback computes, or sleeps"),
        ("3/3!", "messages in a queue, and how many it takes; ! if it is full"),
        (glyphs.forth, "the lane that you chose"),
        (glyphs.heights[1::2], "the whole run: how many of the threads were busy"),
    ]
    return SignList("Signs of the lanes", rows)


def factory_signs(charset: Charset) -> SignList:
    """Return what the factory draws."""
    glyphs, shared = FACTORY_GLYPHS[charset], GLYPHS[charset]
    walled, opened, figure = glyphs.walled, glyphs.open, glyphs.figure
    rows = [
        (f"{glyphs.busy} {glyphs.idle}", "a worker, which is a thread: in a callback, or idle"),
        (figure.body, "the body of a worker, where there is room"),
        (glyphs.away, "the place of a worker that is away; a seat kept by a callback that awaits"),
        (shared.blocked, "a worker waits inside its callback: for a reply, a lock, an event"),
        (glyphs.busy.join(glyphs.seat), "the one seat of an area: a callback holds the group"),
        (glyphs.busy.join(glyphs.open_seat), "a seat of an area that is open to all"),
        (
            f"{glyphs.comes}{glyphs.busy} {glyphs.idle}{glyphs.leaves}",
            "a worker comes to a seat, or leaves it",
        ),
        (
            f"{walled.top_left}{walled.top}{walled.top_right} {walled.side}",
            "the walls of an area with one seat: an exclusive group",
        ),
        (
            f"{opened.top_left}{opened.top}{opened.top_right} {opened.side}",
            "an area that is open to all: a reentrant group, or no group",
        ),
        (glyphs.belt * 4, "the belt of a callback, which brings its messages"),
        (shared.back, "the belt of a client brings replies: it has the name of its service"),
        (glyphs.box, "messages that wait on a belt"),
        ("1.2s".join(glyphs.seat), "a message that waits on a belt, and its age"),
        (glyphs.slot, "a free place on a belt: room in the queue"),
        (glyphs.clock, "a timer, with its period"),
        (glyphs.tick, "a timer's next tick, on the way to the door"),
        (glyphs.door, "the end of a belt: the door to the area"),
        (shared.cross, "a callback waits at the door; the words beside it say why"),
    ]
    return SignList("Signs of the factory", rows)


def code_signs(charset: Charset) -> SignList:
    """Return what the margin of the code has."""
    waits = " ".join(GLYPHS[charset].hatch.values())
    rows = [
        (CODE_SIGNS.runs, "the callback of these lines runs"),
        (CODE_SIGNS.here, "a thread or a callback that awaits is at this line; how long, or on which thread"),
        (CODE_SIGNS.calls, "this line has called what runs or awaits"),
        (CODE_SIGNS.ran, "the callback has just run, on this thread"),
        (waits, "the callback waits, as on the lanes: group, threads, event queue, nobody spins"),
        ("A B", "the letter of the callback's group"),
        (CODE_SIGNS.fault, "this line ended the program"),
    ]
    return SignList("Signs of the code", rows)
