"""``launch.utilities``: what launch files take from it."""

from sim.launch.launch.substitution import normalize_to_list_of_substitutions, perform_substitutions

__all__ = ["normalize_to_list_of_substitutions", "perform_substitutions"]
