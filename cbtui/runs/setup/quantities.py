"""Values that a person can type: their bounds, and the message for invalid input."""

import math
from typing import NamedTuple, Protocol, TypeVar

from sim.releases.distros import DISTROS
from sim.releases.profile import Profile

Value = TypeVar("Value")


class BadQuantityError(ValueError):
    """Text that is not a valid number; the message says why and what to enter."""


class TypedValue(Protocol[Value]):
    """A kind of value with a ``name`` for people; ``bounds`` are all values, in words."""

    @property
    def name(self) -> str:
        """The name."""

    @property
    def bounds(self) -> str:
        """All values, in words."""

    def read(self, text: str) -> Value:
        """Return the value that somebody typed.

        Raises:
            ValueError: the text is no such value; the message says why and what to enter.
        """

    def shown(self, value: Value) -> str:
        """Return the value for display."""


class Quantity(NamedTuple):
    """A number with a ``name`` for people, from ``least`` to ``most``, both included."""

    name: str
    unit: str
    least: float
    most: float

    @property
    def bounds(self) -> str:
        """The bounds in words."""
        return f"{self.least:g} to {self.most:g} {self.unit}"

    def read(self, text: str) -> float:
        """Return the number that somebody typed, with or without its unit.

        Raises:
            BadQuantityError: the text is not a number, or out of bounds.
        """
        plain = text.strip().removesuffix(self.unit).strip()
        try:
            number = float(plain.replace(",", "."))
        except ValueError:
            raise BadQuantityError(f"{plain!r} is not a number; give {self.bounds}") from None
        if not (math.isfinite(number) and self.least <= number <= self.most):
            raise BadQuantityError(f"{plain} is not a {self.name}; give {self.bounds}")
        return number

    def shown(self, number: float) -> str:
        """Return the number with its unit."""
        return f"{number:g} {self.unit}"


class Release(NamedTuple):
    """A release of rclpy: a distribution, perhaps with a patch."""

    name: str = "release"
    bounds: str = f"{', '.join(list(DISTROS)[:-1])} or {list(DISTROS)[-1]}, also with a patch (jazzy@7.1.5)"

    def read(self, text: str) -> str:
        """Return the release's name with its patch.

        Raises:
            UnknownProfileError: there is no such release.
        """
        return str(Profile.named(text.strip().lower()))

    def shown(self, value: str) -> str:
        """The name itself."""
        return value


PERIOD = Quantity("period", "s", 0.001, 3600)
SENSOR_RATE = Quantity("sensor rate", "Hz", 0.1, 100)
USUAL_SENSOR_RATE = 20.0
"""Hz, by default."""
