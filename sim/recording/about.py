"""What a recording tells of itself besides its events: which run it is of, and what made it."""

from collections.abc import Mapping

import msgspec

NAME = "cbtui"
"""What its metadata record is called."""


class About(msgspec.Struct, frozen=True, kw_only=True):
    """Of which run a recording is. What could not be read is empty.

    ``recorded`` is nanoseconds since 1970, ``threads`` what replaced the executors' own number (None:
    nothing), ``programs`` the paths of the files that ran, ``setup`` the whole set-up of the run as JSON.
    """

    title: str = ""
    clock: str = ""
    threads: int | None = None
    programs: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    setup: str = ""
    version: str = ""
    recorded: int = 0


def to_metadata(about: About) -> dict[str, str]:
    """The texts of a metadata record."""
    fields = msgspec.structs.asdict(about)
    return {
        name: value if isinstance(value, str) else msgspec.json.encode(value).decode()
        for name, value in fields.items()
    }


def from_metadata(texts: Mapping[str, str]) -> About | None:
    """What ``to_metadata`` made texts of; None if they are others."""
    try:
        fields = {
            field.name: text if field.type is str else msgspec.json.decode(text.encode())
            for field in msgspec.structs.fields(About)
            if (text := texts.get(field.name)) is not None
        }
        return msgspec.convert(fields, About)
    except (msgspec.DecodeError, RecursionError, UnicodeEncodeError):
        return None
