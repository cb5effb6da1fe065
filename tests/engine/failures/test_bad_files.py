"""What may be wrong with a learner's file: each is told in one sentence, and the engine goes on."""

from collections.abc import Mapping
from pathlib import Path
from queue import Queue
from typing import NamedTuple

import pytest

from cbtui import cli
from cbtui.engines.session import ProcessSession
from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.trace.events import AnyEvent, CallbackStarted, Notice, Printed, ProcessAppeared, ProcessEnded
from tests.support.builder import ns
from tests.support.daily import first_daily, first_row_daily
from tests.support.engine_runs import Run, program_setup, run_to_end

HEAD = """import sys
import rclpy
from rclpy.node import Node
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool
"""
NODE = HEAD + "rclpy.init(args=sys.argv)\nnode = Node('n')\n"
"""Eight lines; what follows begins in line 9."""


class Bad(NamedTuple):
    """A file, how the sentence about it begins, the program's arguments, and the files beside it."""

    source: str | bytes
    sentence: str
    arguments: tuple[str, ...] = ()
    beside: Mapping[str, str] = {}


RAISED = "the program raised"

FILES = {
    # What is no Python
    "a syntax error": Bad("import rclpy\ndef f(:\n    pass", "node.py:2: invalid syntax"),
    "a bracket left open": Bad("x = 1\nprint('a'\n\ny = 2", "node.py:2: '(' was never closed"),
    "no indentation": Bad("def f():\npass", "node.py:2: expected an indented block"),
    "tabs among spaces": Bad("def f():\n        x = 1\n\ty = 2", "node.py:3: inconsistent use of tabs"),
    "a binary": Bad(b"\x7fELF\x02\x01\x00\x00\xff", "node.py is not a Python file: it has null bytes in it"),
    "UTF-16": Bad("print(1)".encode("utf-16"), "node.py is not a Python file: it has null bytes in it"),
    "Latin-1 in a comment": Bad(
        b"# one\n# two\n# caf\xe9\nprint(1)",
        "node.py:3: the byte 0xe9 is not UTF-8; save the file as UTF-8, or name its coding in its first line",
    ),
    "Latin-1 in the first line": Bad(b"x = 'caf\xe9'", "node.py:1: the byte 0xe9 is not UTF-8"),
    "a coding that does not exist": Bad(
        "# -*- coding: klingon -*-\n", "node.py:1: unknown encoding: klingon"
    ),
    # Texts
    "raises what no encoding has": Bad(
        "raise ValueError('\\udc80')", f"node.py:1: {RAISED} ValueError: \\udc80"
    ),
    "raises several lines": Bad("raise ValueError('a\\n  b')", f"node.py:1: {RAISED} ValueError: a\n  b"),
    "raises what cannot tell what it is": Bad(
        "class E(Exception):\n    def __str__(self):\n        return 1 / 0\n\nraise E",
        f"node.py:5: {RAISED} E: <exception str() failed>",
    ),
    # Imports
    "a module that is not there": Bad(
        "import rclpy\nimport frobnicate",
        f"node.py:2: {RAISED} ModuleNotFoundError: No module named 'frobnicate'; frobnicate is neither",
    ),
    "a package of interfaces that is not there": Bad(
        "from geometry_msg.msg import Twist",
        f"node.py:1: {RAISED} ModuleNotFoundError: No module named 'geometry_msg'; "
        "did you mean 'geometry_msgs'?",
    ),
    "messages of a package of services": Bad(
        "from std_srvs.msg import SetBool",
        f"node.py:1: {RAISED} ModuleNotFoundError: No module named 'std_srvs.msg'; "
        "std_srvs has services only",
    ),
    "a message that is not there": Bad(
        "from std_msgs.msg import Strng",
        f"node.py:1: {RAISED} ImportError: cannot import name 'Strng' from 'std_msgs.msg'; "
        "did you mean 'String'?",
    ),
    "a name that rclpy does not have": Bad(
        "from rclpy.executors import MultithreadedExecutor",
        f"node.py:1: {RAISED} ImportError: cannot import name 'MultithreadedExecutor' from "
        "'rclpy.executors'; did you mean 'MultiThreadedExecutor'?",
    ),
    "a module that rclpy does not have": Bad(
        "import rclpy.callbackgroups",
        f"node.py:1: {RAISED} ModuleNotFoundError: No module named 'rclpy.callbackgroups'; "
        "did you mean 'rclpy.callback_groups'?",
    ),
    "a module beside it that is wrong": Bad(
        "import broken_beside",
        "broken_beside.py:1: invalid syntax",
        beside={"broken_beside.py": "def f(:"},
    ),
    "a module beside it that raises": Bad(
        "import beside\n\nbeside.go()",
        f"beside.py:2: {RAISED} KeyError: 'k'",
        beside={"beside.py": "def go():\n    raise KeyError('k')"},
    ),
    # What there is to run
    "nothing": Bad("", "node.py defines no main() and runs nothing at its top level; add a main()"),
    "no main": Bad(
        "class A:\n    pass", "node.py defines no main() and runs nothing at its top level; add a main()"
    ),
    "main in a class": Bad(
        "class A:\n    def main(args=None):\n        pass",
        "node.py: the main() of line 2 is indented into the class A; move it to the left margin",
    ),
    "main in a class and called": Bad(
        "class A:\n    def main(args=None):\n        pass\n\nif __name__ == '__main__':\n    main()",
        f"node.py:6: {RAISED} NameError: name 'main' is not defined; the main() of line 2 is indented into "
        "the class A; move it to the left margin",
    ),
    "main with an argument": Bad(
        "import rclpy\ndef main(args):\n    pass",
        "node.py:2: an entry point is called without arguments (missing a required argument: 'args'); "
        "give each a default, as in main(args=None)",
    ),
    # What it raises
    "raises at once": Bad("x = 1\nraise ValueError('no')", f"node.py:2: {RAISED} ValueError: no"),
    "raises without a text": Bad("raise RuntimeError", f"node.py:1: {RAISED} RuntimeError"),
    "a misprinted name": Bad(
        "import rclpy\nrcipy.shutdown()",
        f"node.py:2: {RAISED} NameError: name 'rcipy' is not defined; did you mean 'rclpy'?",
    ),
    "a class that is not imported": Bad(
        "from rclpy.executors import SingleThreadedExecutor\nMultiThreadedExecutor()",
        f"node.py:2: {RAISED} NameError: name 'MultiThreadedExecutor' is not defined; write from "
        "rclpy.executors import MultiThreadedExecutor",
    ),
    "raises in __init__": Bad(
        HEAD + "class A(Node):\n    def __init__(self):\n        super().__init__('a')\n"
        "        self.x = self.y\n\ndef main():\n    rclpy.init()\n    rclpy.spin(A())",
        f"node.py:10: {RAISED} AttributeError: 'A' object has no attribute 'y'",
    ),
    "no super().__init__": Bad(
        HEAD + "class A(Node):\n    def __init__(self):\n        self.create_timer(1.0, print)\n\n"
        "def main():\n    rclpy.init()\n    rclpy.spin(A())",
        f"node.py:9: {RAISED} AttributeError: 'A' object has no attribute '_node_entities'; "
        "A.__init__ has to call super().__init__('name of the node') first",
    ),
    "a method that hides one of Node's": Bad(
        HEAD + "rclpy.init()\nclass A(Node):\n    def handle(self):\n        pass\nA('a')\n",
        f"node.py:9: {RAISED} TypeError: 'method' object does not support the context manager protocol; "
        "A.handle hides Node.handle, which every node has; give it another name, such as my_handle",
    ),
    "an attribute that hides one of Node's": Bad(
        HEAD + "rclpy.init()\nclass A(Node):\n    rate = 5\n    handle = None\nA('a')\n",
        f"node.py:10: {RAISED} TypeError: 'NoneType' object does not support the context manager protocol; "
        "A.handle hides Node.handle",
    ),
    "an attribute that hides a method of Node's": Bad(
        NODE + "class A(Node):\n    def f(self):\n        self.get_clock = self.get_clock()\n"
        "        self.get_clock()\nA('a').f()",
        f"node.py:11: {RAISED} TypeError: 'ROSClock' object is not callable; A.get_clock hides Node",
    ),
    "raises in a callback": Bad(
        NODE + "def tick():\n    1 / 0\nnode.create_timer(1.0, tick)\nrclpy.spin(node)",
        f"node.py:10: {RAISED} ZeroDivisionError: division by zero",
    ),
    "raises in a callback of a pool": Bad(
        NODE + "def tick():\n    1 / 0\nnode.create_timer(1.0, tick)\n"
        "pool = MultiThreadedExecutor(2)\npool.add_node(node)\npool.spin()",
        f"node.py:10: {RAISED} ZeroDivisionError: division by zero",
    ),
    "a service that returns nothing": Bad(
        NODE + "def serve(request, response):\n    response.success = True\n"
        "node.create_service(SetBool, 's', serve)\n"
        "node.create_client(SetBool, 's').call_async(SetBool.Request())\nrclpy.spin(node)",
        f"node.py:13: {RAISED} TypeError: Expected <class 'std_srvs.srv._set_bool.SetBool_Response'>, "
        "got <class 'NoneType'>",
    ),
    "reads a file that is not there": Bad(
        "def main():\n    open('no_such_map.yaml')",
        f"node.py:2: {RAISED} FileNotFoundError: [Errno 2] No such file or directory: 'no_such_map.yaml'",
    ),
    "calls itself for ever": Bad("def f():\n    f()\nf()", f"node.py:2: {RAISED} RecursionError"),
    # How it ends
    "exits with a text": Bad("import sys\nsys.exit('no map')", "the program ended: no map (node.py:2)"),
    "exits with a number": Bad("import sys\nsys.exit(3)", "the program ended with exit code 3 (node.py:2)"),
    # What rclpy refuses
    "init twice": Bad(
        "import rclpy\nrclpy.init()\nrclpy.init()",
        f"node.py:3: {RAISED} RuntimeError: Context.init() must only be called once",
    ),
    "a node before init": Bad(
        HEAD + "Node('n')",
        f"node.py:7: {RAISED} NotInitializedException: rclpy.init() has not been called.",
    ),
    "a misprinted parameter": Bad(
        HEAD
        + "rclpy.init()\nclass A(Node):\n    def f(self):\n        self.declare_parameter('max_speed', 1.0)\n"
        "        self.get_parameter('maxspeed')\nA('a').f()",
        f"node.py:11: {RAISED} ParameterNotDeclaredException: Invalid access to undeclared parameter(s): "
        "maxspeed; did you mean 'max_speed'?",
    ),
    "a bad name of a topic": Bad(
        NODE + "node.create_publisher(Int32, 'my topic', 10)",
        f"node.py:9: {RAISED} InvalidTopicNameException: Invalid topic name: topic name must not contain "
        "characters other than alphanumerics, '_', '~', '{', or '}':\n  'my topic'\n     ^",
    ),
    "a bad name of a service": Bad(
        NODE + "node.create_service(SetBool, '1st', print)",
        f"node.py:9: {RAISED} InvalidServiceNameException: Invalid service name: "
        "topic name token must not start with a number",
    ),
    "a bad name of a node": Bad(
        "import rclpy\nrclpy.init()\nrclpy.create_node('my-node')",
        f"node.py:3: {RAISED} InvalidNodeNameException: Invalid node name: "
        "node name must not contain characters other than alphanumerics or '_':\n  'my-node'\n     ^",
    ),
    "another class published": Bad(
        NODE + "node.create_publisher(Int32, 't', 10).publish(String())",
        f"node.py:9: {RAISED} TypeError: Expected <class 'std_msgs.msg._int32.Int32'>, "
        "got <class 'std_msgs.msg._string.String'>",
    ),
    "a field of another type": Bad(
        "from std_msgs.msg import Int32\nInt32().data = 'a'",
        f"node.py:2: {RAISED} AssertionError: The 'data' field must be of type 'int'",
    ),
    "a field that is not there": Bad(
        "from geometry_msgs.msg import Twist\nTwist().liner.x = 1.0",
        f"node.py:2: {RAISED} AttributeError: 'Twist' object has no attribute 'liner'; "
        "did you mean 'linear'?",
    ),
    "no quality of service": Bad(
        NODE + "node.create_publisher(Int32, 't')",
        f"node.py:9: {RAISED} TypeError: Node.create_publisher() missing 1 required positional argument: "
        "'qos_profile'",
    ),
    "a parameter that is not declared": Bad(
        NODE + "node.get_parameter('speed')",
        f"node.py:9: {RAISED} ParameterNotDeclaredException: Invalid access to undeclared parameter(s): ",
    ),
    # Its arguments
    "an unknown ROS argument": Bad(
        NODE,
        f"node.py:7: {RAISED} UnknownROSArgsError: Found unknown ROS arguments: ['--frobnicate']",
        ("--ros-args", "--frobnicate"),
    ),
    "a parameter without a value": Bad(
        NODE,
        f"node.py:7: {RAISED} RCLError: failed to initialize rcl: Couldn't parse parameter override rule: "
        "'-p speed'",
        ("--ros-args", "-p", "speed"),
    ),
    "a parameter of another type": Bad(
        NODE + "node.declare_parameter('speed', 1)",
        f"node.py:9: {RAISED} InvalidParameterTypeException: Trying to set parameter 'speed' to 'fast' of "
        "type 'STRING', expecting type 'INTEGER'",
        ("--ros-args", "-p", "speed:=fast"),
    ),
    "a remapping that is none": Bad(
        NODE,
        f"node.py:7: {RAISED} RCLError: failed to initialize rcl: Couldn't parse remap rule: '-r a=b'",
        ("--ros-args", "-r", "a=b"),
    ),
    "a parameter file that is not there": Bad(
        NODE,
        f"node.py:7: {RAISED} RCLError: failed to initialize rcl: Couldn't parse params file: "
        "'--params-file /no/such.yaml'. Error: Error opening YAML file",
        ("--ros-args", "--params-file", "/no/such.yaml"),
    ),
    "a parameter file that is no YAML": Bad(
        NODE,
        f"node.py:7: {RAISED} RCLError: failed to initialize rcl: Couldn't parse params file: "
        "'--params-file {folder}/bad.yaml'. Error: ",
        ("--ros-args", "--params-file", "{folder}/bad.yaml"),
        beside={"bad.yaml": "n:\n  ros__parameters:\n    a: [1, 'x'\n"},
    ),
    "a parameter file of another form": Bad(
        NODE,
        f"node.py:7: {RAISED} RCLError: failed to initialize rcl: Couldn't parse params file: "
        "'--params-file {folder}/bad.yaml'. Error: Cannot have a value before ros__parameters at line 2",
        ("--ros-args", "--params-file", "{folder}/bad.yaml"),
        beside={"bad.yaml": "n:\n  a: 1\n"},
    ),
}
STATUS = {"exits with a number": 3}
GOOD = "import rclpy\nrclpy.init()\nnode = rclpy.create_node('good')\n" + (
    "node.create_timer(1.0, lambda: None)\nrclpy.spin(node)\n"
)


