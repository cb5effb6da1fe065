"""Numbers that a person can set: their bounds, and the message for invalid input."""

import math
from typing import NamedTuple


class BadQuantityError(ValueError):
    """Text that is not a valid number; the message says why and what to enter."""


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
        """The number with its unit."""
        return f"{number:g} {self.unit}"


PERIOD = Quantity("period", "s", 0.001, 3600)
SENSOR_RATE = Quantity("sensor rate", "Hz", 0.1, 100)
USUAL_SENSOR_RATE = 20.0
"""Hz, by default."""
