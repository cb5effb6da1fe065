"""The base of a launch's events."""


class Event:
    """The base of events; event handlers match their classes."""

    name = "launch.Event"
