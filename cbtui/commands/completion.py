"""``cbtui completion`` and ``cbtui man``: completions of the command line for shells, and its manual page."""

import argparse
from collections.abc import Callable, Iterator, Mapping, Sequence
from re import findall

from cbtui.text.output import say

_SHELLS = ("bash", "zsh", "fish")
_PATHS = {"FILE": "FILE", "OUT": "FILE", "DIR": "DIRECTORY"}
"""The completion of arguments that are paths, by their names in the help."""
_OTHERS = {"A": "LESSON|FILE", "B": "LESSON|FILE"}
"""Descriptions of arguments whose names do not explain them."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("shell", metavar="|".join(_SHELLS), choices=_SHELLS, help="the shell to print it for")


def completion(whole: Callable[[], argparse.ArgumentParser], options: argparse.Namespace) -> int:
    """Print a script that completes the words of the ``whole`` command line, with the current lessons."""
    import shtab

    parser, words = whole(), _words()
    functions = dict[str, str]()
    for action in _actions(parser):
        said = findall("[A-Z]+", str(action.metavar or _OTHERS.get(action.dest)))
        kinds = [kind for kind in (*words, *_PATHS) if kind in said]
        if kinds:
            ids = " ".join(word for kind in kinds for word in words.get(kind, ()))
            paths = next((_PATHS[kind] for kind in kinds if kind in _PATHS), "")
            name = f"_cbtui_{'_'.join(kinds).lower()}"
            functions[name] = _function(name, options.shell, ids, paths)
            fish = f"{ids} {getattr(shtab, paths)['fish']}" if paths else ids
            action.complete = {"bash": name, "zsh": name, "fish": fish}  # type: ignore[attr-defined]
    preamble = "\n".join(functions.values())
    say(shtab.complete(parser, options.shell, preamble=preamble) + "\n")
    return 0


def man(whole: Callable[[], argparse.ArgumentParser], _options: argparse.Namespace) -> int:
    """Print the manual page of the ``whole`` command line."""
    from argparse_manpage.manpage import Manpage

    page = Manpage(whole())
    page.manual = page.prog
    page.description = page.parser.description  # the line that apropos finds
    say(f"{page}\n")
    return 0


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield the arguments of a parser and of its commands."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for each in action.choices.values():
                yield from _actions(each)
        else:
            yield action


def _words() -> Mapping[str, Sequence[str]]:
    """Return the completions of arguments by their names in the help."""
    from cbtui.looks.colour_themes import THEMES
    from lessons.catalogue import lessons
    from lessons.puzzles import puzzles
    from sim.releases.distros import DISTROS

    return {
        "LESSON": [lesson.id for lesson in lessons()],
        "PUZZLE": [puzzle.id for puzzle in puzzles()],
        "THEME": [theme.name for theme in THEMES],
        "RELEASE": list(DISTROS),
    }


def _function(name: str, shell: str, ids: str, paths: str) -> str:
    """Return a shell's function that offers words, and files or folders; fish needs none."""
    match shell:
        case "bash":
            found = {"": "", "FILE": ' _shtab_compgen_files "$1";', "DIRECTORY": ' _shtab_compgen_dirs "$1";'}
            return f'{name}() {{ compgen -W "{ids}" -- "$1";{found[paths]} }}'
        case "zsh":
            found = {"": "", "FILE": "; _files", "DIRECTORY": "; _files -/"}
            return f"{name}() {{ compadd -- {ids}{found[paths]} }}"
    return ""
