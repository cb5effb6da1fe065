"""Runs that the factory's tests share: who is seen where is the point of each."""

from sim.trace.events import Reason
from sim.trace.timeline import Timeline
from tests.support.runs import Run
from tests.widgets.pictures import told


def four_workers_one_seat() -> Timeline:
    """One exclusive group, four threads of which one has ever run: its timer runs from 4 s on."""
    run = Run("shared-group")
    worker = run.thread("ThreadPoolExecutor-0_0")
    run.executor("MultiThreadedExecutor", 4)
    group = run.exclusive(run.node("/sub_node"))
    odom = run.subscription(group, "/odom", "odom_callback", depth=3)
    timer = run.timer(group, "timer_callback", 0.5)
    run.callback(timer, worker, 4.0)
    for tick in range(5):
        run.message(odom, 4.1 + 0.1 * tick)
    run.wait(odom, 4.1, None, holder=timer)
    run.stop(12.0)
    return told(run)


def one_worker_three_areas() -> Timeline:
    """Three exclusive groups and one thread: its timer runs from 4 s on, odom and scan find no worker."""
    run = Run("split-groups")
    worker = run.thread("ThreadPoolExecutor-0_0")
    run.executor("MultiThreadedExecutor", 1)
    node = run.node("/sub_node")
    odom = run.subscription(run.exclusive(node), "/odom", "odom_callback")
    scan = run.subscription(run.exclusive(node), "/scan", "scan_callback")
    timer = run.timer(run.exclusive(node), "timer_callback", 0.5)
    run.callback(timer, worker, 4.0)
    for sensor in (odom, scan):
        run.message(sensor, 5.0)
        run.wait(sensor, 5.0, None, Reason.NO_FREE_WORKER, timer, workers_busy=True)
    run.stop(12.0)
    return told(run)


def stuck_in_a_call() -> Timeline:
    """A timer calls a service of its own group at 1.2 s: worker and seat are stuck."""
    run = Run("deadlock")
    worker = run.thread("ThreadPoolExecutor-0_0")
    run.executor("MultiThreadedExecutor", 2)
    group = run.exclusive(run.node("/node"))
    timer = run.timer(group, "timer_callback", 1.0)
    service = run.service(group, "/motor_power", "power_callback")
    run.callback(timer, worker, 1.0)
    call = run.call("/motor_power", 1.2, None, entity=timer)
    run.blocked(call, "/motor_power", worker, timer, 1.2)
    run.request(service, 1.2)
    run.wait(service, 1.2, None, holder=timer)
    run.stop(9.0)
    return told(run)


def many_groups(groups: int = 8) -> Timeline:
    """So many groups of one subscription each; only that of group G waits, and only in D something runs."""
    run = Run("many")
    worker = run.thread("MainThread")
    run.executor("MultiThreadedExecutor", 2)
    node = run.node("/node")
    entities = [
        run.subscription(run.exclusive(node), f"/topic{number}", f"topic{number}_callback")
        for number in range(groups)
    ]
    run.callback(entities[3], worker, 1.0)
    run.message(entities[6], 1.0)
    run.wait(entities[6], 1.0, None, Reason.NO_FREE_WORKER)
    run.stop(9.0)
    return told(run)
