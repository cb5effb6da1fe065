"""Runs of the lessons as the engine would record them, written by hand for tests of whatever shows a run."""

import math
from dataclasses import dataclass
from functools import cache, wraps
from typing import Protocol

import numpy as np

from sim.trace.events import EntityId, Reason, Severity, ThreadId
from tests.support.builder import Run

TICK = 0.05
ODOM_AFTER = 0.003
SCAN_AFTER = 0.006
PERIOD = 0.5
SPEED = 0.08
TURN = -0.2
SPHERE = (0.95, 0.0)
SPHERE_RADIUS = 0.2
WALL = 6.5
BEAMS = 720
REPLY = "SetBool_Response(success=True, message='{}')"


@dataclass(frozen=True, slots=True)
class _Seats:
    """Who runs where in a run of the robot node."""

    odom: EntityId
    scan: EntityId
    timer: EntityId
    odom_thread: ThreadId
    scan_thread: ThreadId
    timer_thread: ThreadId


@dataclass(frozen=True, slots=True)
class _Leg:
    """A stretch of driving with one velocity, from ``start`` to ``end``."""

    start: float
    end: float
    linear: float
    angular: float


class _Play(Protocol):
    """Writes a run of so many seconds, or of its own length."""

    def __call__(self, seconds: float = ..., /) -> Run: ...


def _written_once(play: _Play) -> _Play:
    """Write each run a single time, since a hundred tests want the same ones; everybody gets a copy."""
    written = cache(play)

    @wraps(play)
    def copied(*seconds: float) -> Run:
        return written(*seconds).copy()

    return copied


@_written_once
def shared_group_run(seconds: float = 30.0) -> Run:
    """The lesson with one shared group: all queue up behind the timer, which rotates from 4 to 24 s.

    MainThread alone, group A with odom, scan and timer. The timer finds the sphere at 4.0 s and sleeps ten
    seconds; at 14.0 s it comes first, with the old range, and rotates again; at 24.0 s odom, scan and timer
    come and the robot drives on. At 14.25 s both queues stand at 10/10 and 390 messages are lost.
    """
    run = Run("shared-group")
    main = run.thread("MainThread")
    run.executor("SingleThreadedExecutor", 1)
    node = run.node("/sub_node")
    group = run.exclusive(node)
    odom = run.subscription(group, "/odom", "odom_callback", lines=(58, 68))
    scan = run.subscription(group, "/scan", "scan_callback", lines=(71, 75))
    timer = run.timer(group, "timer_callback", PERIOD, lines=(120, 136))
    seats = _Seats(odom, scan, timer, main, main, main)
    legs = (_Leg(0.5, 4.0, SPEED, 0.0), _Leg(4.0, 24.0, 0.0, TURN), _Leg(24.0, math.inf, SPEED, 0.0))
    _drive(run, seats, seconds, legs)
    for start, late, after in ((4.0, 0.0, 14.0), (14.0, 9.5, 24.0002)):
        _rotation(run, seats, start, late, 0.47)
        run.wait(timer, start + PERIOD, after, holder=timer, workers_busy=True)
    for entity, since in ((odom, 4.0 + ODOM_AFTER), (scan, 4.0 + SCAN_AFTER)):
        run.wait(entity, since, 24.0 + (0.0001 if entity == scan else 0.0), holder=timer, workers_busy=True)
    _sensors_run(run, seats, TICK, 4.0)
    _ticks(run, seats, PERIOD, 4.0)
    _burst(run, seats)
    _sensors_run(run, seats, 24.0, seconds)
    _ticks(run, seats, 24.5, seconds)
    run.stop(seconds)
    return run


@_written_once
def split_groups_run(seconds: float = 20.0) -> Run:
    """The lesson with three groups and four workers: the sensors go on while the timer rotates, 4 to 14 s.

    Group A holds the timer on ``ThreadPoolExecutor-0_0``, B odom on ``-0_1``, C scan on ``-0_2``;
    ``-0_3`` never runs. /motor_power is called at 7.0 s and answers 0.8 ms later.
    """
    run = Run("split-groups")
    workers = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(4)]
    run.executor("MultiThreadedExecutor", 4)
    node = run.node("/sub_node")
    first, second, third = (run.exclusive(node) for _ in range(3))
    timer = run.timer(first, "timer_callback", PERIOD, lines=(120, 136))
    odom = run.subscription(second, "/odom", "odom_callback", lines=(58, 68))
    scan = run.subscription(third, "/scan", "scan_callback", lines=(71, 75))
    seats = _Seats(odom, scan, timer, workers[1], workers[2], workers[0])
    legs = (_Leg(0.5, 4.0, SPEED, 0.0), _Leg(4.0, 14.0, 0.0, TURN), _Leg(14.0, math.inf, SPEED, 0.0))
    _drive(run, seats, seconds, legs)
    _sensors_run(run, seats, TICK, seconds)
    _ticks(run, seats, PERIOD, 4.0)
    _rotation(run, seats, 4.0, 0.0, 0.47)
    run.wait(timer, 4.5, 14.0, holder=timer)
    _straight(run, seats, 14.0, late=9.5)
    _ticks(run, seats, 14.5, seconds)
    run.command("/motor_power SetBool data=True", 7.0)
    run.call("/motor_power", 7.0, replied=7.0008)
    run.stop(seconds)
    return run


