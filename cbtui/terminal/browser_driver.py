"""What the console of a visitor reads keys from and draws to, in place of a terminal."""

import os
from contextlib import suppress
from typing import Any

from textual import messages
from textual.drivers.web_driver import WebDriver


class BrowserDriver(WebDriver):
    """Ends the console when the server is gone: nobody could see or end it any more.

    What is drawn until then goes nowhere.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        driver: Any = self
        driver._write = self._write_while_read

    def run_input_thread(self) -> None:
        """Read what the visitor types, until the server stops sending."""
        super().run_input_thread()
        if not self.exit_event.is_set():
            self._app.post_message(messages.ExitApp())

    def _write_while_read(self, data: bytes) -> None:
        with suppress(BrokenPipeError):
            os.write(self.fileno, data)
