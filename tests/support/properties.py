"""How many random examples a property gets: a quarter, and all with ``--hypothesis-profile thorough``."""

from hypothesis import settings

ALL = 100
"""What Hypothesis takes for a property of which nothing else is said."""


def register_profiles() -> None:
    """Have random examples be the same each time, so that a red run is red again; a quarter of them."""
    settings.register_profile("thorough", max_examples=ALL, derandomize=True, deadline=None, database=None)
    settings.register_profile("daily", settings.get_profile("thorough"), max_examples=ALL // 4)
    settings.load_profile("daily")


def examples(most: int) -> int:
    """Return how many of ``most`` examples a test gets in this run, one at least."""
    return max(1, most * settings().max_examples // ALL)
