"""Pictures of screens that somebody has looked at, as files, and what to do when one differs.

``pytest --accept-pictures`` keeps the pictures as they are drawn now; tests that did so are skipped and not
passed, because somebody has to look at them first: ``git diff``, or ``cat`` for each.
"""

import re
from collections.abc import Iterator, Mapping
from itertools import zip_longest
from pathlib import Path

GOLDENS = Path(__file__).parents[1] / "app" / "goldens"
"""Where the pictures are that are agreed upon."""
DRAWN = Path(__file__).parents[2] / "new_pictures"
"""Where those land that differ; nothing there is kept in the repository."""

_MOST = 6
"""How many lines of a picture are told that differ."""
_CODE = re.compile(r"\x1b\[[0-9;]*m")


def accept(pictures: Mapping[str, str]) -> list[str]:
    """Keep pictures in place of those that differ; return the names of these."""
    changed = [name for name, now in pictures.items() if _agreed(name) != now]
    for name in changed:
        _write(GOLDENS / name, pictures[name])
    return changed


def differences(pictures: Mapping[str, str]) -> list[str]:
    """Say which pictures differ from those agreed upon, in which lines, and where they have been written."""
    told = []
    for name, now in pictures.items():
        (DRAWN / name).unlink(missing_ok=True)
        before = _agreed(name)
        if before != now:
            _write(DRAWN / name, now)
            what = "is new" if before is None else "differs:\n" + "\n".join(_lines(before, now))
            told.append(f"{name} {what}\n  see: cat {GOLDENS / name} {DRAWN / name}")
    return told


def _agreed(name: str) -> str | None:
    path = GOLDENS / name
    return path.read_text(encoding="utf-8") if path.exists() else None


def _write(path: Path, picture: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(picture, encoding="utf-8")


def _lines(before: str, now: str) -> Iterator[str]:
    pairs = enumerate(zip_longest(before.splitlines(), now.splitlines(), fillvalue=""), start=1)
    changed = [(number, *pair) for number, pair in pairs if pair[0] != pair[1]]
    for number, old, new in changed[:_MOST]:
        texts = [_CODE.sub("", line).rstrip() for line in (old, new)]
        if texts[0] == texts[1]:
            yield f"  line {number}, its colours alone: {texts[0]}"
        else:
            yield f"  line {number} was {texts[0]}"
            yield f"  line {number} is  {texts[1]}"
    if len(changed) > _MOST:
        yield f"  and {len(changed) - _MOST} lines more"