@_written_once
def dummy_server_run(seconds: float = 10.0) -> Run:
    """The DummyServer, reentrant, with two threads: it is called at 2.55 s and no tick is late."""
    run = Run("reentrant-2-threads")
    workers = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(2)]
    service, timer = _dummy_server(run, threads=2)
    for second in range(1, int(seconds) + 1):
        worker = workers[1] if 2.55 < second < 7.55 else workers[0]
        _tick(run, timer, worker, float(second), 0.0)
    _request(run, service, workers[0], seconds)
    run.stop(seconds)
    return run


@_written_once
def dummy_server_one_thread_run(seconds: float = 10.0) -> Run:
    """The DummyServer, reentrant, with one thread: no tick from 2.55 to 7.55 s, then a late one."""
    run = Run("reentrant-1-thread")
    worker = run.thread("ThreadPoolExecutor-0_0")
    service, timer = _dummy_server(run, threads=1)
    for second in (1, 2, *range(8, int(seconds) + 1)):
        _tick(run, timer, worker, float(second), 0.0)
    _request(run, service, worker, seconds)
    run.wait(timer, 3.0, 7.55, Reason.NO_FREE_WORKER, service, workers_busy=True)
    _tick(run, timer, worker, 7.55, 4.55)
    run.stop(seconds)
    return run


def scan_from(x: float, y: float, yaw: float) -> bytes:
    """Ranges as ``Scanned`` carries them, of a square room with a sphere, seen from a pose."""
    angles = yaw - math.pi + np.arange(BEAMS) * (2 * math.pi / BEAMS)
    dx, dy = np.cos(angles), np.sin(angles)
    with np.errstate(divide="ignore"):
        across = np.where(dx > 0, (WALL - x) / dx, (-WALL - x) / dx)
        along = np.where(dy > 0, (WALL - y) / dy, (-WALL - y) / dy)
    ranges = np.minimum(np.abs(across), np.abs(along))
    ahead = (SPHERE[0] - x) * dx + (SPHERE[1] - y) * dy
    aside = np.abs((SPHERE[0] - x) * dy - (SPHERE[1] - y) * dx)
    hit = (ahead > 0) & (aside < SPHERE_RADIUS)
    ranges[hit] = (ahead - np.sqrt(np.maximum(SPHERE_RADIUS**2 - aside**2, 0.0)))[hit]
    return bytes(np.round(ranges * 1000).astype("<u2"))


def _drive(run: Run, seats: _Seats, seconds: float, legs: tuple[_Leg, ...]) -> None:
    """Move the robot along the legs at 20 Hz, and let its messages arrive."""
    run.arena(WALL, (*SPHERE, SPHERE_RADIUS))
    for leg in legs:
        run.velocity(leg.start, leg.linear, leg.angular)
    x = y = yaw = turned = travelled = 0.0
    for tick in range(round(seconds / TICK) + 1):
        at = tick * TICK
        leg = next((leg for leg in legs if leg.start <= at < leg.end), _Leg(0.0, 0.0, 0.0, 0.0))
        ranges = scan_from(x, y, yaw)
        front = int.from_bytes(ranges[BEAMS : BEAMS + 2], "little") / 1000
        run.robot(at, x, y, yaw, front, leg.linear, leg.angular, turned=turned, travelled=travelled)
        if tick:
            run.message(seats.odom, at + ODOM_AFTER, delay=0.001)
            run.scan(run.message(seats.scan, at + SCAN_AFTER, delay=0.001), at + SCAN_AFTER - 0.001, ranges)
        yaw = math.remainder(yaw + leg.angular * TICK, math.tau)
        turned += leg.angular * TICK
        x += leg.linear * TICK * math.cos(yaw)
        y += leg.linear * TICK * math.sin(yaw)
        travelled += abs(leg.linear) * TICK


