"""A small run that has a little of everything, with names that want to break out of their files."""

from collections.abc import Sequence

from sim.trace.events import AnyEvent, CallbackStarted, EntityReady, Reason, Severity
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns

NASTY = '=cmd|<b>"it\'s"</b> \x1b[31m_red_\x00'


def small_run() -> list[AnyEvent]:
    """Two threads, three groups: waits, a loss, a suspension, calls with and without a reply, an error."""
    run = Run("small run")
    main, pool = run.thread("MainThread"), run.thread("ThreadPoolExecutor-0_0")
    run.executor("MultiThreadedExecutor", 2)
    node = run.node("/sub_node")
    own, shared, third = run.exclusive(node), run.reentrant(node), run.exclusive(node)
    timer = run.timer(own, "timer_callback", period=0.5)
    odom = run.subscription(own, "/odom", "odom_callback", depth=1)
    serve = run.service(shared, "/motor_power", "serve")
    client = run.client(shared, "/motor_power", "answered")
    later = run.timer(third, "later", period=1.0)
    nasty = run.timer(third, NASTY, period=5.0)

    run.robot(0.1, x=0.5, linear=0.08)
    run.velocity(0.1, 0.08, 0.0)
    run.message(odom, 0.25, delay=0.01)
    run.callback(odom, main, 0.25, 0.01)
    run.callback(timer, main, 0.5, 1.0)
    run.message(odom, 0.6)
    run.wait(odom, 0.6, 1.5, holder=timer)
    run.message(odom, 0.7)
    run.callback(odom, main, 1.5, 0.1)
    run.wait(timer, 1.5, 1.6, reason=Reason.NO_FREE_WORKER, holder=odom, workers_busy=True)
    run.start(timer, main, 1.6, late=0.1)
    run.fail(timer, main, 1.7, "IndexError: no beam 720 | `x`")

    run.start(later, pool, 1.0)
    run.suspend(later, pool, 1.1)
    call = run.call("/motor_power", 1.2, 1.4, entity=timer)
    for entity, arrived, taken, took in ((serve, 1.2, 1.2, 0.25), (client, 1.4, 1.5, 0.0)):
        run.add(EntityReady(ns(arrived), entity, 1, call))
        run.add(CallbackStarted(ns(taken), entity, pool, call, ns(taken) - ns(arrived), 0))
        run.end(entity, pool, taken + took)
    run.resume(later, pool, 1.6)
    run.end(later, pool, 1.8)

    run.command("/motor_power true", 1.9)
    lost_call = run.call("/motor_power", 2.0)
    run.blocked(call, "/motor_power", main, timer, 1.25, 1.4)
    run.blocked(lost_call, "/motor_power", main, 0, 2.0)
    run.log(NASTY, 1.3, main, timer, Severity.WARN)
    run.printed("", 1.3)
    run.notice("The robot touches the wall.", 2.1)
    run.callback(nasty, pool, 2.1)
    run.message(odom, 2.2)
    run.over(2.5)
    return run.events


def timeline_of(events: Sequence[AnyEvent]) -> Timeline:
    timeline = Timeline()
    timeline.extend(events)
    return timeline
