"""A user number without a name, as in a container without HOME: nobody knows where its home is."""

import pytest


def without_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let this process be run by such a user."""

    def unknown(_number: int) -> None:
        raise KeyError("getpwuid(): uid not found")

    monkeypatch.setattr("pwd.getpwuid", unknown)
    for name in ("HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME"):
        monkeypatch.delenv(name, raising=False)
