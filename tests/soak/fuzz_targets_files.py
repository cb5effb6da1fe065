"""Targets that read files which people write: lessons, configurations, parameters, definitions, packages."""

from functools import cache
from pathlib import Path

import msgspec
import yaml as pyyaml

from cbtui.keys import config as configuration
from cbtui.runs.recorded.recording_file import setup_of
from cbtui.runs.setup.recent import RecentList
from lessons.catalogue import ROOT
from lessons.lesson import BadLesson, read_lesson
from lessons.progress import Progress
from sim.engine.setup import ProgramSetup, RunSetup, TimedCall, TimedInput, TimedLine
from sim.files import plain_yaml
from sim.interfaces import DefinitionError, Kind, known, message
from sim.interfaces.bundles import DefinitionBundle
from sim.interfaces.folder import DefinitionFolder
from sim.interfaces.jazzy import JazzyMessages
from sim.interfaces.registry import Registry
from sim.packages import PackageError, find_packages
from sim.recording.metadata import RecordingMetadata, from_metadata, to_metadata
from sim.ros.parameters.yaml_files import ParameterYamlError, read_nodes, read_value
from sim.shell.messages import Outgoing, given_values
from sim.shell.session import CommandFailed
from tests.soak.fuzz_target import Target, listed, text_of

DEFINITIONS = Path(known.__file__).parent / "definitions.interfaces"
_FILES = ("guide.md", "explain.md", "checks.py", "node.py", "starter.py", "solution.py")


def lesson() -> Target:
    """The description of a lesson."""
    samples = tuple(path.read_bytes() for path in sorted(ROOT.glob("unit*/*/lesson.toml")))
    words = listed(b'[[prediction]]|[setup]|[run]|id = "x"|node = "../../x.py"|1979-05-27|\'\'\'')
    return Target("lesson", _read_lesson, samples, words, (BadLesson,))


def _read_lesson(data: bytes, folder: Path) -> None:
    for name in _FILES:
        (folder / name).touch()
    (folder / "lesson.toml").write_bytes(data)
    try:
        read_lesson(folder)
    except BadLesson as error:
        if "is not the name of its folder" not in str(error):
            raise


def config() -> Target:
    """The configuration of the console."""
    samples = (
        b'[display]\ntheme = "dark"\ncharset = "ascii"\n[keys]\nlesson.pause = "p"\n'
        b'lesson.step = ["f5", "."]\n',
        b'[keys.lesson]\npause = "ctrl+g"\n[keys]\n"menu.open" = "o"\nscreen.help = []\n',
    )
    words = listed(b'[keys]|lesson.pause|lesson.step|"space"|"ctrl+q"|"ctrl+i"|theme|= 3')
    return Target("config", lambda data, _: _complaints(text_of(data)), samples, words)


def _complaints(text: str) -> None:
    for sentence in configuration.read_text(text, "config.toml").complaints:
        assert sentence.strip()


def progress() -> Target:
    """How far a learner is, and what was opened lately."""
    samples = (
        b'{"lesson":"shared-group","answers":[1],"seen":true,"hints":2,"solution":false,"passed":true}\n',
        b'{"lesson": "a", "answers": []}\n{"lesson": "b", "passed": true}\n',
        b'{"kind": "program", "what": "/x/node.py", "at": 1700000000, "arguments": ["-v"], "clock": "real"}'
        b"\n",
        b'{"kind": "lesson", "what": "shared-group", "at": 3}\n'
        b'{"kind": "recording", "what": "/r.mcap", "at": 1}\n',
    )
    words = (b'"lesson"', b'"answers"', b"[1,2]", b"null", b"true", b'"at": -1', b'"\\ud800"', b'"\\u001b"')
    return Target("progress", _read_progress, samples, words)


