"""The factory as text: who sits, who waits and why can be read without a colour."""

from cbtui.looks.theme import Charset
from cbtui.widgets.factory import FactoryPainter
from sim.trace.events import CallbackAt, Doing
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns
from tests.widgets.factory.scenes import (
    four_workers_one_seat,
    many_groups,
    one_worker_three_areas,
    stuck_in_a_call,
)
from tests.widgets.pictures import drawn, dummy_server, plain, shared_group, split_groups, told


def factory(
    timeline: Timeline, now: float, width: int, height: int, charset: Charset = Charset.BRAILLE
) -> str:
    return plain(FactoryPainter(charset).paint(timeline, ns(now), width, height))


def test_one_seat_starves_the_sensors() -> None:
    assert factory(shared_group(), 12.9, 64, 12) == drawn(
        """
        | 1 worker, 1 seat: 2 callbacks wait for it                      |
        | belts                            areas                         |
        |                                ┏━ A one seat ━━━ 2 wait ━┓     |
        | odom  10/10 ! lost 168 ■■■■■■■✗┃                         ┃     |
        | waits 8.9 s: seat held by timer┃                         ┃     |
        | scan  10/10 ! lost 168 ■■■■■■■✗┃▐☻ timer_callback▌ 8.9 s ┃     |
        | waits 8.9 s: seat held by timer┃   MainThread            ┃     |
        | timer ◷ 500 ms ──────────────◆✗┃                         ┃     |
        |      late 8.4 s: last call runs┃                         ┃     |
        |                                ┗━━━━━━━━━━━━━━━━━━━━━━━━━┛     |
        |                                                                |
        | · MainThread works in A                                        |
        """
    )


def test_the_same_starving_in_nine_rows_of_ascii() -> None:
    assert factory(shared_group(), 12.9, 78, 9, Charset.ASCII) == drawn(
        """
        | 1 worker, 1 seat: 2 callbacks wait for it  += A ## one seat == 2 wait =+     |
        | odom  10/10 ! lost 168 ---#########[498ms]X|                           |     |
        |    waits 8.9 s: seat held by timer_callback|                           |     |
        | scan  10/10 ! lost 168 ---#########[495ms]X|[@ timer_callback] 8.9 s   |     |
        |    waits 8.9 s: seat held by timer_callback|   MainThread              |     |
        | timer every 500 ms ----------------------*X|                           |     |
        |        late 8.4 s: its last call still runs|                           |     |
        |                                            +===========================+     |
        | . MainThread works in A                                                      |
        """
    )


def test_one_seat_fits_a_narrow_pane() -> None:
    assert factory(shared_group(), 12.9, 38, 10, Charset.BLOCK) == drawn(
        """
        | 1 worker, 1 seat: 2 wait for it      |
        |                  ╔═ A one seat ══╗   |
        | odom  10/10 ! ■■✗║               ║   |
        |  8.9 s: seat held║               ║   |
        | scan  10/10 ! ■■✗║▐☻ timer▌ 8.9 s║   |
        |  8.9 s: seat held║   MainThread  ║   |
        | timer ○ 500 ms ♦✗║               ║   |
        |   8.4 s: own call║               ║   |
        |                  ╚═══════════════╝   |
        | · MainThread works in A              |
        """
    )


def test_four_workers_go_round_three_areas() -> None:
    assert factory(split_groups(), 9.412, 64, 12, Charset.ASCII) == drawn(
        """
        | 4 workers, 3 areas, 1 callback waits for its own last call     |
        |                                += A one seat ============+     |
        | timer every 500 ms ----------*X|[@ timer_callback] 5.4 s |     |
        |      late 4.9 s: last call runs|   Pool-0_0              |     |
        |                                += B one seat ============+     |
        | odom  0/10    ------..........>|[ ] odom just ran        |o>   |
        |                                |                         |     |
        |                                += C one seat ============+     |
        | scan  0/10    ------..........>|[ ] scan just ran        |o>   |
        |                                |                         |     |
        |                                +=========================+     |
        | . Pool-0_0  . Pool-0_1  . Pool-0_2  o Pool-0_3 unused          |
        """
    )


