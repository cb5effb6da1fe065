"""What a program finds as on a machine with its workspace sourced: packages, the launch system, asyncio."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from sim.engine.setup import ProgramSetup, RunSetup
from sim.trace.events import Printed
from tests.support.engine_runs import SECOND, Run, run_to_end


def run_in_workspace(
    folder: Path, files: dict[str, str], *programs: str, edited: Mapping[str, str] = MappingProxyType({})
) -> Run:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return run_to_end(
        RunSetup(
            title="sourced",
            programs=tuple(ProgramSetup(str(folder / each), ()) for each in programs),
            texts={str(folder / name): text for name, text in edited.items()},
            speed=None,
            until=10 * SECOND,
        )
    )


def printed(run: Run) -> list[str]:
    return [event.text for event in run.events if isinstance(event, Printed) and not event.error]


PACKAGE = {
    "src/talk/package.xml": "<package><name>talk</name></package>",
    "src/talk/setup.py": (
        "from setuptools import setup\n"
        "setup(name='talk', data_files=[('share/talk', ['package.xml'])], entry_points={})\n"
    ),
    "src/talk/talk/__init__.py": "",
    "src/talk/talk/words.py": "GREETING = 'hello'\n",
}


def test_a_file_of_a_package_imports_its_own_package_by_name(tmp_path: Path) -> None:
    files = {**PACKAGE, "src/talk/talk/main.py": "from talk.words import GREETING\nprint(GREETING)\n"}
    run = run_in_workspace(tmp_path, files, "src/talk/talk/main.py")
    assert printed(run) == ["hello"]


def test_a_file_imports_other_packages_of_its_workspace(tmp_path: Path) -> None:
    files = {
        **PACKAGE,
        "src/other/package.xml": "<package><name>other</name></package>",
        "src/other/setup.py": "from setuptools import setup\nsetup(name='other')\n",
        "src/other/other/__init__.py": "",
        "src/other/other/main.py": "import talk.words\nprint(talk.words.GREETING)\n",
    }
    run = run_in_workspace(tmp_path, files, "src/other/other/main.py")
    assert printed(run) == ["hello"]


def test_edited_texts_of_packages_and_programs_are_run_and_the_files_stay(tmp_path: Path) -> None:
    main, words = "src/talk/talk/main.py", "src/talk/talk/words.py"
    said = "from talk.words import GREETING\nprint(GREETING)\n"
    edited = {main: f"{said}print('at last')\n1 / 0  # no\n", words: "GREETING = 'good bye'\n"}
    run = run_in_workspace(tmp_path, {**PACKAGE, main: said}, main, edited=edited)
    assert printed(run) == ["good bye", "at last"]
    errors = [event.text.strip() for event in run.events if isinstance(event, Printed) and event.error]
    assert "1 / 0  # no" in errors, "a traceback shows the line that was run"
    assert (tmp_path / words).read_text() == PACKAGE[words]


def test_a_node_asks_for_share_folders(tmp_path: Path) -> None:
    program = (
        "from ament_index_python.packages import get_package_share_directory\n"
        "import os\n"
        "print(os.listdir(get_package_share_directory('talk')))\n"
    )
    run = run_in_workspace(tmp_path, {**PACKAGE, "src/talk/talk/main.py": program}, "src/talk/talk/main.py")
    assert printed(run) == ["['package.xml']"]


def test_a_module_that_nobody_has_stays_unknown(tmp_path: Path) -> None:
    run = run_in_workspace(tmp_path, {"a.py": "import nobody_has_this\n"}, "a.py")
    assert "No module named 'nobody_has_this'" in run.ending.reason


def test_a_python_package_of_ros_that_is_not_here_is_named_as_such(tmp_path: Path) -> None:
    run = run_in_workspace(tmp_path, {"a.py": "import nav2_simple_commander.robot_navigator\n"}, "a.py")
    assert "a.py:1" in run.ending.reason
    assert "nav2_simple_commander belongs to a ROS 2 machine and is not modelled here" in run.ending.reason


ASYNCIO = """
import asyncio
import time
import rclpy
from std_srvs.srv import Trigger

async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.25)

async def ask(node):
    client = node.create_client(Trigger, "ask")
    await asyncio.sleep(1.0)
    reply = await client.call_async(Trigger.Request())
    return reply.message

async def answer(request, response):
    response.message = "answer"
    return response

def main():
    rclpy.init()
    node = rclpy.create_node("n")
    node.create_service(Trigger, "ask", answer)
    began = time.monotonic()
    spinning = asyncio.ensure_future(spin(node))
    reply = asyncio.get_event_loop().run_until_complete(ask(node))
    spinning.cancel()
    print(reply, round(time.monotonic() - began, 3))

main()
"""


def test_asyncio_lives_on_virtual_time_and_awaits_rclpys_futures(tmp_path: Path) -> None:
    run = run_in_workspace(tmp_path, {"a.py": ASYNCIO}, "a.py")
    assert printed(run) == ["answer 1.5"]
    assert not run.ending.failed


def test_each_of_several_programs_has_an_event_loop_of_its_own(tmp_path: Path) -> None:
    run = run_in_workspace(tmp_path, {"a.py": ASYNCIO, "b.py": ASYNCIO.replace("ask", "beg")}, "a.py", "b.py")
    assert printed(run) == ["answer 1.5"] * 2
