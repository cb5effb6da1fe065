"""A parser of options whose complaints are one line, and go through ``cbtui.text.output``."""

import argparse
from collections.abc import Iterable
from typing import Any, NoReturn

from cbtui.commands.options.targets import is_file_name
from cbtui.text.output import say, shown


class CommandParser(argparse.ArgumentParser):
    """A parser whose error messages are one line, with the nearest word that there is."""

    def error(self, message: str) -> NoReturn:
        """Print what was wrong and where to read more, and exit with code 2."""
        self.exit(2, shown(f"{self.prog}: {message} (see {self.prog} --help)\n"))

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse words all of which have to be known: a command's parser is given its words by this."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            near = _nearest(unknown[0].partition("=")[0], self._option_string_actions)
            self.error(f"unrecognized arguments: {' '.join(unknown)}{near}")
        return found, unknown

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError:
            if isinstance(action, argparse._SubParsersAction) and _can_be_opened(str(value)):
                ways = f"cbtui open {value} opens it, cbtui run {value} runs it"
                shown_how = f"{value} is not a command; {ways}"
                raise argparse.ArgumentError(None, shown_how) from None
            near = _nearest(str(value), map(str, action.choices or ()))
            if not near:
                raise
            raise argparse.ArgumentError(action, f"invalid choice: {value!r}{near}") from None

    def print_help(self, file: object = None) -> None:
        """Print the help with ``say``: argparse itself ignores that it cannot be written."""
        say(self.format_help())


def _can_be_opened(word: str) -> bool:
    """Whether a word that stands in a command's place is a file or a lesson."""
    from lessons.catalogue import lessons

    return is_file_name(word) or any(word == lesson.id for lesson in lessons())


def _nearest(word: str, known: Iterable[str]) -> str:
    from difflib import get_close_matches  # needed for a wrong word only

    return "".join(f"; did you mean {near}?" for near in get_close_matches(word, list(known), 1, 0.7))