class Written(NamedTuple):
    """A bad file on the disk."""

    program: ProgramSetup
    sentence: str


def write(bad: Bad, folder: Path) -> Written:
    folder.mkdir()
    for name, text in {**bad.beside, "node.py": bad.source}.items():
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    arguments = tuple(each.replace("{folder}", str(folder)) for each in bad.arguments)
    program = ProgramSetup(str(folder / "node.py"), arguments)
    return Written(program, bad.sentence.replace("{folder}", str(folder)))


class Told(NamedTuple):
    """The run of all bad files together, and for each what should be said and what was."""

    run: Run
    expected: dict[str, str]
    ended: dict[str, ProcessEnded]


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> Told:
    """All bad files in one run, each as a process of its own, and a good one last."""
    folder = tmp_path_factory.mktemp("files")
    written = [write(bad, folder / str(place)) for place, bad in enumerate(FILES.values())]
    good = write(Bad(GOOD, ""), folder / "good").program
    run = run_to_end(
        RunSetup(
            title="bad files",
            programs=(*(each.program for each in written), good),
            speed=None,
            until=ns(3.5),
            robot=RobotUse.NEVER,
        )
    )
    ended = {event.process: event for event in run.events if isinstance(event, ProcessEnded)}
    return Told(
        run,
        dict(zip(FILES, (each.sentence for each in written), strict=True)),
        {name: ended[number] for number, name in enumerate(FILES, start=1)},
    )