def test_three_areas_fit_nine_rows() -> None:
    assert factory(split_groups(), 9.412, 78, 9) == drawn(
        """
        | 4 workers, 3 areas, 1 callback waits for its own last call                   |
        |                                            ┏━ A ██ one seat ━━━━━━━━━━━┓     |
        | timer ◷ 500 ms 4.9 s: last call runs ────◆✗┃▐☻ timer_callback▌ 5.4 s   ┃     |
        |                                            ┣━ B ·· one seat ━━━━━━━━━━━┫     |
        | odom  0/10    ──────────────────□□□□□□□□□□▸┃▐ ▌ odom_callback just ran ┃☺▸   |
        |                                            ┣━ C ══ one seat ━━━━━━━━━━━┫     |
        | scan  0/10    ──────────────────□□□□□□□□□□▸┃▐ ▌ scan_callback just ran ┃☺▸   |
        |                                            ┗━━━━━━━━━━━━━━━━━━━━━━━━━━━┛     |
        | · Pool-0_0 in A  · Pool-0_1 from B  · Pool-0_2 from C  ☺ Pool-0_3 unused     |
        """
    )


def test_three_areas_fit_a_narrow_pane() -> None:
    assert factory(split_groups(), 9.412, 38, 10, Charset.BLOCK) == drawn(
        """
        | 4 workers, 3 areas                   |
        | belts              areas             |
        |                  ╔═ A one seat ══╗   |
        | timer own call ♦✗║▐☻ timer▌ 5.4 s║   |
        |                  ╠═ B one seat ══╣   |
        | odom  0/10 ·····►║▐ ▌ odom ran   ║☺► |
        |                  ╠═ C one seat ══╣   |
        | scan  0/10 ·····►║▐ ▌ scan ran   ║☺► |
        |                  ╚═══════════════╝   |
        | ···☺ 1 busy, 2 idle, 1 unused        |
        """
    )


def test_in_a_narrow_pane_the_reason_of_a_wait_stays_before_a_rate_and_how_long_it_lasts() -> None:
    assert factory(shared_group(), 9.412, 44, 6) == drawn(
        """
        | 1 worker, 1 seat    ┏━ A one seat ━━━━━┓   |
        | odom  10/10 ! held ✗┃▐☻ timer▌ 5.4 s   ┃   |
        | scan  10/10 ! held ✗┃   MainThread     ┃   |
        | timer own call ───◆✗┃                  ┃   |
        |                     ┗━━━━━━━━━━━━━━━━━━┛   |
        | · MainThread works in A                    |
        """
    )
    assert "timer 4.9 s: own call ✗┃" in factory(split_groups(), 9.412, 50, 8)


def test_a_wide_pane_has_large_figures_and_a_yard() -> None:
    assert factory(split_groups(), 9.412, 104, 20) == drawn(
        r"""
    | 4 workers, 3 areas, 1 callback waits for its own last call                                             |
    | belts                                  areas                               workers                     |
    |                                      ┏━ A ██ one seat ━━━━━━━━━━━━━┓                                   |
    | timer ◷ 500 ms ────────────────────◆✗┃    ☻                        ┃                                   |
    |  late 4.9 s: its last call still runs┃ ▐ /█\ ▌   timer  5.4 s      ┃        ·   Pool-0_0               |
    |                                      ┃ ▐▄▄▄▄▄▌   Pool-0_0          ┃            works in A             |
    |                                      ┗━━━━━━━━━━━━━━━━━━━━━━━━━━━━━┛                                   |
    |                                                                                                        |
    |                                      ┏━ B ·· one seat ━━━━━━━━━━━━━┓        ·   Pool-0_1               |
    | odom  0/10    ────────────□□□□□□□□□□▸┃                             ┃ ☺          back from B            |
    |                                      ┃ ▐     ▌   odom just ran     ┃/█\                                |
    |                                      ┃ ▐▄▄▄▄▄▌                     ┃/ >                                |
    |                                      ┗━━━━━━━━━━━━━━━━━━━━━━━━━━━━━┛        ·   Pool-0_2               |
    |                                                                                 back from C            |
    |                                      ┏━ C ══ one seat ━━━━━━━━━━━━━┓                                   |
    | scan  0/10    ────────────□□□□□□□□□□▸┃                             ┃ ☺      ☺                          |
    |                                      ┃ ▐     ▌   scan just ran     ┃/█\    /█\  Pool-0_3               |
    |                                      ┃ ▐▄▄▄▄▄▌                     ┃/ >    / \  never needed           |
    |                                      ┗━━━━━━━━━━━━━━━━━━━━━━━━━━━━━┛                                   |
    |                                                                                                        |
    """
    )


