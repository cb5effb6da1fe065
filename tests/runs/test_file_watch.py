"""Saves are noticed, however an editor makes them."""

import asyncio
import os
from collections.abc import AsyncIterator, Callable
from contextlib import aclosing
from pathlib import Path
from typing import Any

import pytest
from watchfiles import awatch

from cbtui.runs.live import file_watch
from cbtui.runs.live.file_watch import content_of, contents

_LIMIT = 60.0


@pytest.fixture(autouse=True)
def looked_at_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file_watch, "_POLL_MS", 100)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "mine.py"
    path.write_bytes(b"one")
    return path


async def found(versions: AsyncIterator[bytes | None], wanted: bytes | None) -> list[bytes | None]:
    """Everything that came up to what is waited for."""
    seen = []
    async with asyncio.timeout(_LIMIT):
        async for content in versions:
            seen.append(content)
            if content == wanted:
                break
    return seen


def in_place(path: Path) -> None:
    path.write_bytes(b"two")


def by_renaming(path: Path) -> None:
    other = path.with_name("4913")
    other.write_bytes(b"two")
    other.replace(path)


def moved_away_and_made_anew(path: Path) -> None:
    path.rename(path.with_name("mine.py~"))
    path.write_bytes(b"two")


def taken_away_and_made_anew(path: Path) -> None:
    path.unlink()
    path.write_bytes(b"two")


@pytest.mark.parametrize(
    "save",
    [in_place, by_renaming, moved_away_and_made_anew, taken_away_and_made_anew],
    ids=lambda f: f.__name__,
)
async def test_a_save_is_noticed(file: Path, save: Callable[[Path], None]) -> None:
    async with aclosing(contents(file)) as versions:  # type: ignore[type-var]  # it is a generator
        await anext(versions)
        save(file)
        assert None not in await found(versions, b"two")


async def test_a_file_that_is_empty_in_the_middle_of_a_save_is_waited_for(file: Path) -> None:
    async with aclosing(contents(file)) as versions:  # type: ignore[type-var]  # it is a generator
        await anext(versions)
        file.write_bytes(b"")
        seen = asyncio.create_task(found(versions, b"two"))
        await asyncio.sleep(0)
        file.write_bytes(b"two")
        assert b"" not in await seen


async def test_a_file_that_is_gone_is_told_of_and_so_is_its_coming_back(file: Path) -> None:
    async with aclosing(contents(file)) as versions:  # type: ignore[type-var]  # it is a generator
        file.unlink()
        await found(versions, None)
        file.write_bytes(b"three")
        await found(versions, b"three")


async def test_where_the_system_tells_of_no_changes_the_file_is_looked_at(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def watch_or_not(*paths: Path, force_polling: bool | None, **options: Any) -> AsyncIterator[Any]:
        if not force_polling:
            raise RuntimeError("OS file watch limit reached.")
        return awatch(*paths, force_polling=force_polling, **options)

    monkeypatch.setattr(file_watch, "awatch", watch_or_not)
    async with aclosing(contents(file)) as versions:  # type: ignore[type-var]  # it is a generator
        await anext(versions)
        in_place(file)
        await found(versions, b"two")


def test_what_cannot_be_read_as_a_file_counts_as_gone(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.py")
    assert content_of(tmp_path / "pipe.py") is None
    assert content_of(tmp_path) is None
