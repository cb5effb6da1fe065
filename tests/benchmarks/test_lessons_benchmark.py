"""What a virtual minute of a lesson costs, engine process and all, and what starting the command does."""

import subprocess
import sys

import pytest
from pytest_benchmark.fixture import BenchmarkFixture


def _run(*arguments: str) -> None:
    command = [sys.executable, "-m", "cbtui", *arguments]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.parametrize("lesson", ["single-thread", "split-groups", "reentrant-2-threads"])
def test_a_virtual_minute(benchmark: BenchmarkFixture, lesson: str) -> None:
    benchmark.pedantic(lambda: _run("run", lesson, "--for", "60"), rounds=3, warmup_rounds=1)


def test_help(benchmark: BenchmarkFixture) -> None:
    benchmark.pedantic(lambda: _run("--help"), rounds=5, warmup_rounds=1)


MENU = """
import asyncio
from cbtui.app import CbtuiApp

async def first_frame():
    async with CbtuiApp().run_test(size=(140, 40)):
        pass

asyncio.run(first_frame())
"""


def test_the_menu_from_process_start_to_end(benchmark: BenchmarkFixture) -> None:
    def run() -> None:
        subprocess.run([sys.executable, "-c", MENU], check=True)

    benchmark.pedantic(run, rounds=5, warmup_rounds=1)
