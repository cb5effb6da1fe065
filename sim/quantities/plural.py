"""Numbers of things in words."""


def plural(number: int, noun: str) -> str:
    """Return the noun in the form that goes with a number: 1 ``thread``, 2 ``threads``, 2 ``processes``."""
    return noun if number == 1 else f"{noun}{'es' if noun.endswith('s') else 's'}"


def counted(number: int, noun: str) -> str:
    """Return a number and what it counts: ``1 thread``, ``3 threads``."""
    return f"{number} {plural(number, noun)}"
