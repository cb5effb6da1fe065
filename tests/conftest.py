"""What holds for every test: random examples are the same each time, so that a red run is red again."""

from hypothesis import settings

settings.register_profile("same-each-time", derandomize=True, deadline=None, database=None)
settings.load_profile("same-each-time")
