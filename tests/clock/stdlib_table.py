"""What every waiting, time-telling and random call of the standard library does on virtual time.

``python -m tests.clock.stdlib_table`` writes the table into ``sim/clock/README.md``.
"""

import re
import textwrap
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

PAGE = Path(__file__).parents[2] / "sim" / "clock" / "README.md"
_TABLE = re.compile(r"(?<=<!-- table -->\n).*(?=<!-- end of the table -->)", re.DOTALL)

PRELUDE = """
import asyncio, concurrent.futures, contextlib, datetime, email.utils, fcntl, logging, multiprocessing, os
import pty, queue, random, resource, sched, secrets, select, selectors, signal, socket, subprocess, tempfile
import threading, time, uuid
from multiprocessing.pool import ThreadPool

def thread(target, *args):
    started = threading.Thread(target=target, args=args, daemon=True)
    started.start()
    return started

def after(seconds, action, *args):
    return thread(lambda: (time.sleep(seconds), action(*args)))

def virtual(told):
    assert 0 <= time.time() - told <= 1, told
"""
"""What the statements of the rows may use."""


class Does(StrEnum):
    """How a call gets along with virtual time; the page says what each of them means."""

    VIRTUAL = "virtual"
    HOLDS = "real pace"
    SEEDED = "seeded"
    NEW = "new each time"
    REFUSED = "refused"


@dataclass(frozen=True)
class Row:
    """A call, what it does, and statements that use it and take so many seconds of virtual time."""

    call: str
    does: Does
    code: str
    takes: float = 0.0

    @property
    def body(self) -> str:
        """The statements, from the left margin on."""
        return textwrap.dedent(self.code).strip()


