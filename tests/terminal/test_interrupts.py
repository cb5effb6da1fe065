"""Ctrl-C as a program that has an event loop ends."""

import subprocess
import sys

import pytest

_PROGRAM = """
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


@pytest.mark.skipif(sys.platform == "win32", reason="its loop handles no signals")
def test_ctrl_c_that_another_thread_takes_as_the_handlers_go_is_not_lost() -> None:
    done = subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("interrupted\n", "")
