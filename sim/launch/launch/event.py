"""Something that happened in a launch."""


class Event:
    """Something that happened; event handlers match on its class."""

    name = "launch.Event"
