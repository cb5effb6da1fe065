"""A parser of options whose error messages are one line, printed through ``cbtui.text.output``."""

import argparse
from collections.abc import Mapping
from typing import Any, NoReturn

from cbtui.commands.options.targets import is_file_name
from cbtui.text.output import say, shown

_COMMANDS_BY_OTHER_NAMES = {
    "help": "--help",
    "version": "--version",
    "record": "run FILE.py --record FILE.mcap",
    "play": "replay",
    "diff": "compare",
    "launch": "run",
    "lint": "lint-lesson",
}
_OPTIONS_BY_OTHER_NAMES = {"--duration": "--for", "--until": "--for"}


class CommandParser(argparse.ArgumentParser):
    """A parser whose error messages are one line, with the nearest valid word."""

    def error(self, message: str) -> NoReturn:
        """Print the error and the command that shows the help, and exit with code 2."""
        self.exit(2, shown(f"{self.prog}: {message} (see {self.prog} --help)\n"))

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse words, none of which may be unknown: argparse calls this for the parser of a command."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            near = _nearest(unknown[0].partition("=")[0], self._options())
            if "-- " in (self.usage or "") and not unknown[0].startswith("-"):
                near = f"; put -- before {unknown[0]}"
            self.error(f"unrecognized arguments: {' '.join(unknown)}{near}")
        return found, unknown

    def _options(self) -> dict[str, str]:
        """The options by their names, and the first one of each kind of value by the name of that."""
        named = {
            f"--{each.metavar.lower()}": f"{each.option_strings[-1]} {each.metavar}"
            for each in reversed(self._actions)
            if each.option_strings and isinstance(each.metavar, str)
        }
        own = {name: name for name in self._option_string_actions}
        return named | own | {word: name for word, name in _OPTIONS_BY_OTHER_NAMES.items() if name in own}

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError:
            if isinstance(action, argparse._SubParsersAction) and _can_be_opened(str(value)):
                ways = f"cbtui open {value} opens it, cbtui run {value} runs it"
                shown_how = f"{value} is not a command; {ways}"
                raise argparse.ArgumentError(None, shown_how) from None
            known = {str(each): str(each) for each in action.choices or ()}
            if isinstance(action, argparse._SubParsersAction):
                near = _nearest(str(value), _COMMANDS_BY_OTHER_NAMES | known)
                raise argparse.ArgumentError(None, f"there is no command {value!r}{near}") from None
            near = _nearest(str(value), known)
            if not near:
                raise
            raise argparse.ArgumentError(action, f"invalid choice: {value!r}{near}") from None

    def _match_argument(self, action: argparse.Action, arg_strings_pattern: str) -> int:
        """Name what an option lacks, where argparse tells only how many."""
        try:
            return super()._match_argument(action, arg_strings_pattern)
        except argparse.ArgumentError:
            if action.choices is not None:
                needed = " or ".join(map(str, action.choices))
            elif action.metavar is None:
                raise
            else:
                needed = action.metavar if isinstance(action.metavar, str) else " and ".join(action.metavar)
            raise argparse.ArgumentError(action, f"give {needed}") from None

    def print_help(self, file: object = None) -> None:
        """Print the help with ``say``: argparse itself ignores that it cannot be written."""
        say(self.format_help())


def _can_be_opened(word: str) -> bool:
    """Whether a word in the place of a command is a file or a lesson."""
    from lessons.catalogue import lessons

    return is_file_name(word) or any(word == lesson.id for lesson in lessons())


def _nearest(word: str, known: Mapping[str, str]) -> str:
    """A question after the nearest of the known words, by what stands for it; empty if none is near."""
    from difflib import get_close_matches  # only needed for a wrong word

    return "".join(f"; did you mean {known[near]}?" for near in get_close_matches(word, known, 1, 0.65))
