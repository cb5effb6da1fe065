"""What can go wrong with a transform."""

__all__ = [
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]


class TransformException(Exception):
    """The base of all of tf2's exceptions."""


class ConnectivityException(TransformException):
    """Both frames are known, and no way leads from one to the other."""


class LookupException(TransformException):
    """A frame is not known, or the frames form a loop."""


class ExtrapolationException(TransformException):
    """The buffer has no data for the time asked for."""


class InvalidArgumentException(TransformException):
    """A frame has no name, or one that begins with a slash."""


class TimeoutException(TransformException):
    """A transform did not come in time."""


for _each in __all__:
    globals()[_each].__module__ = "tf2"  # as its name is printed
