"""Capabilities of the terminal, derived from the environment."""

from collections.abc import Mapping

BROWSER_DRIVER = "cbtui.terminal.browser_driver:BrowserDriver"
"""The browser driver, as ``TEXTUAL_DRIVER`` names it."""

_COERCED = ("C.UTF-8", "C.utf8", "UTF-8")


def charset_of(environment: Mapping[str, str], utf8_mode: bool, encoding: str = "utf-8") -> str:
    """Return the best charset that the terminal surely supports.

    The locale is the first of ``LC_ALL``, ``LC_CTYPE`` and ``LANG`` that is set, as in POSIX.
    ``utf8_mode`` is ``sys.flags.utf8_mode``: where the locale was C, Python turns it on and puts an
    ``LC_CTYPE`` of its own into the environment (PEP 538 and 540).
    ``encoding`` is what Python writes to the terminal with, which ``PYTHONIOENCODING`` chooses.
    The Linux text console has a font of 256 or 512 glyphs, without braille and without diagonals.
    """
    if is_browser(environment):
        return "braille"
    if environment.get("TERM") == "linux" or not _is_utf8(encoding):
        return "ascii"
    names = [environment.get(name, "") for name in ("LC_ALL", "LC_CTYPE", "LANG")]
    if utf8_mode and names[1] in _COERCED:
        names[1] = ""
    locale = next(filter(None, names), "C")
    return "braille" if _is_utf8(locale) else "ascii"


def _is_utf8(name: str) -> bool:
    return "utf8" in name.lower().replace("-", "").replace("_", "")


def is_dumb(environment: Mapping[str, str]) -> bool:
    """Tell whether the terminal cannot position its cursor."""
    return environment.get("TERM") in {"dumb", "unknown"}


def is_browser(environment: Mapping[str, str]) -> bool:
    """Tell whether the console is shown in a browser, which is connected by pipes."""
    return environment.get("TEXTUAL_DRIVER") == BROWSER_DRIVER
