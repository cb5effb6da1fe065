"""The process that takes pictures: one answer for each request, until the pipe is closed."""

import os
import signal
from multiprocessing.connection import Connection

import msgspec

from sim.camera.wire import NoCamera, Picture, Shot


def serve(pipe: Connection) -> None:
    """Answer every shot with a picture; answer the first that fails with the reason, and return.

    Returns, too, when the other end of the pipe is closed.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # ctrl+c is for the console
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # read when numpy is imported
    from sim.robot.bullet import WorldUnavailable, silence

    with silence():  # the terminal belongs to the console
        try:
            _answer_all(pipe)
        except (EOFError, OSError):
            return
        except WorldUnavailable as error:
            _refuse(pipe, str(error))
        except Exception as error:  # noqa: BLE001 -- a trace may describe any world
            _refuse(pipe, f"The camera cannot draw this world ({type(error).__name__}: {error}).")


def _refuse(pipe: Connection, why: str) -> None:
    pipe.send_bytes(msgspec.msgpack.encode(NoCamera(why)))


def _answer_all(pipe: Connection) -> None:
    from sim.camera.renderer import Renderer

    drawn: tuple[object, ...] = ()
    renderer: Renderer | None = None
    decoder = msgspec.msgpack.Decoder(Shot)
    while True:
        shot = decoder.decode(pipe.recv_bytes())
        if renderer is None or drawn != (shot.walls, shot.sphere):
            if renderer is not None:
                renderer.close()
            drawn, renderer = (shot.walls, shot.sphere), Renderer(shot.walls, shot.sphere)
        picture = Picture(shot.width, shot.height, renderer.take(shot).tobytes())
        pipe.send_bytes(msgspec.msgpack.encode(picture))
