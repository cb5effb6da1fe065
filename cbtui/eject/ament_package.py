"""The files of an ament_python package, as text.

Source of the form: ``ros2 pkg create --build-type ament_python``; REP 149 for ``package.xml``.
"""

import ast
import json
import keyword
import shlex
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path, PurePosixPath
from string import Template
from xml.sax.saxutils import escape

_KEYS = {
    "cv2": "python3-opencv",
    "matplotlib": "python3-matplotlib",
    "numpy": "python3-numpy",
    "scipy": "python3-scipy",
    "tf2_ros": "tf2_ros_py",
    "yaml": "python3-yaml",
}
"""Rosdep keys of modules whose package has another name."""
_CALL = 'Call it: `ros2 service call {} {} "{{data: true}}"`'
_ARGUMENT_IMPORTS = """\
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
"""
_TEMPLATES = Path(__file__).with_name("templates")
_ROBOT_INTERFACES = frozenset(("geometry_msgs", "nav_msgs", "sensor_msgs"))


@dataclass(frozen=True, kw_only=True)
class LessonProgram:
    """One lesson's node: an executable and a launch file of the package."""

    name: str
    """The executable's name: letters, digits and underscores."""
    title: str
    teaches: str
    source: bytes
    """The unchanged source of the node; it has a ``main()``."""
    arguments: tuple[str, ...] = ()
    """The command-line arguments from the lesson."""
    service: tuple[str, str] | None = None
    """Name and type of the SetBool service that the node offers, if any."""

    @property
    def module(self) -> str:
        """The name of its module, a valid identifier."""
        importable = self.name.isidentifier() and not keyword.iskeyword(self.name)
        return self.name if importable else f"lesson_{self.name}"


@dataclass(frozen=True, kw_only=True)
class AmentPackage:
    """A package of lessons.

    ``also`` gives executables further names; ``launch_files`` are added as they are.
    """

    name: str
    title: str
    """What it is about, in one line."""
    programs: tuple[LessonProgram, ...]
    also: Mapping[str, LessonProgram] = field(default_factory=dict)
    launch_files: Mapping[str, bytes] = field(default_factory=dict)

    def files(self) -> dict[PurePosixPath, bytes]:
        """The content of every file by its path in the package's folder."""
        launch_files = {
            **self.launch_files,
            **{f"{each.name}.launch.py": self._launch_file(each).encode() for each in self.programs},
        }
        nodes = [each.source for each in self.programs]
        depends = {"ros2launch", *_depends(nodes), *_depends(launch_files.values())}
        return {
            PurePosixPath("package.xml"): self._manifest(depends).encode(),
            PurePosixPath("setup.py"): self._setup().encode(),
            PurePosixPath("setup.cfg"): self._filled("setup.cfg").encode(),
            PurePosixPath("README.md"): self._readme(_depends(nodes)).encode(),
            PurePosixPath("resource", self.name): b"",
            PurePosixPath(self.name, "__init__.py"): b"",
            **{PurePosixPath(self.name, f"{each.module}.py"): each.source for each in self.programs},
            **{PurePosixPath("launch", name): content for name, content in launch_files.items()},
            PurePosixPath("test", "test_programs.py"): self._test().encode(),
        }

    def _filled(self, template: str, **more: str) -> str:
        text = (_TEMPLATES / f"{template}.in").read_text("utf-8")
        return Template(text).substitute(package=self.name, **more)

    def _launch_file(self, program: LessonProgram) -> str:
        """The launch file that starts it with its arguments, those with a value as launch arguments."""
        declared = _launch_arguments(program.arguments)
        words = [_literal(word) for word in program.arguments]
        declarations: list[str] = []
        for place, (name, value) in declared.items():
            words[place] = f"LaunchConfiguration({_literal(name)})"
            declarations.append(
                f"            DeclareLaunchArgument({_literal(name)}, default_value={_literal(value)}),\n"
            )
        lines = "".join(f"                    {word},\n" for word in words)
        return self._filled(
            "program.launch.py",
            name=program.name,
            how=" with the arguments of its lesson" if words else "",
            imports=_ARGUMENT_IMPORTS if declared else "",
            declarations="".join(declarations),
            arguments=f"                arguments=[\n{lines}                ],\n" if words else "",
        )

    def _manifest(self, depends: Iterable[str]) -> str:
        lines = "\n".join(f"  <exec_depend>{escape(each)}</exec_depend>" for each in sorted(depends))
        return self._filled("package.xml", description=escape(self.title), depends=lines)

    def _setup(self) -> str:
        programs = {each.name: each for each in self.programs} | {**self.also}
        entries = [f"{name} = {self.name}.{each.module}:main" for name, each in programs.items()]
        lines = "\n".join(f"            {_literal(entry)}," for entry in entries)
        return self._filled("setup.py", description=_literal(self.title), entries=lines)

    def _test(self) -> str:
        names = "\n".join(f"    {_literal(each.module)}," for each in self.programs)
        return self._filled("test_programs.py", modules=names)

    def _readme(self, depends: Iterable[str]) -> str:
        return self._filled(
            "README.md",
            title=self.title,
            first=self.programs[0].name,
            launching="".join(self._launching()),
            robot=self._filled("robot.md") if _ROBOT_INTERFACES.intersection(depends) else "",
            lessons="\n".join(map(self._about, self.programs)),
        )

    def _launching(self) -> Iterator[str]:
        """An example of launch arguments, for the first program that has some."""
        for program in self.programs:
            for name, value in _launch_arguments(program.arguments).values():
                argument = shlex.quote(f"{name}:={value}")
                yield self._filled("launching.md", name=program.name, argument=argument)
                return

    def _about(self, program: LessonProgram) -> str:
        others = [f", also `{name}`" for name, each in self.also.items() if each is program]
        names = "".join([f"`{program.name}`", *others])
        sentences = [f"- **{_one_line(program.title)}** ({names}): {_one_line(program.teaches)}"]
        if program.arguments:
            line = shlex.join(["ros2", "run", self.name, program.name, *program.arguments])
            sentences.append(f"`{line}`")
        if program.service is not None:
            sentences.append(_CALL.format(*program.service))
        return "\n  ".join(sentences)