def _read_progress(data: bytes, folder: Path) -> None:
    for name, reader in (("progress.jsonl", Progress), ("recent.jsonl", RecentList)):
        for path in folder.iterdir():
            path.unlink()
        (folder / name).write_bytes(data)
        opened = reader(folder / name)
        told = opened.of("shared-group") if isinstance(opened, Progress) else opened.entries
        assert told is not None
        assert all("\n" not in trouble for trouble in opened.troubles())


def setup() -> Target:
    """What a recording tells of its run, and the set-up in it."""
    whole = RunSetup(
        title="shared-group",
        programs=(ProgramSetup("/x/node.py", ("-v",)),),
        calls=(TimedCall(5, True),),
        lines=(TimedLine(6, "ros2 node list"),),
        inputs=(TimedInput(7, '{"type":"stop"}'),),
    )
    about = RecordingMetadata(
        title="run", threads=2, programs=("../../x",), setup=msgspec.json.encode(whole).decode()
    )
    samples = (msgspec.json.encode(to_metadata(about)), msgspec.json.encode(whole))
    words = (
        b'"setup"',
        b'"threads"',
        b'"[' * 40,
        b"null",
        b'"\\ud800"',
        b'"programs"',
        b"1e400",
        b'"when used"',
    )
    return Target("setup", _read_setup, samples, words)


def _read_setup(data: bytes, _: Path) -> None:
    setup_of(RecordingMetadata(setup=text_of(data)))
    try:
        texts = msgspec.json.decode(data, type=dict[str, str])
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return
    about = from_metadata(texts)
    if about is not None:
        setup_of(about)


def yaml() -> Target:
    """Values on a ros2 line, and the messages made of them."""
    samples = (
        b"{linear: {x: 0.5, y: 0.0}, angular: {z: -0.2}}",
        b"data: true",
        b"- 1\n- 2.5\n- 'text'\n- {a: [1, 2]}\n",
        b"header: {stamp: now, frame_id: map}\npose: auto\n",
        b"a: &x [1]\nb: *x\n",
    )
    words = (
        b"!!python/object/apply:os.system ['x']",
        b"!!binary x",
        b"!!timestamp ",
        b"<<: ",
        b"? ",
        b"| \n",
        b"> ",
    )
    return Target(
        "yaml", _read_yaml, samples, (*words, b"---\n", b"12:30:45", b"0o17", b".inf", b"now"), _YAML
    )


_MESSAGES = (
    ("geometry_msgs", "Twist"),
    ("std_msgs", "Header"),
    ("std_msgs", "Bool"),
    ("sensor_msgs", "LaserScan"),
)
_YAML = (plain_yaml.YamlError, CommandFailed)


def _read_yaml(data: bytes, _: Path) -> None:
    text = text_of(data)
    values = given_values(text)
    if isinstance(values, dict):
        _dumped(values)
    package, name = _MESSAGES[len(data) % len(_MESSAGES)]
    Outgoing(message(package, name), values)


def _dumped(values: dict[object, object]) -> None:
    try:
        plain_yaml.dump({str(key): value for key, value in values.items()})
    except (pyyaml.YAMLError, UnicodeEncodeError) as error:
        raise AssertionError(error) from None


def parameters() -> Target:
    """Parameter files, and single values."""
    samples = (
        b"/**:\n  ros__parameters:\n    use_sim_time: true\n    speeds: [0.1, 2]\n",
        b"turtle:\n  ros__parameters:\n    name: 'x'\n    deep: {er: {still: 3}}\n    list: [a, b]\n",
        b"[1, 2, 3]",
        b"0x1F",
    )
    words = listed(b"ros__parameters:|/**:|!!str |on|Y|.nan|0x|017|08|~|- |1_0")
    return Target("parameters", _read_parameters, samples, words, (ParameterYamlError,))


def _read_parameters(data: bytes, _: Path) -> None:
    text = text_of(data)
    try:
        read_nodes(text)
    except ParameterYamlError:
        read_value(text)


