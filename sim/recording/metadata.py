"""The metadata of a recording: the run that it is of, and the version that made it."""

from collections.abc import Mapping

import msgspec

NAME = "cbtui"
"""Name of the metadata record."""


class RecordingMetadata(msgspec.Struct, frozen=True, kw_only=True):
    """The run of a recording. Fields that could not be read are empty.

    ``recorded`` is nanoseconds since 1970, ``threads`` the number that replaced the executors' own (None: not
    replaced), ``programs`` the paths of the files that ran, ``setup`` the whole set-up as JSON.
    """

    title: str = ""
    clock: str = ""
    threads: int | None = None
    programs: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    setup: str = ""
    version: str = ""
    recorded: int = 0


def to_metadata(about: RecordingMetadata) -> dict[str, str]:
    """Encode as the texts of a metadata record."""
    fields = msgspec.structs.asdict(about)
    return {
        name: value if isinstance(value, str) else msgspec.json.encode(value).decode()
        for name, value in fields.items()
    }


def from_metadata(texts: Mapping[str, str]) -> RecordingMetadata | None:
    """Decode the texts of ``to_metadata``; None for other texts."""
    try:
        fields = {
            field.name: text if field.type is str else msgspec.json.decode(text.encode())
            for field in msgspec.structs.fields(RecordingMetadata)
            if (text := texts.get(field.name)) is not None
        }
        return msgspec.convert(fields, RecordingMetadata)
    except (msgspec.DecodeError, RecursionError, UnicodeEncodeError):
        return None
