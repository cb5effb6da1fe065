"""An argument parser that reports errors in one line."""

import argparse
from typing import NoReturn

from cbtui.text.output import say, shown


class CommandParser(argparse.ArgumentParser):
    """A parser whose error messages are one line."""

    def error(self, message: str) -> NoReturn:
        """Print what was wrong and where to read more, and exit with code 2."""
        self.exit(2, shown(f"{self.prog}: {message} (see {self.prog} --help)\n"))

    def print_help(self, file: object = None) -> None:
        """Print the help with ``say``: argparse itself ignores that it cannot be written."""
        say(self.format_help())
