"""The colours of callback groups on paper, and of the console on a light background."""

GROUP_COLOURS = ("#040457", "#570404", "#278686", "#C63DF4", "#F2460C")
OTHER_COLOUR = "#5A5A5A"
"""Of the groups beyond these."""


def group_colour(number: int) -> str:
    """The colour of a group, by its place in the order of letters."""
    return GROUP_COLOURS[number] if 0 <= number < len(GROUP_COLOURS) else OTHER_COLOUR
