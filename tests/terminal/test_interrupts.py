"""Ctrl-C as a program ends: it is not lost."""

import subprocess
import sys
from pathlib import Path

import pytest

_ENDS_ITS_LOOP = """
import asyncio, os, signal, threading, time
from cbtui.terminal.interrupts import ending_signals_on_loop

async def main():
    stay = threading.Event()
    threading.Thread(target=stay.wait, daemon=True).start()
    loop = asyncio.get_running_loop()
    remove = loop.remove_signal_handler

    def press_and_remove(number):
        if not pressed:
            pressed.append(number)
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.1)  # for the other thread
        return remove(number)

    loop.remove_signal_handler = press_and_remove
    with ending_signals_on_loop(print):
        pass

pressed = []
try:
    asyncio.run(main())
except KeyboardInterrupt:
    print("interrupted")
"""

_ENDS_AFTER_AN_IMPORT = """
from cbtui.terminal import interrupts

interrupts.install()
try:
    import interrupted_import
    interrupts.ignore()
except KeyboardInterrupt:
    print("interrupted")
"""

_MAKES_A_DECODER = """
import enum, signal, sys
import msgspec
from cbtui.terminal import interrupts

class Colour(enum.Enum):
    RED = "red"

def press(frame, event, argument):
    if event == "call" and frame.f_code.co_filename == enum.__file__:
        sys.setprofile(None)
        signal.raise_signal(signal.SIGINT)

interrupts.install()
sys.setprofile(press)
try:
    msgspec.msgpack.Decoder(Colour)
    if sys.getprofile():  # of this Python's enum msgspec calls nothing
        signal.raise_signal(signal.SIGINT)
    interrupts.ignore()
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="its loop handles no signals")
def test_ctrl_c_that_another_thread_takes_as_the_handlers_go_is_not_lost() -> None:
    done = subprocess.run([sys.executable, "-c", _ENDS_ITS_LOOP], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("interrupted\n", "")


@pytest.mark.skipif(sys.platform == "win32", reason="it has no timers that signal")
def test_ctrl_c_in_the_last_import_is_not_lost_where_nothing_is_left_to_do(tmp_path: Path) -> None:
    (tmp_path / "interrupted_import.py").write_text("import signal\n\nsignal.raise_signal(signal.SIGINT)\n")
    done = subprocess.run(
        [sys.executable, "-c", _ENDS_AFTER_AN_IMPORT],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stdout, done.stderr) == ("interrupted\n", "")


@pytest.mark.skipif(sys.platform == "win32", reason="it has no timers that signal")
def test_ctrl_c_in_what_msgspec_calls_of_an_enum_is_not_swallowed() -> None:
    done = subprocess.run(
        [sys.executable, "-c", _MAKES_A_DECODER], capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("interrupted\n", "")