def test_large_figures_are_readable_in_ascii() -> None:
    assert factory(shared_group(), 12.9, 104, 13, Charset.ASCII) == drawn(
        r"""
    | 1 worker, 1 seat: 2 callbacks wait for it                                                              |
    | belts                                  areas                               workers                     |
    |                                      += A ## one seat ==== 2 wait =+                                   |
    | odom  10/10 ! lost 168 ---##########X|                             |                                   |
    |       waits 8.9 s: seat held by timer|                             |        .   MainThread             |
    |                                      |                             |            works in A             |
    | scan  10/10 ! lost 168 ---##########X|    @                        |                                   |
    |       waits 8.9 s: seat held by timer| [ /|\ ]   timer  8.9 s      |                                   |
    |                                      | [_____]   MainThread        |                                   |
    | timer every 500 ms ----------------*X|                             |                                   |
    |  late 8.4 s: its last call still runs|                             |                                   |
    |                                      |                             |                                   |
    |                                      +=============================+                                   |
    """
    )


def test_four_workers_have_one_seat() -> None:
    assert factory(four_workers_one_seat(), 9.0, 78, 9, Charset.BLOCK) == drawn(
        """
        | 4 workers, 1 seat: 1 callback waits for it, 3 workers idle                   |
        | belts                                        areas                           |
        |                                            ╔═ A ██ one seat ═ 1 waits ═╗     |
        | odom  3/3 ! lost 2 ─────▐4.5s▌▐4.6s▌▐4.7s▌✗║                           ║     |
        |    waits 4.9 s: seat held by timer_callback║▐☻ timer_callback▌ 5.0 s   ║     |
        | timer ○ 500 ms ───────────────────────────►║   Pool-0_0                ║     |
        |                                            ║                           ║     |
        |                                            ╚═══════════════════════════╝     |
        | · Pool-0_0 in A  ☺ worker 2 unused  ☺ worker 3 unused  ☺ worker 4 unused     |
        """
    )


def test_four_workers_have_one_seat_in_large() -> None:
    assert factory(four_workers_one_seat(), 9.0, 104, 19) == drawn(
        r"""
    | 4 workers, 1 seat: 1 callback waits for it, 3 workers idle                                             |
    | belts                                  areas                               workers                     |
    |                                      ┏━ A ██ one seat ━━━ 1 waits ━┓                                   |
    | odom  3/3 ! lost 2 ────■▐4.6s▌▐4.7s▌✗┃                             ┃                                   |
    |       waits 4.9 s: seat held by timer┃    ☻                        ┃        ·   Pool-0_0               |
    |                                      ┃ ▐ /█\ ▌   timer  5.0 s      ┃            works in A             |
    | timer ◷ 500 ms ─────────────────────▸┃ ▐▄▄▄▄▄▌   Pool-0_0          ┃                                   |
    |                                      ┃                             ┃        ☺                          |
    |                                      ┃                             ┃       /█\  worker 2               |
    |                                      ┗━━━━━━━━━━━━━━━━━━━━━━━━━━━━━┛       / \  never needed           |
    |                                                                                                        |
    |                                                                             ☺                          |
    |                                                                            /█\  worker 3               |
    |                                                                            / \  never needed           |
    |                                                                                                        |
    |                                                                             ☺                          |
    |                                                                            /█\  worker 4               |
    |                                                                            / \  never needed           |
    |                                                                                                        |
    """
    )


def test_one_worker_has_three_areas() -> None:
    assert factory(one_worker_three_areas(), 12.0, 64, 12) == drawn(
        """
        | 1 worker, 3 areas: 2 callbacks wait for a worker               |
        |                                ┏━ A one seat ━━ 1 waits ━┓     |
        | odom  1/10    ─□□□□□□□□□▐7.0s▌✗┃▐ ▌ free                 ┃     |
        |     waits 7.0 s: no free worker┃                         ┃     |
        |                                ┣━ B one seat ━━ 1 waits ━┫     |
        | scan  1/10    ─□□□□□□□□□▐7.0s▌✗┃▐ ▌ free                 ┃     |
        |     waits 7.0 s: no free worker┃                         ┃     |
        |                                ┣━ C one seat ━━━━━━━━━━━━┫     |
        | timer ◷ 500 ms ───────────────▸┃▐☻ timer_callback▌ 8.0 s ┃     |
        |                                ┃   Pool-0_0              ┃     |
        |                                ┗━━━━━━━━━━━━━━━━━━━━━━━━━┛     |
        | · Pool-0_0 works in C                                          |
        """
    )


