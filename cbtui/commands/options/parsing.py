"""Takes command lines apart, and complains of them in one line."""

import argparse
from typing import NoReturn

from cbtui.text.output import say, shown


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line."""

    def error(self, message: str) -> NoReturn:
        """Say what was wrong and where to read more, and exit with 2."""
        self.exit(2, shown(f"{self.prog}: {message} (see {self.prog} --help)\n"))

    def print_help(self, file: object = None) -> None:
        """Print the help as all else is said; by itself argparse goes on where it cannot be written."""
        say(self.format_help())
