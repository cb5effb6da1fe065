"""The pytest plugin in a fresh project with one node: what its tests see, and what their failures tell."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sim.recording import read
from tests.support.daily import first_daily, first_slow

NODE = """
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32

class Line(Node):
    def __init__(self):
        super().__init__("line")
        self.parts = self.create_publisher(Int32, "parts", 10)
        self.create_timer(0.1, self.send)
        self.create_timer(1.0, self.press)
        self.create_subscription(Int32, "parts", self.take, 10)

    def send(self):
        self.parts.publish(Int32(data=1))

    def press(self):
        time.sleep(0.5)

    def take(self, part):
        self.get_logger().info("took one")

def main():
    rclpy.init()
    rclpy.spin(Line())

if __name__ == "__main__":
    main()
"""
TESTS = """
import pytest

pytestmark = pytest.mark.cbtui(seconds=2)

def test_green(cbtui):
    run = cbtui("line.py")
    run.has_no_deadlock().never_raises().logs("took one", at_least=10).callback("send").is_called(at_least=10)
    run.begins_in_order("send", "take", "press")
    run.callback("take").never_gets_ahead_of("send").callback("/parts").never_loses_messages()

@pytest.mark.cbtui(schedules=2)
def test_red(cbtui):
    run = cbtui("line.py")
    run.callback("take").never_waits_longer_than(0.1)

def test_equal(cbtui):
    assert cbtui("line.py").digest == cbtui("line.py").digest
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "line.py").write_text(NODE)
    (tmp_path / "test_line.py").write_text(TESTS)
    (tmp_path / "pytest.ini").write_text("[pytest]\nfilterwarnings = error\n")
    return tmp_path


def pytest_in(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *words]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("workers", first_daily("0", "2"))
def test_a_fresh_project_has_a_green_a_red_and_an_equal_test(project: Path, workers: str) -> None:
    run = pytest_in(project, "-n", workers)
    assert run.returncode == 1
    assert "1 failed, 2 passed" in run.stdout, run.stdout + run.stderr
    told = "\n".join(line.removeprefix("E").strip() for line in run.stdout.splitlines())
    assert "not so: take never waits too long\n" in told
    assert re.search(
        r"expected a wait of at most 0\.1 s; saw a wait of 0\.\d s, group A held by press, at [01]\.\d{3} s",
        told,
    )
    assert "not so in 2 of 2 schedules, this one is --cbtui-seed 0" in told
    assert "! take and send waited up to 500 ms: group A was held by press." in told
    assert re.search(r"^press +│.*│", told, re.MULTILINE)
    (recorded,) = (project / "cbtui-recordings").iterdir()
    assert f"recording: cbtui replay cbtui-recordings/{recorded.name}" in told
    assert recorded.name == "test_line-test_red.mcap"
    assert "/parts" in {topic.name for topic in read(recorded).topics()}


@pytest.mark.timeout(1500)
@pytest.mark.parametrize("times", first_slow(10, 1000))
def test_all_repeats_are_equal(project: Path, times: int) -> None:
    (project / "test_line.py").write_text(
        "import pytest\n"
        "@pytest.mark.cbtui(seconds=2)\n"
        f"@pytest.mark.parametrize('repeat', range({times}))\n"
        "def test_equal(cbtui, repeat):\n"
        "    with open(f'digests-{repeat % 2}', 'a') as file:\n"
        "        print(cbtui('line.py').digest, file=file)\n"
    )
    run = pytest_in(project, "-q", "-n", "2")
    assert run.returncode == 0, run.stdout
    digests = "".join((project / f"digests-{half}").read_text() for half in (0, 1)).split()
    assert len(digests) == times
    assert len(set(digests)) == 1


@pytest.mark.bulk
def test_what_cannot_be_run_is_told_in_a_sentence(project: Path) -> None:
    (project / "test_line.py").write_text(
        "import pytest\n"
        "def test_unknown_file(cbtui):\n"
        "    cbtui('lime.py')\n"
        "@pytest.mark.cbtui(second=3)\n"
        "def test_unknown_term(cbtui):\n"
        "    cbtui('line.py')\n"
        "def test_group(cbtui):\n"
        "    cbtui('line.py', groups={'take': 'mine'})\n"
        "def test_raises(cbtui):\n"
        "    cbtui('broken.py')\n"
    )
    (project / "broken.py").write_text("raise ValueError('no')\n")
    run = pytest_in(project, "-q")
    assert "there is no file lime.py beside the test" in run.stdout
    assert "cbtui knows no second=; there are seconds, calls" in run.stdout
    assert "'mine' is not a group; give own, shared" in run.stdout
    assert "ValueError: no" in run.stdout