@pytest.mark.parametrize("name", FILES)
def test_what_is_wrong_with_a_file_is_told_in_one_sentence_with_its_place(told: Told, name: str) -> None:
    ended = told.ended[name]
    assert ended.reason.startswith(told.expected[name])
    assert ended.status == STATUS.get(name, 1)


def test_bad_files_leave_the_engine_and_a_good_one_alone(told: Told) -> None:
    assert told.run.loss is None
    assert told.run.ending.t == ns(3.5)
    *_, good = (event.process for event in told.run.events if isinstance(event, ProcessAppeared))
    assert good == len(FILES) + 1
    timeline = told.run.timeline
    times = [event.t for event in told.run.events if isinstance(event, CallbackStarted)]
    assert times[-1] == ns(3)
    assert not [each for each in timeline.notices if each.severity == "error"]


def test_a_traceback_begins_in_the_learners_file(told: Told) -> None:
    number = 1 + list(FILES).index("raises in a callback")
    printed = [
        event.text for event in told.run.events if isinstance(event, Printed) and event.process == number
    ]
    assert printed[0] == "Traceback (most recent call last):"
    assert "node.py" in printed[1]
    assert printed[-1] == "ZeroDivisionError: division by zero"


@pytest.mark.parametrize(
    "name", first_daily("no main", "raises several lines", "a binary", "exits with a number")
)
def test_a_file_that_runs_alone_is_told_of_the_same_way_and_fails(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    written = write(FILES[name], tmp_path / "alone")
    assert cli.main(["run", written.program.path, "--clock", "virtual", "--for", "2"]) == 1
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("cbtui:")]
    assert len(said) == 1
    assert said[0].startswith(f"cbtui: {' '.join(written.sentence.split())}")


