"""The exception that ended a program, read off its traceback: the probe begins only with rclpy."""

import re

from sim.real.wire import Uncaught

_FRAME = re.compile(r'  File "(?P<file>[^<].*)", line (?P<line>\d+)')
_OF_PYTHON = re.compile(r"/(lib/python3[^/]*|site-packages|dist-packages)/")
_ERROR = re.compile(r"(?:\w+\.)*(?P<exception>\w+)(?:: .*)?")


class PrintedTraceback:
    """Takes the lines that a program prints on stderr."""

    def __init__(self) -> None:
        self.error = ""
        """The last line: the class and text of the exception, if one ended the program."""
        self._place: tuple[str, int] | None = None
        """The last place outside Python and its packages."""

    def take(self, line: str) -> None:
        """Take the next line."""
        self.error = line
        frame = _FRAME.match(line)
        if frame and not _OF_PYTHON.search(frame["file"]):
            self._place = frame["file"], int(frame["line"])

    def uncaught(self) -> Uncaught | None:
        """The exception; None if the last lines are not those of a traceback."""
        found = _ERROR.fullmatch(self.error)
        if self._place is None or found is None:
            return None
        return Uncaught(0, self.error, *self._place, found["exception"])
