"""The Textual driver of a console that is shown in a browser."""

import os
from contextlib import suppress
from typing import Any

from textual import messages
from textual.drivers.web_driver import WebDriver


class BrowserDriver(WebDriver):
    """Ends the console when the server is gone, since nobody could see or end it any more.

    Output to a closed pipe is discarded.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        driver: Any = self
        driver._write = self._write_while_read

    def run_input_thread(self) -> None:
        """Read the visitor's input until the server closes the pipe."""
        super().run_input_thread()
        if not self.exit_event.is_set():
            self._app.post_message(messages.ExitApp())

    def _write_while_read(self, data: bytes) -> None:
        with suppress(BrokenPipeError):
            os.write(self.fileno, data)
