"""Texts that are known only when the launch runs, and functions that join them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from sim.launch.errors import LaunchFailure

if TYPE_CHECKING:
    from sim.launch.launch.launch_context import LaunchContext


class SubstitutionFailure(LaunchFailure):
    """A substitution has no value."""


class Substitution:
    """A text that is known when the launch runs."""

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        raise NotImplementedError(f"{type(self).__name__} does not implement perform()")

    def describe(self) -> str:
        """Return the substitution as shown to people."""
        return f"{type(self).__name__}()"


class TextSubstitution(Substitution):
    """A text that is known before the launch."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected a 'str' for text, got {type(text).__name__!r}")
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        return self.text

    def describe(self) -> str:
        return f"'{self.text}'"


SomeSubstitutionsType: TypeAlias = "str | Substitution | Iterable[str | Substitution]"


def normalize_to_list_of_substitutions(subs: Any) -> list[Substitution]:
    """Return a text, a substitution or several of either as a list of substitutions.

    Raises:
        TypeError: ``subs`` is something else.
    """
    if isinstance(subs, str):
        return [TextSubstitution(text=subs)]
    if isinstance(subs, Substitution):
        return [subs]
    if isinstance(subs, Iterable) and not isinstance(subs, (bytes, dict)):
        return [each for item in subs for each in normalize_to_list_of_substitutions(item)]
    raise TypeError(
        f"a text, a substitution or a list of these is wanted, not {subs!r} of type {type(subs).__name__!r}"
    )


def perform_substitutions(context: LaunchContext, subs: Sequence[Substitution]) -> str:
    """Return the joined texts of substitutions."""
    return "".join(each.perform(context) for each in subs)


def performed(context: LaunchContext, subs: Any) -> str:
    """Return the text of any value that ``normalize_to_list_of_substitutions`` takes."""
    return perform_substitutions(context, normalize_to_list_of_substitutions(subs))
