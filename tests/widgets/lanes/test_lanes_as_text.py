"""Lanes of everything that can happen, as plain text in ``goldens`` beside this file.

``pytest --accept-pictures`` keeps them as they are drawn now.
"""

from collections.abc import Callable

import pytest

from cbtui.looks.theme import Charset
from cbtui.widgets.lanes import LanePainter
from sim.trace.events import Reason
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.goldens import LANES, hold
from tests.widgets.pictures import plain, shared_group, told


def everything() -> Timeline:
    """Two threads, three groups: waits of every reason, losses, a late tick, calls, keys, an exception."""
    run = Run()
    threads = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(2)]
    run.executor("MultiThreadedExecutor", 2)
    node = run.node("/node")
    shared, own, open_ = run.exclusive(node), run.exclusive(node), run.reentrant(node)
    turn = run.timer(shared, "turn_callback", 4.0)
    odom = run.subscription(shared, "/odom", "odom_callback", depth=3)
    scan = run.subscription(own, "/scan", "scan_callback", depth=3)
    power = run.service(open_, "/motor_power", "power_callback")
    reply = run.client(open_, "/motor_power")
    run.command("speed x2", 0.5)
    run.due(turn, 1.0)
    run.callback(turn, threads[0], 1.0, 5.0)
    call = run.call("/motor_power", 2.0, 3.5, entity=turn)
    run.blocked(call, "/motor_power", threads[0], turn, 2.0, 3.5)
    run.request(power, 2.0)
    run.callback(power, threads[1], 2.0, 1.5)
    run.request(reply, 3.5)
    run.callback(reply, threads[1], 3.5, 0.1)
    for tick in range(6):
        run.message(odom, 1.5 + 0.5 * tick)
    run.wait(odom, 1.5, 6.0, holder=turn)
    run.callback(odom, threads[0], 6.0, 0.2)
    run.message(scan, 2.5)
    run.wait(scan, 2.5, 3.6, Reason.NO_FREE_WORKER, turn, workers_busy=True)
    run.start(scan, threads[1], 3.6)
    run.fail(scan, threads[1], 4.4, "IndexError: 720")
    run.end(scan, threads[1], 4.4)
    run.due(turn, 5.0)
    run.wait(turn, 5.0, 6.2, holder=turn)
    run.callback(turn, threads[0], 6.2, 0.3, late=1.2)
    run.message(scan, 7.0)
    run.wait(scan, 7.0, None, Reason.NOBODY_SPINS)
    run.stop(10.0)
    return told(run)


PICTURES: dict[str, Callable[[], str]] = {
    "lanes-everything-80.txt": lambda: picture(everything(), 80),
    "lanes-everything-140.txt": lambda: picture(everything(), 140),
    "lanes-everything-ascii.txt": lambda: picture(everything(), 100, Charset.ASCII),
    "lanes-10-minutes.txt": lambda: picture(shared_group(), 80, start=-570.0, end=30.0),
    "lanes-1-ms.txt": lambda: picture(shared_group(), 80, start=24.0, end=24.001),
}


def picture(
    timeline: Timeline,
    width: int,
    charset: Charset = Charset.BRAILLE,
    start: float = 0.0,
    end: float = 10.0,
) -> str:
    text = plain(LanePainter(charset).paint(timeline, Window(ns(start), ns(end)), ns(end), width, 14).rows)
    return "".join(f"{line.rstrip()}\n" for line in text.splitlines())


@pytest.mark.parametrize("name", PICTURES)
def test_lanes_look_as_they_did(name: str, pytestconfig: pytest.Config) -> None:
    hold({name: PICTURES[name]()}, LANES, pytestconfig)
