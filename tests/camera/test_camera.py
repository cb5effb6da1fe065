"""The process that takes pictures: when it runs, what it takes, and that it ends."""

import os
import select
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from queue import Queue

import msgspec
import pytest

from sim.camera import Camera, Picture
from sim.camera.process import serve
from sim.camera.wire import Shot
from tests.camera.shots import shot
from tests.support.physics import with_pybullet

PATIENCE = 60.0


def echo(pipe: Connection) -> None:
    """Answer with pictures of the size asked for that show nothing."""
    while True:
        try:
            asked = msgspec.msgpack.decode(pipe.recv_bytes(), type=Shot)
        except EOFError:
            return
        pipe.send_bytes(msgspec.msgpack.encode(Picture(asked.width, asked.height, b"")))


def without_pybullet(pipe: Connection) -> None:
    sys.modules["pybullet"] = None  # type: ignore[assignment]  # makes its import fail
    serve(pipe)


class Taken:
    """A camera, and what came from it."""

    def __init__(self, target: Callable[[Connection], None]) -> None:
        self.pictures: Queue[Picture] = Queue()
        self.losses: Queue[str] = Queue()
        self.camera = Camera(self.pictures.put, self.losses.put, target)

    def next(self) -> Picture:
        return self.pictures.get(timeout=PATIENCE)


@pytest.fixture
def take() -> Iterator[Callable[[Callable[[Connection], None]], Taken]]:
    made: list[Taken] = []

    def make(target: Callable[[Connection], None]) -> Taken:
        made.append(Taken(target))
        return made[-1]

    yield make
    for taken in made:
        taken.camera.stop()


Take = Callable[[Callable[[Connection], None]], Taken]


def test_no_process_runs_before_a_picture_is_wanted(take: Take) -> None:
    taken = take(echo)
    assert taken.camera.process is None
    taken.camera.want(shot())
    assert taken.camera.process is not None


@with_pybullet
def test_a_picture_comes_as_it_was_asked_for_and_the_terminal_hears_nothing(
    take: Take, capfd: pytest.CaptureFixture[str]
) -> None:
    taken = take(serve)
    taken.camera.want(shot(width=20, height=10))
    picture = taken.next()
    taken.camera.stop()
    assert (picture.width, picture.height, len(picture.pixels)) == (20, 10, 600)
    assert len(set(picture.pixels)) > 10
    assert capfd.readouterr() == ("", "")


@with_pybullet
def test_one_process_takes_pictures_of_another_arena_too(take: Take) -> None:
    taken = take(serve)
    taken.camera.want(shot())
    first = taken.next()
    taken.camera.want(msgspec.structs.replace(shot(), sphere=(0.0, 5.0, 0.2)))
    assert taken.next() != first


def test_of_the_pictures_wanted_during_another_only_the_newest_is_taken() -> None:
    sizes: Queue[int] = Queue()
    go_on = threading.Semaphore(0)

    def deliver(picture: Picture) -> None:
        sizes.put(picture.width)
        go_on.acquire(timeout=PATIENCE)

    camera = Camera(deliver, lambda _: None, echo)
    camera.want(shot(width=1))
    assert sizes.get(timeout=PATIENCE) == 1
    for wanted in ((2, 3, 4), (5, 6), (7,)):
        for width in wanted:
            camera.want(shot(width=width))
        go_on.release()
        assert sizes.get(timeout=PATIENCE) == wanted[-1]
    go_on.release()
    camera.stop()
    assert sizes.empty()


def test_stopping_ends_the_process_and_says_nothing(take: Take) -> None:
    taken = take(echo)
    taken.camera.want(shot())
    taken.next()
    taken.camera.stop()
    taken.camera.stop()
    taken.camera.want(shot())
    process = taken.camera.process
    assert process is not None
    assert not process.is_alive()
    assert taken.losses.empty()


def test_a_camera_that_was_never_used_can_be_stopped(take: Take) -> None:
    taken = take(echo)
    taken.camera.stop()
    taken.camera.want(shot())
    assert taken.camera.process is None


def test_a_process_that_dies_is_told_of(take: Take) -> None:
    taken = take(echo)
    taken.camera.want(shot())
    taken.next()
    process = taken.camera.process
    assert process is not None
    process.kill()
    assert "has ended" in taken.losses.get(timeout=PATIENCE)


def test_without_pybullet_a_sentence_says_what_to_do(take: Take) -> None:
    taken = take(without_pybullet)
    taken.camera.want(shot())
    why = taken.losses.get(timeout=PATIENCE)
    assert "PyBullet cannot be imported" in why
    assert "cbtui doctor" in why


@with_pybullet
def test_a_world_that_cannot_be_drawn_is_told_of_and_the_terminal_hears_nothing(
    take: Take, capfd: pytest.CaptureFixture[str]
) -> None:
    taken = take(serve)
    taken.camera.want(msgspec.structs.replace(shot(), walls=((1.0, 1.0, 1.0, 1.0),)))
    assert "cannot draw this world" in taken.losses.get(timeout=PATIENCE)
    process = taken.camera.process
    assert process is not None
    process.join(PATIENCE)
    assert process.exitcode == 0
    assert capfd.readouterr() == ("", "")


CONSOLE = """
import time
from sim.camera import Camera
from tests.camera.shots import shot

if __name__ == "__main__":
    camera = Camera(lambda picture: print(camera.process.pid, flush=True), print)
    camera.want(shot())
    time.sleep(600)
"""


@with_pybullet
@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="watches another's child, which Linux alone can")
def test_the_process_ends_when_the_console_is_killed() -> None:
    console = subprocess.Popen([sys.executable, "-c", CONSOLE], stdout=subprocess.PIPE, text=True)
    assert console.stdout is not None
    camera = os.pidfd_open(int(console.stdout.readline()))
    console.kill()
    console.wait()
    console.stdout.close()
    ended, _, _ = select.select([camera], [], [], PATIENCE)
    os.close(camera)
    assert ended
