"""Cuts the files of a course's unit out of its text, as a package, with only the printing errors mended.

The text is the course's own and no part of this repository; see ``course_text``.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

VARIABLE = "CBTUI_COURSE_TEXT"
"""The environment variable that holds the path of the course's text."""
PACKAGE = "unit5_pkg"
NODES = ("exercise51", "exercise52", "exercise53", "callback_groups_examples")
LAUNCHED = NODES[:3]

_FENCE = "```"
_TITLE = re.compile(r"\w+(\.launch)?\.py")
_MAIN = re.compile(r"^( *)def main\(", re.MULTILINE)
_MANIFEST = f"""<?xml version="1.0"?>
<package format="3">
  <name>{PACKAGE}</name>
  <version>0.0.0</version>
  <description>TODO: Package description</description>
  <maintainer email="user@user.com">somebody very awesome</maintainer>
  <license>TODO: License declaration</license>
  <depend>rclpy</depend>
  <depend>std_msgs</depend>
  <depend>sensor_msgs</depend>
  <depend>geometry_msgs</depend>
  <depend>nav_msgs</depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
"""What ``ros2 pkg create`` writes for the command that the course gives."""


class Block(NamedTuple):
    """A printed block of code: the file it is titled with, and its parts between one fence and the next.

    A block that the print has cut in two has two parts.
    """

    title: str
    parts: tuple[str, ...]


def course_text() -> str | None:
    """The text of the course's unit; None where the environment does not say where it is."""
    path = os.environ.get(VARIABLE)
    return Path(path).read_text(encoding="utf-8") if path else None


def make_package(text: str, folder: Path) -> Path:
    """Write the package of the course's unit into ``folder``; its root."""
    root = folder / PACKAGE
    for part in (root / PACKAGE, root / "resource", root / "launch"):
        part.mkdir(parents=True)
    (root / "package.xml").write_text(_MANIFEST)
    (root / "resource" / PACKAGE).touch()
    (root / PACKAGE / "__init__.py").touch()
    blocks = list(_blocks(text))
    for name in NODES:
        (root / PACKAGE / f"{name}.py").write_text(mended(_titled(blocks, f"{name}.py").parts))
    for name in LAUNCHED:
        title = f"{name}.launch.py"
        (root / "launch" / title).write_text("".join(_titled(blocks, title).parts))
    *_, setup = (block for block in blocks if "setup(" in block.parts[0])
    (root / "setup.py").write_text("".join(setup.parts))
    return root


def shell_line(text: str, beginning: str) -> str:
    """The first printed block that begins so, as one would paste it into a shell."""
    return next(
        part.rstrip() for block in _blocks(text) for part in block.parts if part.startswith(beginning)
    )


def mended(parts: tuple[str, ...]) -> str:
    """A node's file: ``main`` outside of the class and whole, ``rclpy`` spelt so."""
    head, *rest = parts
    found = _MAIN.search(head)
    if found is not None:
        head = head[: found.start()] + _shifted(head[found.start() :], -len(found[1]))
        rest = [_as_body(part) for part in rest]
    return "".join([head, *rest]).replace("rcipy", "rclpy")


def _as_body(part: str) -> str:
    """The end of ``main``, which lost its indentation to the fence before it."""
    body, entry, call = part.partition("if __name__")
    return _shifted(body, 4) + entry + call


def _shifted(text: str, columns: int) -> str:
    lines = text.splitlines(keepends=True)
    if columns < 0:
        return "".join(line[-columns:] if line.strip() else line for line in lines)
    return "".join(" " * columns + line if line.strip() else line for line in lines)


def _titled(blocks: list[Block], title: str) -> Block:
    (found,) = (block for block in blocks if block.title == title)
    return found


def _blocks(text: str) -> Iterator[Block]:
    title = ""
    parts: list[str] = []
    for place, piece in enumerate(text.split(_FENCE)):
        if place % 2 == 1:
            parts.append(piece.strip("\n ") + "\n")
        elif piece.strip() or not parts:
            if parts:
                yield Block(title, tuple(parts))
            parts = []
            title = _title(piece)
    if parts:
        yield Block(title, tuple(parts))


def _title(prose: str) -> str:
    """The file that the code after some prose is titled with; empty where it has no title."""
    lines = [line.strip() for line in prose.splitlines()]
    said = [line for line in lines if line and line != "In []:"]
    return said[-1] if said and _TITLE.fullmatch(said[-1]) else ""
