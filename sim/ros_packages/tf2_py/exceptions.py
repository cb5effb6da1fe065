"""The exceptions of tf2."""

__all__ = [
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]


class TransformException(Exception):
    """Base of tf2's exceptions."""


class ConnectivityException(TransformException):
    """Both frames are known, but not connected."""


class LookupException(TransformException):
    """A frame is unknown, or the frames form a loop."""


class ExtrapolationException(TransformException):
    """The buffer has no data for the requested time."""


class InvalidArgumentException(TransformException):
    """A frame's name is empty or begins with a slash."""


class TimeoutException(TransformException):
    """A transform did not arrive in time."""


for _each in __all__:
    globals()[_each].__module__ = "tf2"  # as its name is printed
