"""``cbtui completion`` and ``cbtui man``: completions of the command line for shells, and its manual page."""

import argparse
from collections.abc import Callable, Iterator

from cbtui.text.output import say

_SHELLS = ("bash", "zsh", "fish")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("shell", choices=_SHELLS, help="the shell that is to complete")


def completion(whole: Callable[[], argparse.ArgumentParser], options: argparse.Namespace) -> int:
    """Print a script that completes the words of the ``whole`` command line; lessons are those of now."""
    import shtab

    from lessons.catalogue import lessons

    ids = " ".join(lesson.id for lesson in lessons())
    parser = whole()
    for action in _actions(parser):
        action.complete = _completion_of(action, ids)  # type: ignore[attr-defined]
    preamble = {
        "bash": f'_cbtui_targets() {{ compgen -W "{ids}" -- "$1"; _shtab_compgen_files "$1"; }}',
        "zsh": f"_cbtui_targets() {{ compadd -- {ids}; _files }}",
        "fish": "",
    }
    say(shtab.complete(parser, options.shell, preamble=preamble[options.shell]) + "\n")
    return 0


def man(whole: Callable[[], argparse.ArgumentParser], _options: argparse.Namespace) -> int:
    """Print the manual page of the ``whole`` command line."""
    from argparse_manpage.manpage import Manpage

    page = Manpage(whole())
    page.manual = page.prog
    say(f"{page}\n")
    return 0


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """The arguments of a parser and of its commands."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for each in action.choices.values():
                yield from _actions(each)
        else:
            yield action


def _completion_of(action: argparse.Action, lessons: str) -> dict[str, str]:
    """What shells complete an argument with, derived from its name in the help."""
    import shtab

    name = str(action.metavar or "")
    if "LESSON" in name and "FILE" in name:
        targets = {"bash": "_cbtui_targets", "zsh": "_cbtui_targets"}
        return {**targets, "fish": f"{lessons} {shtab.FILE['fish']}"}
    if "LESSON" in name:
        return {"bash": "_cbtui_targets", "zsh": f"({lessons})", "fish": lessons}
    known = shtab.FILE if "FILE" in name else shtab.DIRECTORY if "DIR" in name else {}
    return {shell: str(known[shell]) for shell in _SHELLS if shell in known}