def _sensors_run(run: Run, seats: _Seats, start: float, end: float) -> None:
    """Let odom and scan run as they come, from the 20 Hz tick at ``start`` to before the one at ``end``."""
    for tick in range(round(start / TICK), math.ceil(end / TICK)):
        _odom(run, seats, tick * TICK + ODOM_AFTER, 0.0004)
        _scan(run, seats, tick * TICK + SCAN_AFTER, 0.0005)


def _ticks(run: Run, seats: _Seats, start: float, end: float) -> None:
    """Let the timer run as it falls due, from ``start`` to before ``end``."""
    for tick in range(round(start / PERIOD), math.ceil(end / PERIOD)):
        _straight(run, seats, tick * PERIOD, late=0.0)


def _burst(run: Run, seats: _Seats) -> None:
    """What waits at 24.0 s: odom, scan and timer, then the rest of both queues, alternately."""
    _odom(run, seats, 24.0, 0.0001)
    _scan(run, seats, 24.0001, 0.0001)
    _straight(run, seats, 24.0002, late=9.5002)
    for pair in range(9):
        _odom(run, seats, 24.0012 + pair * 0.0002, 0.0001)
        _scan(run, seats, 24.0013 + pair * 0.0002, 0.0001)


def _odom(run: Run, seats: _Seats, at: float, for_: float) -> None:
    run.callback(seats.odom, seats.odom_thread, at, for_)
    run.log("Odom CallBack", at, seats.odom_thread, seats.odom)


def _scan(run: Run, seats: _Seats, at: float, for_: float) -> None:
    run.callback(seats.scan, seats.scan_thread, at, for_)
    run.log("Scan CallBack", at, seats.scan_thread, seats.scan)


def _straight(run: Run, seats: _Seats, at: float, late: float) -> None:
    run.due(seats.timer, at - late)
    run.callback(seats.timer, seats.timer_thread, at, 0.001, late)
    run.log("Timer CallBack", at, seats.timer_thread, seats.timer)
    run.log("MOVE STRAIGHT", at, seats.timer_thread, seats.timer)


def _rotation(run: Run, seats: _Seats, at: float, late: float, front: float) -> None:
    """The timer finds the sphere and sleeps ten times one second."""
    run.due(seats.timer, at - late)
    run.callback(seats.timer, seats.timer_thread, at, 10.0, late)
    run.log("Timer CallBack", at, seats.timer_thread, seats.timer)
    run.log(f">>>>>>>>>RANGES Value={front}", at, seats.timer_thread, seats.timer, Severity.WARN)
    run.log("STOP ROTATE", at, seats.timer_thread, seats.timer)
    run.log("Rotating for 10 seconds", at, seats.timer_thread, seats.timer)
    for second in range(10):
        run.log(f"SLEEPING=={second} seconds", at + second, seats.timer_thread, seats.timer)


def _dummy_server(run: Run, threads: int) -> tuple[EntityId, EntityId]:
    run.executor("MultiThreadedExecutor", threads)
    group = run.reentrant(run.node("/service_start_turn"))
    service = run.service(group, "/dummy_server_srv", "service_callback", lines=(60, 75))
    return service, run.timer(group, "timer_callback", 1.0, lines=(80, 92))


def _tick(run: Run, timer: EntityId, worker: ThreadId, at: float, late: float) -> None:
    run.due(timer, at - late)
    run.callback(timer, worker, at, 0.001, late)
    run.log("TICK" if round(at) % 2 else "TACK", at, worker, timer, logger="service_start_turn")


def _request(run: Run, service: EntityId, worker: ThreadId, seconds: float) -> None:
    """A call at 2.55 s that turns the robot for five seconds."""
    run.command("/dummy_server_srv SetBool data=True", 2.55)
    run.call("/dummy_server_srv", 2.55, replied=7.55, response=REPLY.format("TURNING"))
    run.request(service, 2.55)
    run.callback(service, worker, 2.55, 5.0)
    run.log("Processing Server Message...", 2.55, worker, service, Severity.WARN, "service_start_turn")
    for second in range(5):
        text = f"...{second}[WAITING...]"
        run.log(text, 2.55 + second, worker, service, logger="service_start_turn")
    run.velocity(2.55, 0.0, 0.2)
    run.velocity(7.55, 0.0, 0.0)
    for tick in range(round(seconds / TICK) + 1):
        at = tick * TICK
        yaw = 0.2 * (min(max(at, 2.55), 7.55) - 2.55)
        run.robot(at, 0.0, 0.0, yaw, angular=0.2 if 2.55 <= at < 7.55 else 0.0, turned=yaw)
