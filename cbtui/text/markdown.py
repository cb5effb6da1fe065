"""Text in Markdown."""


def as_it_is(text: str) -> str:
    """Return a text that Markdown shows as it is."""
    return "".join(f"\\{each}" if each in r"\`*_{}[]()<>#+-.!|~&" else each for each in text)
