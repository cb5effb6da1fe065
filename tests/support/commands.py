"""Command lines carried out in this process, for tests of what they do and say."""

import io
from contextlib import redirect_stderr, redirect_stdout
from subprocess import CompletedProcess

from cbtui import cli


def cbtui(*words: str) -> "CompletedProcess[str]":
    """Carry out a command line of ``cbtui``; what it says is not a terminal's."""
    said, complained = io.BytesIO(), io.BytesIO()
    with (
        redirect_stdout(io.TextIOWrapper(said, encoding="utf-8", write_through=True)),
        redirect_stderr(io.TextIOWrapper(complained, encoding="utf-8", write_through=True)),
    ):
        try:
            code = cli.main(words)
        except SystemExit as left:
            code = int(str(left.code))
        texts = said.getvalue().decode(), complained.getvalue().decode()
    return CompletedProcess(["cbtui", *words], code, *texts)