def _launch_arguments(words: tuple[str, ...]) -> dict[int, tuple[str, str]]:
    """Names and values of launch arguments by the value's position on the command line.

    They are the values of the program's own options; ROS arguments are left as they are.
    """
    found: dict[int, tuple[str, str]] = {}
    names: set[str] = set()
    own = words[: words.index("--ros-args")] if "--ros-args" in words else words
    for place, (option, value) in enumerate(pairwise(own), start=1):
        name = option.lstrip("-").replace("-", "_")
        if _is_option(option) and not _is_option(value) and name.isidentifier() and name not in names:
            names.add(name)
            found[place] = (name, value)
    return found


def _is_option(word: str) -> bool:
    """Tell whether a word names an option; ``-1.0`` does not."""
    return word.startswith("-") and not word.lstrip("-")[:1].isdigit() and word.strip("-") != ""


def _depends(sources: Iterable[bytes]) -> set[str]:
    """The packages that files of Python import from, as rosdep calls them, without Python's own."""
    modules = {module for source in sources for module in imported_modules(source)}
    return {_KEYS.get(module, module) for module in modules - sys.stdlib_module_names}


def imported_modules(source: bytes) -> set[str]:
    """The first parts of the names of all modules that a file of Python imports.

    Raises:
        SyntaxError: it is not Python.
    """
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import(names=aliases):
                found.update(alias.name.partition(".")[0] for alias in aliases)
            case ast.ImportFrom(module=str(module), level=0):
                found.add(module.partition(".")[0])
    return found


def _literal(text: str) -> str:
    """Text as Python writes it, in the double quotes that formatters want."""
    return json.dumps(text, ensure_ascii=False)


def _one_line(text: str) -> str:
    return " ".join(text.split())