def test_one_worker_has_three_areas_in_nine_rows() -> None:
    assert factory(one_worker_three_areas(), 12.0, 78, 9, Charset.ASCII) == drawn(
        """
        | 1 worker, 3 areas: 2 callbacks wait for a worker                             |
        |                                            += A ## one seat = 1 waits =+     |
        | odom  1/10    7.0 s: no free worker .....#X|[ ] free                   |     |
        |                                            += B ++ one seat = 1 waits =+     |
        | scan  1/10    7.0 s: no free worker .....#X|[ ] free                   |     |
        |                                            += C == one seat ===========+     |
        | timer every 500 ms ----------------------->|[@ timer_callback] 8.0 s   |     |
        |                                            +===========================+     |
        | . Pool-0_0 works in C                                                        |
        """
    )


def test_two_workers_sit_in_one_open_area() -> None:
    assert factory(dummy_server(), 5.0005, 78, 9) == drawn(
        """
        | 2 workers, 1 open area, no callback waits for another                        |
        | belts                                        areas                           |
        |                                            ┌╌ A open to all ╌╌╌╌╌╌╌╌╌╌╌┐     |
        | dummy_server_srv 0/10    ───────□□□□□□□□□□▸╎(☻ service_callback) 2.5 s ╎     |
        |                                            ╎(  timer_callback) starts  ╎   ◂☻|
        | timer            ◷ 1.0 s ─◆───────────────▸╎( ) ( ) ( ) ( )            ╎     |
        |                  next in 1.0 s             ╎                           ╎     |
        |                                            └╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌╌┘     |
        | · Pool-0_0 works in A  · Pool-0_1 goes to A                                  |
        """
    )


def test_two_workers_sit_in_one_open_area_in_block() -> None:
    assert factory(dummy_server(), 5.0005, 64, 12, Charset.BLOCK) == drawn(
        """
        | 2 workers, 1 open area, no callback waits for another          |
        | belts                            areas                         |
        |                                ·· A open to all ··········     |
        | dummy_serve… 0/10    ·········►:(☻ service) 2.5 s        :     |
        |                                :(  timer_callback) starts:   ◄☻|
        | timer        ○ 1.0 s ─♦───────►:( ) ( ) ( ) ( )          :     |
        |              next in 1.0 s     :                         :     |
        |                                ···························     |
        |                                                                |
        | · Pool-0_0 works in A  · Pool-0_1 goes to A                    |
        |                                                                |
        |                                                                |
        """
    )


def test_an_open_area_in_ascii_has_no_wall() -> None:
    assert factory(dummy_server(), 5.05, 64, 9, Charset.ASCII) == drawn(
        """
        | 2 workers, 1 open area, no callback waits for another          |
        | belts                            areas                         |
        |                                .. A open to all ..........     |
        | dummy_serve~ 0/10    .........>:(@ service) 2.5 s        :     |
        |                                :( ) timer just ran       :o>   |
        | timer        every 1.0 s -*--->:( ) ( ) ( ) ( )          :     |
        |              next in 950 ms    :                         :     |
        |                                ...........................     |
        | . Pool-0_0 works in A  . Pool-0_1 back from A                  |
        """
    )


def test_a_worker_in_a_call_is_blocked_in_its_seat() -> None:
    assert factory(stuck_in_a_call(), 3.0, 78, 9) == drawn(
        """
        | 2 workers, 1 seat: 1 callback waits for it, 1 worker idle                    |
        | belts                                        areas                           |
        |                                            ┏━ A ██ one seat ━ 1 waits ━┓     |
        | timer       ◷ 1.0 s ──────────────────────▸┃                           ┃     |
        |                                            ┃▐☻ timer_callback▌ 2.0 s   ┃     |
        | motor_power 1/10    ───────□□□□□□□□□▐1.8s▌✗┃   blocked in call 1.8 s   ┃     |
        |    waits 1.8 s: seat held by timer_callback┃                           ┃     |
        |                                            ┗━━━━━━━━━━━━━━━━━━━━━━━━━━━┛     |
        | · Pool-0_0 works in A  ☺ worker 2 never needed                               |
        """
    )


