"""Pictures that somebody has looked at, as files, and what to do when one differs.

``pytest --accept-pictures`` keeps the pictures as they are drawn now; tests that did so are skipped and not
passed, because somebody has to look at them first: ``git diff``, or ``cat`` for each.
"""

import re
from collections.abc import Iterator, Mapping
from itertools import zip_longest
from pathlib import Path

import pytest

_TESTS = Path(__file__).parents[1]
SCREENS = _TESTS / "screens" / "pictures" / "goldens"
"""Where whole screens are that are agreed upon, with their colours."""
WIDGETS = _TESTS / "widgets" / "goldens"
"""Where single widgets are, as plain text."""
LANES = _TESTS / "widgets" / "lanes" / "goldens"
"""Where lanes without a console are, as plain text."""
DRAWN = _TESTS.parent / "new_pictures"
"""Where those land that differ; nothing there is kept in the repository."""

_MOST = 6
"""How many lines of a picture are told that differ."""
_CODE = re.compile(r"\x1b\[[0-9;]*m")


def hold(pictures: Mapping[str, str], agreed: Path, config: pytest.Config) -> None:
    """Fail if pictures, by the names of their files, differ from those in the folder ``agreed``.

    Where the person has asked for that, keep them instead, and skip the test.
    """
    __tracebackhide__ = True
    if config.getoption("--accept-pictures"):
        changed = _accept(pictures, agreed)
        pytest.skip(f"{len(changed)} pictures are drawn anew; somebody has to look at them")
    told = list(_differences(pictures, agreed))
    assert not told, "\n".join(told)


def _accept(pictures: Mapping[str, str], agreed: Path) -> list[str]:
    """Keep pictures in place of those that differ; return the names of these."""
    changed = [name for name, now in pictures.items() if _text_of(agreed / name) != now]
    for name in changed:
        _write(agreed / name, pictures[name])
    return changed


def _differences(pictures: Mapping[str, str], agreed: Path) -> Iterator[str]:
    """Say which pictures differ from those agreed upon, in which lines, and where they have been written."""
    for name, now in pictures.items():
        drawn = DRAWN / agreed.parent.name / name
        drawn.unlink(missing_ok=True)
        before = _text_of(agreed / name)
        if before != now:
            _write(drawn, now)
            what = "is new" if before is None else "differs:\n" + "\n".join(_lines(before, now))
            yield f"{name} {what}\n  see: cat {agreed / name} {drawn}"


def _text_of(path: Path) -> str | None:
    return path.read_text(encoding="utf-8") if path.exists() else None


def _write(path: Path, picture: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(picture, encoding="utf-8")


def _lines(before: str, now: str) -> Iterator[str]:
    lines = before.splitlines(), now.splitlines()
    if len(lines[0]) != len(lines[1]):
        yield f"  {len(lines[0])} lines before, {len(lines[1])} now"
    pairs = enumerate(zip_longest(*lines, fillvalue=""), start=1)
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