ROWS = (
    Row("time.sleep", Does.VIRTUAL, "time.sleep(0.25)", 0.25),
    Row("threading.Thread.join", Does.VIRTUAL, "thread(time.sleep, 0.25).join()", 0.25),
    Row(
        "threading.Lock, RLock",
        Does.VIRTUAL,
        """
        lock = threading.Lock()
        lock.acquire()
        assert not lock.acquire(timeout=0.25)
        """,
        0.25,
    ),
    Row(
        "threading.Condition",
        Does.VIRTUAL,
        """
        condition = threading.Condition()
        with condition:
            condition.wait(0.25)
        """,
        0.25,
    ),
    Row(
        "threading.Event",
        Does.VIRTUAL,
        """
        event = threading.Event()
        after(0.25, event.set)
        event.wait()
        """,
        0.25,
    ),
    Row("threading.Semaphore", Does.VIRTUAL, "threading.Semaphore(0).acquire(timeout=0.25)", 0.25),
    Row(
        "threading.Barrier",
        Does.VIRTUAL,
        """
        barrier = threading.Barrier(2)
        after(0.25, barrier.wait)
        barrier.wait()
        """,
        0.25,
    ),
    Row(
        "threading.Timer",
        Does.VIRTUAL,
        """
        timer = threading.Timer(0.25, int)
        timer.start()
        timer.join()
        """,
        0.25,
    ),
    Row(
        "queue.Queue, LifoQueue, PriorityQueue, SimpleQueue",
        Does.VIRTUAL,
        """
        for kind in (queue.Queue, queue.LifoQueue, queue.PriorityQueue, queue.SimpleQueue):
            with contextlib.suppress(queue.Empty):
                kind().get(timeout=0.25)
        """,
        1.0,
    ),
    Row(
        "concurrent.futures.ThreadPoolExecutor, wait, as_completed",
        Does.VIRTUAL,
        """
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            list(concurrent.futures.as_completed([pool.submit(time.sleep, 0.25) for _ in range(2)]))
        """,
        0.25,
    ),
    Row(
        "sched.scheduler",
        Does.VIRTUAL,
        """
        plan = sched.scheduler()
        plan.enter(0.25, 1, int)
        plan.run()
        """,
        0.25,
    ),
    Row("asyncio.sleep", Does.VIRTUAL, "asyncio.run(asyncio.sleep(0.25))", 0.25),
    Row(
        "asyncio.wait_for, timeout, wait",
        Does.VIRTUAL,
        """
        with contextlib.suppress(asyncio.TimeoutError):
            asyncio.run(asyncio.wait_for(asyncio.sleep(5), 0.25))
        """,
        0.25,
    ),
    Row(
        "asyncio.to_thread, run_in_executor",
        Does.VIRTUAL,
        "asyncio.run(asyncio.to_thread(time.sleep, 0.25))",
        0.25,
    ),
    Row(
        "signal.setitimer, getitimer, alarm with SIGALRM",
        Does.VIRTUAL,
        """
        rings = []
        signal.signal(signal.SIGALRM, lambda *_: rings.append(time.monotonic()))
        signal.setitimer(signal.ITIMER_REAL, 0.1, 0.1)
        began = time.monotonic()
        time.sleep(0.25)
        assert [round(each - began, 6) for each in rings] == [0.1, 0.2]
        assert round(signal.getitimer(signal.ITIMER_REAL)[0], 6) == 0.05
        signal.alarm(0)
        """,
        0.25,
    ),
    Row(
        "signal.pause",
        Does.VIRTUAL,
        """
        signal.signal(signal.SIGALRM, lambda *_: None)
        signal.setitimer(signal.ITIMER_REAL, 0.25)
        signal.pause()
        """,
        0.25,
    ),
    Row(
        "os.kill, signal.raise_signal, pthread_kill to itself",
        Does.VIRTUAL,
        """
        came = []
        signal.signal(signal.SIGUSR1, lambda number, _: came.append(number))
        after(0.1, os.kill, os.getpid(), signal.SIGUSR1)
        time.sleep(0.25)
        assert came == [signal.SIGUSR1]
        """,
        0.25,
    ),
    Row(
        "time.time, time_ns",
        Does.VIRTUAL,
        """
        assert 1_700_000_000 <= time.time() < 1_700_100_000
        virtual(time.time_ns() / 1e9)
        """,
    ),
    Row(
        "time.monotonic, perf_counter, and in ns",
        Does.VIRTUAL,
        "assert time.monotonic() == time.perf_counter()",
    ),
    Row(
        "time.localtime, gmtime, ctime, asctime, strftime",
        Does.VIRTUAL,
        """
        virtual(time.mktime(time.localtime()))
        assert time.gmtime() == time.gmtime(time.time())
        assert time.ctime() == time.asctime() == time.ctime(time.time())
        assert time.strftime("%Y") == time.strftime("%Y", time.localtime()) == "2023"
        """,
    ),
    Row(
        "time.clock_gettime, clock_gettime_ns",
        Does.VIRTUAL,
        """
        virtual(time.clock_gettime(time.CLOCK_REALTIME))
        assert time.clock_gettime_ns(time.CLOCK_MONOTONIC) == time.monotonic_ns()
        """,
    ),
    Row(
        "time.process_time, thread_time, os.times: computing takes none",
        Does.VIRTUAL,
        "assert time.process_time() == time.thread_time() == os.times().user == 0",
    ),
    Row(
        "datetime.datetime.now, utcnow, today",
        Does.VIRTUAL,
        """
        from datetime import datetime as imported
        class Own(imported):
            pass
        zone = datetime.timezone(datetime.timedelta(hours=2))
        for told in (imported.now(), imported.today(), imported.now(zone), Own.now()):
            assert told.timestamp() == time.time()
        assert imported.utcnow().replace(tzinfo=datetime.timezone.utc).timestamp() == time.time()
        assert type(Own.now()) is Own and type(imported.now()) is imported
        """,
    ),
    Row(
        "datetime.date.today", Does.VIRTUAL, "assert datetime.date.today() == datetime.datetime.now().date()"
    ),
    Row(
        "logging's stamps",
        Does.VIRTUAL,
        """
        record = logging.makeLogRecord({})
        assert record.created == time.time()
        assert abs(record.relativeCreated - time.monotonic() * 1e3) < 1
        """,
    ),
    Row(
        "email.utils.formatdate, localtime",
        Does.VIRTUAL,
        """
        virtual(email.utils.mktime_tz(email.utils.parsedate_tz(email.utils.formatdate())))
        virtual(email.utils.localtime().timestamp())
        """,
    ),
    Row(
        "subprocess.run, call, Popen.wait, communicate",
        Does.HOLDS,
        """
        subprocess.run(["sleep", "0.25"])
        assert subprocess.check_output("sleep 0.1; echo said", shell=True, text=True) == "said\\n"
        """,
        0.35,
    ),
    Row(
        "subprocess with timeout=",
        Does.HOLDS,
        """
        for wait in (
            lambda: subprocess.run(["sleep", "9"], timeout=0.2),
            lambda: subprocess.run(["sleep", "9"], timeout=0.2, stdout=subprocess.PIPE),
        ):
            try:
                wait()
            except subprocess.TimeoutExpired:
                continue
            raise AssertionError
        """,
        0.4,
    ),
    Row(
        "Popen.poll in a loop",
        Does.HOLDS,
        """
        process = subprocess.Popen(["sleep", "0.25"])
        while process.poll() is None:
            time.sleep(0.05)
        """,
        0.25,
    ),
    Row(
        "Popen.stdout, os.fdopen, os.popen",
        Does.HOLDS,
        """
        process = subprocess.Popen("echo a; sleep 0.2; echo b", shell=True, stdout=subprocess.PIPE, text=True)
        assert list(process.stdout) == ["a\\n", "b\\n"]
        process.wait()
        with os.popen("sleep 0.1; echo c") as lines:
            assert lines.read() == "c\\n"
        reader, writer = os.pipe()
        with os.fdopen(writer, "w") as text:
            thread(lambda: (time.sleep(0.1), os.fdopen(reader).read()))
            text.write("x" * 200_000)
        """,
        0.4,
    ),
    Row(
        "os.system", Does.HOLDS, "assert os.waitstatus_to_exitcode(os.system('sleep 0.2; exit 3')) == 3", 0.2
    ),
    Row(
        "os.posix_spawn, wait, wait3, wait4, waitpid, waitid",
        Does.HOLDS,
        """
        for wait in (
            lambda pid: os.wait(),
            lambda pid: os.wait3(0),
            lambda pid: os.wait4(pid, 0),
            lambda pid: os.waitpid(pid, 0),
            lambda pid: os.waitid(os.P_PID, pid, os.WEXITED),
        ):
            wait(os.posix_spawnp("sleep", ["sleep", "0.1"], os.environ))
        """,
        0.5,
    ),
    Row(
        "select.select",
        Does.HOLDS,
        "assert select.select([os.pipe()[0]], [], [], 0.25) == ([], [], [])",
        0.25,
    ),
    Row(
        "select.poll, epoll",
        Does.HOLDS,
        """
        reader, writer = os.pipe()
        for poller, wait in ((select.poll(), 200), (select.epoll(), 0.2)):
            poller.register(reader)
            assert poller.poll(wait) == []
        """,
        0.4,
    ),
    Row(
        "selectors",
        Does.HOLDS,
        """
        for kind in (selectors.DefaultSelector, selectors.PollSelector, selectors.SelectSelector):
            with kind() as selector:
                selector.register(os.pipe()[0], selectors.EVENT_READ)
                assert selector.select(0.1) == []
        """,
        0.3,
    ),
    Row(
        "os.read, os.write on pipes and terminals",
        Does.HOLDS,
        """
        for reader, writer in (os.pipe(), pty.openpty()):
            after(0.1, os.write, writer, b"x\\n")
            assert os.read(reader, 9).startswith(b"x")
        """,
        0.2,
    ),
    Row(
        "socket: recv, send, accept, connect, settimeout, makefile",
        Does.HOLDS,
        """
        with socket.create_server(("127.0.0.1", 0)) as server:
            def serve():
                connection, _ = server.accept()
                with connection:
                    time.sleep(0.2)
                    connection.sendall(b"x" * 500_000)
            thread(serve)
            with socket.create_connection(server.getsockname(), timeout=60) as client:
                assert len(client.makefile("rb").read()) == 500_000
            server.settimeout(0.1)
            with contextlib.suppress(TimeoutError):
                server.accept()
        """,
        0.3,
    ),
    Row("socket.getaddrinfo, gethostbyname", Does.HOLDS, "socket.getaddrinfo('127.0.0.1', 80)"),
    Row(
        "fcntl.flock, lockf",
        Does.HOLDS,
        """
        with tempfile.NamedTemporaryFile() as one, open(one.name) as other:
            fcntl.flock(one, fcntl.LOCK_EX)
            after(0.2, fcntl.flock, one, fcntl.LOCK_UN)
            fcntl.flock(other, fcntl.LOCK_EX)
        """,
        0.2,
    ),
    Row(
        "signal.sigwait, sigwaitinfo, sigtimedwait",
        Does.HOLDS,
        """
        old = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
        assert signal.sigtimedwait({signal.SIGALRM}, 0.1) is None
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        assert signal.sigwait({signal.SIGALRM}) == signal.SIGALRM
        signal.pthread_sigmask(signal.SIG_SETMASK, old)
        """,
        0.2,
    ),
    Row(
        "multiprocessing.Queue, Pipe, Event, Lock between threads",
        Does.HOLDS,
        """
        assert not multiprocessing.Event().wait(0.1)
        one, other = multiprocessing.Pipe()
        after(0.1, other.send, 7)
        assert one.recv() == 7
        with contextlib.suppress(queue.Empty):
            multiprocessing.Queue().get(timeout=0.1)
        """,
        0.3,
    ),
    Row(
        "multiprocessing.pool.ThreadPool",
        Does.HOLDS,
        """
        with ThreadPool(2) as pool:
            assert pool.map(lambda seconds: time.sleep(seconds), [0.2, 0.2]) == [None, None]
        """,
        0.2,
    ),
    Row(
        "asyncio's sockets, pipes and subprocesses",
        Does.HOLDS,
        """
        async def talk():
            process = await asyncio.create_subprocess_exec("sh", "-c", "sleep 0.1; echo a", stdout=-1)
            assert await process.communicate() == (b"a\\n", None)
            async def serve(reader, writer):
                await asyncio.sleep(0.1)
                writer.write(b"b")
                writer.close()
            async with await asyncio.start_server(serve, "127.0.0.1", 0) as server:
                reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
                assert await reader.read() == b"b"
                writer.close()
        asyncio.run(talk())
        """,
        0.2,
    ),
    Row(
        "multiprocessing.Process, Pool, ProcessPoolExecutor",
        Does.REFUSED,
        "multiprocessing.Process(target=int).start()",
    ),
    Row("os.fork, forkpty", Does.REFUSED, "os.fork()"),
    Row(
        "signal.setitimer with ITIMER_VIRTUAL, ITIMER_PROF",
        Does.REFUSED,
        "signal.setitimer(signal.ITIMER_PROF, 0.1)",
    ),
    Row("random's functions", Does.SEEDED, "print(random.random(), random.choice('abc'))\nrandom.seed()"),
    Row("random.Random()", Does.SEEDED, "print(random.Random().random())"),
    Row(
        "random.SystemRandom, secrets",
        Does.SEEDED,
        "print(random.SystemRandom().random(), secrets.token_hex())",
    ),
    Row("os.urandom, getrandom", Does.SEEDED, "print(os.urandom(8), os.getrandom(8))"),
    Row("uuid.uuid4, uuid1", Does.SEEDED, "print(uuid.uuid4(), uuid.uuid1())"),
    Row("the order of sets of strings", Does.SEEDED, "print({'a', 'b', 'c', 'd', 'e'}, hash('a'))"),
    Row(
        "numpy.random's functions, default_rng(), RandomState()",
        Does.SEEDED,
        """
        import numpy
        print(numpy.random.rand(), numpy.random.default_rng().random(), numpy.random.RandomState().rand())
        """,
    ),
    Row("tempfile's names", Does.NEW, "tempfile.TemporaryDirectory().cleanup()"),
    Row("resource.getrusage", Does.NEW, "resource.getrusage(resource.RUSAGE_SELF)"),
)


def table() -> str:
    """The rows as the page shows them."""
    return "".join(f"| `{row.call}` | {row.does} |\n" for row in ROWS)


def page_with(rows: str) -> str:
    """The page with these rows in the place of its own."""
    return _TABLE.sub(
        lambda _: f"| call | on virtual time |\n|---|---|\n{rows}", PAGE.read_text(encoding="utf-8")
    )


if __name__ == "__main__":
    PAGE.write_text(page_with(table()), encoding="utf-8")