@pytest.mark.slow
def test_a_failure_tells_the_log_the_order_of_threads_and_names_that_exist(project: Path) -> None:
    (project / "test_line.py").write_text(
        "def test_log(cbtui):\n"
        "    cbtui('line.py', seconds=0.5, seed='moves:1=1').logs('took two')\n"
        "def test_name(cbtui):\n"
        "    cbtui('line.py', seconds=0.5).callback('tack').is_never_called()\n"
        "def test_raises(cbtui):\n"
        "    cbtui('broken.py', schedules=2).logs('took two')\n"
    )
    (project / "broken.py").write_text("raise ValueError('no')\n")
    run = pytest_in(project, "-q")
    assert "3 failed" in run.stdout
    told = " ".join(line.removeprefix("E").strip() for line in run.stdout.splitlines())
    assert (
        "the program itself fails in 2 of 2 schedules, this one is --cbtui-seed 0; "
        "what is asked of the run after this was not looked at"
    ) in told
    assert "order of threads: --cbtui-seed moves:1=1" in run.stdout
    assert re.search(r"^\[INFO\] \[1700000000\.\d+\] \[line\]: took one$", run.stdout, re.MULTILINE)
    assert "no callback, topic or service is named tack; callbacks: send, press, take" in run.stdout
    assert "the usual order of threads, --cbtui-seed 0" in run.stdout
    again = pytest_in(project, "-q", "--cbtui-seed", "moves:1=1", "-k", "test_name")
    assert "order of threads: --cbtui-seed moves:1=1" in again.stdout


LOST_UPDATE = """
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.count = 0
        group = ReentrantCallbackGroup()
        self.create_timer(0.01, self.one, callback_group=group)
        self.create_timer(0.01, self.other, callback_group=group)

    def one(self):
        self.add()

    def other(self):
        self.add()

    def add(self):
        before = self.count
        self.count = before + 1
        self.get_logger().info(f"counted {self.count}")

def main():
    rclpy.init()
    executor = MultiThreadedExecutor(2)
    executor.add_node(Counter())
    executor.spin()
"""


@pytest.mark.slow
def test_a_lost_update_is_told_with_its_accesses(project: Path) -> None:
    (project / "counter.py").write_text(LOST_UPDATE)
    (project / "test_line.py").write_text(
        "def test_count(cbtui):\n    cbtui('counter.py', seconds=0.305, schedules=4).logs('counted 60')\n"
    )
    run = pytest_in(project, "-q")
    assert "1 failed" in run.stdout, run.stdout
    assert re.search(r"in \d+ of 4 schedules, this one is --cbtui-seed \d+", run.stdout)
    assert re.search(r"conflict: count: counter\.py:\d+ \(\w+\) reads it, then ", run.stdout)


@pytest.mark.bulk
def test_a_package_of_the_project_that_hides_one_of_cbtuis_is_named(project: Path) -> None:
    (project / "sim").mkdir()
    (project / "sim" / "__init__.py").touch()
    (project / "sim" / "world.py").touch()
    (project / "test_line.py").write_text(
        "import sim.world\ndef test_own(): pass\ndef test_line(cbtui): cbtui('line.py')\n"
    )
    run = pytest_in(project, "-q", "-p", "no:xdist")
    assert "1 passed, 1 error" in run.stdout, run.stdout
    assert f"cbtui's own package sim is hidden by {project / 'sim' / '__init__.py'}; rename" in run.stdout


@pytest.mark.parametrize("workers", first_slow("0", "2"))
def test_a_package_of_cbtuis_that_hides_one_of_the_project_is_named(project: Path, workers: str) -> None:
    (project / "test_line.py").write_text("import sim.conveyor\ndef test_own(): pass\n")
    (project / "test_late.py").write_text("def test_late():\n    from lessons import mine\n")
    run = pytest_in(project, "-q", "-n", workers)
    assert re.search(r"/sim is cbtui's own package sim, which hides yours; rename yours\n", run.stdout)
    run = pytest_in(project, "-q", "-n", workers, "test_late.py")
    assert re.search(
        r"/lessons is cbtui's own package lessons, which hides yours; rename yours\n", run.stdout
    )


@pytest.mark.slow
def test_a_lesson_and_a_file_in_its_place_are_judged_by_its_checks(project: Path) -> None:
    (project / "test_line.py").write_text(
        "from lessons.catalogue import find\n"
        "lesson = find('split-groups')\n"
        "def test_solution(cbtui):\n"
        "    cbtui('split-groups', lesson.solution_path).passes_its_checks()\n"
        "def test_starter(cbtui):\n"
        "    cbtui('split-groups', lesson.starter_path).passes_its_checks()\n"
    )
    run = pytest_in(project, "-q")
    assert "1 failed, 1 passed" in run.stdout
    assert "not so: " in run.stdout


@pytest.mark.bulk
def test_a_program_has_the_environment_that_its_test_sets(project: Path) -> None:
    (project / "test_line.py").write_text(
        "def test_environment(cbtui, monkeypatch):\n"
        "    cbtui('env.py').logs('HELLO is None')\n"
        "    monkeypatch.setenv('HELLO', 'there')\n"
        "    cbtui('env.py').logs('HELLO is there')\n"
    )
    (project / "env.py").write_text("import os\nprint('HELLO is', os.environ.get('HELLO'))\n")
    run = pytest_in(project, "-q")
    assert "1 passed" in run.stdout, run.stdout
