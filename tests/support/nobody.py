"""Users of few rights: one without a name and a home, as in a container; one to whom a folder is closed."""

import os
from pathlib import Path

import pytest


def without_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let this process be run by such a user."""

    def unknown(_number: int) -> None:
        raise KeyError("getpwuid(): uid not found")

    monkeypatch.setattr("pwd.getpwuid", unknown)
    for name in ("HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME"):
        monkeypatch.delenv(name, raising=False)


def close(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let nobody look at what is in a folder; root would, whatever its mode."""
    stat = os.stat

    def is_closed(path: object) -> bool:
        return isinstance(path, str | Path) and Path(path).parent == folder

    def refuse(path: object, **options: bool) -> os.stat_result:
        if is_closed(path):
            raise PermissionError(13, "Permission denied", str(path))
        return stat(path, **options)  # type: ignore[arg-type]  # whatever it is, it is handed on

    monkeypatch.setattr(os, "stat", refuse)
    for name in ("exists", "isdir", "isfile"):  # what pathlib asks from Python 3.14 on
        tell = getattr(os.path, name)
        monkeypatch.setattr(os.path, name, lambda path, tell=tell: not is_closed(path) and tell(path))