def test_a_blocked_call_is_not_told_as_nothing_that_waits() -> None:
    """The belt below it says that the timer's last call still runs."""
    run = Run("calls")
    worker = run.thread("ThreadPoolExecutor-0_0")
    run.executor("MultiThreadedExecutor", 2)
    timer = run.timer(run.exclusive(run.node("/node")), "ask", 1.0)
    run.callback(timer, worker, 1.0)
    run.blocked(run.call("/clamp", 1.2, None, entity=timer), "/clamp", worker, timer, 1.2)
    run.wait(timer, 2.0, None, holder=timer)
    run.stop(9.0)
    picture = factory(told(run), 3.0, 78, 9)
    assert picture.splitlines()[0].strip("| ") == "2 workers, 1 seat, 1 worker blocked in a call"
    assert "last call" in picture


def test_the_most_telling_areas_come_first_in_a_short_pane() -> None:
    assert factory(many_groups(), 2.0, 64, 6) == drawn(
        """
        | 2 workers, 8 areas: 1 waits for a worker        +4 more groups |
        | topic0 0/10    ─────□□□□□□□□□□▸┃A▐ ▌ free                ┃     |
        | topic1 0/10    ─────□□□□□□□□□□▸┃B▐ ▌ free                ┃     |
        | topic3 0/10    ─────□□□□□□□□□□▸┃D▐☻ topic3▌ 1.0 s        ┃     |
        | topic6 1/10    no worker □□□□■✗┃G▐ ▌ free                ┃     |
        | · MainThread works in D  ☺ worker 2 never needed               |
        """
    )


def test_a_client_is_told_from_the_service_of_its_name_by_its_mark_however_narrow_the_pane() -> None:
    run = Run()
    thread, node = run.thread("MainThread"), run.node("/node")
    ask = run.timer(run.exclusive(node), "ask", 9.0)
    run.service(run.exclusive(node), "/weigh", "weigh")
    client = run.client(run.exclusive(node), "/weigh")
    run.callback(ask, thread, 1.0)
    run.request(client, 2.0)
    run.request(client, 2.5)
    run.stop(3.0)
    timeline = told(run)
    assert "weigh   0/10   " in factory(timeline, 3.0, 64, 12)
    assert "weigh ◂ client " in factory(timeline, 1.5, 64, 12)
    assert "weigh < client " in factory(timeline, 1.5, 64, 12, Charset.ASCII)
    assert "weigh ◂ 1 reply " in factory(timeline, 2.2, 64, 12)
    assert "weigh ◂ 2 replies " in factory(timeline, 2.7, 64, 12)
    assert "wei… ◂ client" in factory(timeline, 1.5, 38, 12)


def test_before_a_run_is_over_no_worker_was_never_needed() -> None:
    first_step = split_groups(1.0)
    assert "not used yet" in factory(first_step, 1.0, 140, 16)
    assert "never needed" not in factory(first_step, 1.0, 140, 16)


def test_who_waits_for_a_lock_is_told_in_the_headline_and_at_its_seat() -> None:
    run = Run("lock")
    run.executor("MultiThreadedExecutor", 2)
    node = run.node("/node")
    count = run.subscription(run.reentrant(node), "/boxes", "count")
    run.timer(run.exclusive(node), "blink", 1.0)
    first, second = (run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(2))
    for worker in (first, second):
        run.callback(count, worker, 1.0)
    frames = (("node.py", "count", 11),)
    run.add(CallbackAt(ns(1.0), count, second, Doing.WAITS, "Lock.acquire", frames, holder=first))
    run.stop(9.0)
    timeline = told(run)
    headline, *rest = factory(timeline, 3.0, 78, 10).splitlines()
    assert headline.strip() == "2 workers, 2 areas, 1 worker waits for a lock"
    assert "(☻ count) waits for a lock" in "\n".join(rest)
    assert "waits for a lock, Pool-0_0 has it" in factory(timeline, 3.0, 138, 20)
    assert "(☻) (░) 1 busy, 1 waits" in factory(timeline, 3.0, 78, 4)


def test_after_the_end_of_a_run_nobody_waits_for_work_and_no_timer_is_due() -> None:
    run = Run("over")
    run.executor("MultiThreadedExecutor", 2)
    workers = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(2)]
    tick = run.timer(run.exclusive(run.node("/node")), "tick", 2.0)
    for number, worker in enumerate(workers, start=1):
        run.callback(tick, worker, 2.0 * number, 0.1)
    run.over(5.0, "the program returned")
    timeline = told(run)
    before, over = factory(timeline, 4.9, 78, 9), factory(timeline, 5.0, 78, 9)
    assert "next in 1.1 s" in before
    assert "Pool-0_0 waits for work" in before
    assert "next in" not in over
    assert "Pool-0_0 spins no more  · Pool-0_1 spins no more" in over
