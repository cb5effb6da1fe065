"""What shells complete, and the manual page."""

import subprocess
from pathlib import Path

import pytest

from cbtui import cli


@pytest.fixture
def script(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    assert cli.main(["completion", "bash"]) == 0
    path = tmp_path / "cbtui.bash"
    path.write_text(capsys.readouterr().out)
    return path


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        (["ex"], {"explore", "export"}),
        (["run", "--clo"], {"--clock"}),
        (["run", "split"], {"split-groups", "split_mine.py"}),
        (["check", "spin"], {"spin-inside-a-callback"}),
        (["open", "last"], {"last-seat"}),
        (["reset", "two-l"], {"two-locks"}),
        (["compare", "split-groups", "split"], {"split-groups", "split_mine.py"}),
        (["run", "--clock", ""], {"virtual", "real"}),
        (["--theme", "high"], {"high-contrast", "high-contrast-light"}),
        (["run", "--distro", "j"], {"jazzy"}),
    ],
)
def test_bash_completes(script: Path, words: list[str], completed: set[str]) -> None:
    (script.parent / "split_mine.py").touch()
    line = " ".join(f"'{word}'" for word in ("cbtui", *words))
    asked = (
        f"source {script.name}; COMP_WORDS=({line}); COMP_CWORD={len(words)}; "
        f"_shtab_cbtui cbtui '{words[-1]}' '{['cbtui', *words][-2]}'; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    )
    done = subprocess.run(
        ["bash", "--norc", "-c", asked], cwd=script.parent, capture_output=True, text=True, check=True
    )
    assert set(done.stdout.split()) == completed


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_are_told_the_words(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["completion", shell]) == 0
    script = capsys.readouterr().out
    for word in ("split-groups", "last-seat", "high-contrast", "lyrical", "virtual"):
        assert word in script


def test_the_manual_has_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["man"]) == 0
    page = capsys.readouterr().out
    assert page.startswith('.TH CBTUI "1"')
    assert "\n.SH NAME\ncbtui \\- A terminal teaching console" in page
    for command in ("run", "open", "explore", "lint\\-lesson"):
        assert f"cbtui {command}" in page or f"cbtui\\fR \\fI\\,{command}" in page


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (["opne"], "cbtui: there is no command 'opne'; did you mean open?"),
        (["rnu"], "did you mean run?"),
        (["help"], "cbtui: there is no command 'help'; did you mean --help?"),
        (["record"], "there is no command 'record'; did you mean run FILE.py --record FILE.mcap?"),
        (["completion"], "the following arguments are required: bash|zsh|fish"),
        (["my_node.py"], "my_node.py is not a command; cbtui open my_node.py opens it"),
        (["split-groups", "--threads", "2"], "cbtui run split-groups runs it"),
        (
            ["run", "single-thread", "--sede"],
            "cbtui run: unrecognized arguments: --sede; did you mean --seed?",
        ),
        (["run", "single-thread", "--seconds", "6"], "did you mean --for SECONDS?"),
        (["run", "single-thread", "--duration", "6"], "did you mean --for?"),
        (["check", "shared-group", "--until=6"], "unrecognized arguments: --until=6 (see cbtui check"),
        (["run", "single-thread", "--clock", "vitual"], "did you mean virtual?"),
        (
            ["run", "single-thread", "--frobnicate"],
            "unrecognized arguments: --frobnicate (see cbtui run --help)",
        ),
    ],
)
def test_a_word_that_is_nearly_right_is_told_the_right_one(
    words: list[str], near: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        cli.main(words)
    error = capsys.readouterr().err
    assert near in error
    assert error.count("\n") == 1
