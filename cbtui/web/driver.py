"""What the console of a visitor reads keys from and draws to, in place of a terminal."""

from textual import messages
from textual.drivers.web_driver import WebDriver


class BrowserDriver(WebDriver):
    """Ends the console when the server is gone: nobody could see or end it any more."""

    def run_input_thread(self) -> None:
        """Read what the visitor types, until the server stops sending."""
        super().run_input_thread()
        if not self.exit_event.is_set():
            self._app.post_message(messages.ExitApp())

    def stop_application_mode(self) -> None:
        """Tell the server that the console ends, if there still is a server."""
        try:
            super().stop_application_mode()
        except BrokenPipeError:
            return