def interfaces() -> Target:
    """``.msg``, ``.srv`` and ``.action`` files, and the classes made of them."""
    bundles = DefinitionBundle(DEFINITIONS)
    kinds: tuple[Kind, ...] = ("msg", "srv", "action")
    every = [
        bundles.text(package, kind, name).encode()
        for package in sorted(bundles.packages())
        for kind in kinds
        for name in bundles.names(package, kind)
    ]
    assert every
    own = (
        b"uint8 A=1\nstring<=5 name 'x'\nint32[<=3] few [1, 2]\nfloat64[2] two\n"
        b"std_msgs/Header header\n---\nbool ok\n",
        b'wstring W="\\"a\\""\nbyte b 7\nchar[] c\nbool t true\n---\n---\nOther other\n',
    )
    samples = (*own, *every)
    words = (
        b"---\n",
        b"int32",
        b"string",
        b"[<=",
        b"]",
        b"<=",
        b"=",
        b"[99999999999]",
        b"bool",
        b"std_msgs/Header",
    )
    return Target("interfaces", _read_interfaces, samples, words, (DefinitionError,))


def _read_interfaces(data: bytes, folder: Path) -> None:
    kind = ("msg", "srv", "action")[min(data.count(b"---"), 2)]
    for each in ("msg", "srv", "action"):
        (folder / "my_msgs" / each).mkdir(parents=True, exist_ok=True)
        (folder / "my_msgs" / each / f"Mine.{each}").unlink(missing_ok=True)
    (folder / "my_msgs" / kind / f"Mine.{kind}").write_bytes(data)
    registry = Registry(*_others(), DefinitionFolder(folder))
    make = {"msg": registry.message, "srv": registry.service, "action": registry.action}[kind]
    make("my_msgs", "Mine")


@cache
def _others() -> tuple[JazzyMessages, DefinitionBundle]:
    return JazzyMessages(), DefinitionBundle(DEFINITIONS)


def packages() -> Target:
    """The manifest and the build files of a package, which are read and never run."""
    samples = (
        b"<package><name>my_pkg</name><version>0.1.0</version></package>\n",
        b"from glob import glob\nimport os\nfrom setuptools import setup\nname = 'my_pkg'\nsetup(name=name, "
        b"data_files=[(os.path.join('share', name), glob('launch/*.py'))], packages=[name],\n"
        b"entry_points={'console_scripts': ['a = my_pkg.a:main', f'{name} = my_pkg.b:main']})\n",
        b"[metadata]\nname = my_pkg\n[options.entry_points]\nconsole_scripts =\n  a = my_pkg.a:main\n",
        b"project(my_pkg)\nfind_package(ament_cmake REQUIRED)\n"
        b"install(PROGRAMS scripts/a.py DESTINATION lib/${PROJECT_NAME})\n",
    )
    words = listed(b"glob('**')|'x' * 10**9|[0] * 9999999999|for a in b|lambda: 0|__import__('os')")
    more = (
        b"install(",
        b"${X}",
        b"<!DOCTYPE a>",
        b"&lol;",
        b"<name>",
        b"setup(",
        b"'%s' % x",
        b"+",
        b"2 ** 99999999",
        b"name = name + name\n",
        b"'%999999999d' % 1",
    )
    return Target("packages", _read_packages, samples, (*words, *more), (PackageError,))


def _read_packages(data: bytes, folder: Path) -> None:
    for name in ("package.xml", "setup.py", "setup.cfg", "CMakeLists.txt"):
        (folder / name).unlink(missing_ok=True)
    place = {b"<": "package.xml", b"[": "setup.cfg", b"p": "CMakeLists.txt"}.get(data[:1], "setup.py")
    if place != "package.xml":
        (folder / "package.xml").write_text("<package><name>my_pkg</name></package>")
    (folder / place).write_bytes(data)
    found = find_packages(folder)
    try:
        for package in found:
            _ = (package.executables, package.launch_files, package.share)
    finally:
        found.close()
