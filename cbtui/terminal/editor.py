"""Suspends the console while the user's own editor has a file open at a line."""

import asyncio
import os
import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from textual.app import App, SuspendNotSupported

_COLON = {"code", "codium", "cursor", "hx", "helix", "subl", "zed", "windsurf"}
"""Editors that take ``file:line``."""
_GO_TO = {"code", "codium", "cursor", "windsurf"}
"""Those of them that take it only after ``--goto``."""
_PLUS = {
    *("editor", "emacs", "emacsclient", "ex", "geany", "gedit", "gvim", "jmacs", "joe", "jove", "kak"),
    *("mcedit", "mg", "micro", "nano", "ne", "nvi", "nvim", "pico", "pluma", "rnano", "vi", "view"),
    *("sensible-editor", "vim", "vimx", "xed", "zile"),
}
"""Editors that take ``+line file``, as vi does; any other one would take it for the name of a file."""


class EditorError(Exception):
    """A file that cannot be opened in an editor; the text is one sentence that says why and what to do."""


async def edit(app: App[Any], path: Path, line: int) -> None:
    """Open a file at a line in ``$VISUAL`` or ``$EDITOR``, and wait until it exits; the app runs on, hidden.

    Raises:
        EditorError: no editor is named, it or the file is missing, or the app cannot be suspended.
    """
    command = command_for(os.environ, path, line)
    try:
        with app.batch_update(), app.suspend():
            status = await asyncio.to_thread(_run, command)
    except SuspendNotSupported:
        raise EditorError("no editor can be opened in this terminal; open the file in another one") from None
    except OSError as error:
        raise EditorError(
            f"{command[0]} cannot be started: {error.strerror}; set EDITOR to another"
        ) from None
    if status:
        raise EditorError(f"{command[0]} ended with status {status}")


def command_for(environment: Mapping[str, str], path: Path, line: int) -> list[str]:
    """Return the command that opens a file, at a line if the editor is known to take one.

    Raises:
        EditorError: the file is missing, or the variable names no editor or cannot be parsed.
    """
    if not path.is_file():
        raise EditorError(f"{path} is not on this machine, so no editor can open it")
    named = environment.get("VISUAL", "").strip() or environment.get("EDITOR", "").strip()
    if not named:
        raise EditorError("no editor is named; leave, type export EDITOR=nano or another, and start again")
    try:
        command = shlex.split(named)
    except ValueError:
        raise EditorError(f"EDITOR is {named}, whose quotes do not match; set it again") from None
    name = Path(command[0]).stem
    file = str(path)
    if name in _COLON:
        return [*command, *(["--goto"] if name in _GO_TO else []), f"{file}:{line}"]
    return [*command, *([f"+{line}"] if name in _PLUS else []), file]


def _run(command: list[str]) -> int:
    return subprocess.run(command, check=False).returncode  # the editor's exit status is reported