@pytest.mark.parametrize(
    ("source", "reason"),
    first_row_daily(
        ("def main():\n    return", "the program returned"),
        (HEAD + "rclpy.init()\nNode('n')", "the program returned"),
        (
            HEAD + "rclpy.init()\nNode('n').create_timer(1.0, print)",
            "the program returned without spinning, so none of its callbacks ran; "
            "end it with rclpy.spin(node)",
        ),
        (
            HEAD + "rclpy.init()\nnode = Node('n')\nnode.create_timer(1.0, print)\n"
            "try:\n    node.get_parameter('none')\n    rclpy.spin(node)\nexcept Exception:\n    pass",
            "the program returned without coming to its spin(), so none of its callbacks ran; "
            "an exception may have been caught on the way",
        ),
        (b"\xef\xbb\xbfprint('byte order mark')", "the program returned"),
        ("# -*- coding: latin-1 -*-\nprint('caf\xe9')".encode("latin-1"), "the program returned"),
    ),
)
def test_a_file_that_only_does_too_little_has_not_failed(
    tmp_path: Path, source: str | bytes, reason: str
) -> None:
    run = run_to_end(program_setup(Path(write(Bad(source, ""), tmp_path / "f").program.path), 2.0))
    assert (run.ending.reason, run.ending.failed) == (reason, False)


def test_a_loop_without_end_is_named_with_its_line_and_the_run_can_be_stopped(tmp_path: Path) -> None:
    path = write(Bad("x = 0\nwhile True:\n    x += 1", ""), tmp_path / "loop").program.path
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(program_setup(Path(path), 2.0), news.put, news.put)
    session.start()
    try:
        notices: list[Notice] = []
        while not notices:
            batch = news.get(timeout=60)
            assert isinstance(batch, list)
            notices += [event for event in batch if isinstance(event, Notice)]
    finally:
        session.stop()
    assert notices[0].text.startswith("MainThread does not come to a wait (node.py:")
