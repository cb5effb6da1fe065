"""Readers take bad input or refuse it in a sentence: a little of ``python -m tests.soak.fuzz``."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.soak import fuzz_runs, results
from tests.soak.fuzz_runs import again, fuzz, input_of, keep
from tests.soak.fuzz_target import Target
from tests.soak.fuzz_targets import TARGETS
from tests.support.properties import examples

_INPUTS = {"run": 60, "prompt": 60, "completion": 150, "packages": 150, "interfaces": 150, "lesson": 150}
_OTHERS = 400
_TEXT = st.text(st.characters() | st.sampled_from("\x00\x1b\x9b\u202e\ud800[]{}=:\"'\\-#/\n\t "), max_size=60)


@pytest.mark.hypothesis
@pytest.mark.parametrize("name", TARGETS)
def test_no_input_crashes_a_reader(name: str) -> None:
    outcome = fuzz(TARGETS[name](), examples(_INPUTS.get(name, _OTHERS)), seed=1)
    assert [(crash.what, crash.where, crash.data) for crash in outcome.crashes] == []
    assert outcome.accepted + outcome.refused == outcome.inputs


@pytest.mark.hypothesis
@pytest.mark.parametrize("name", ["yaml", "parameters", "config", "arguments", "log", "setup"])
def test_no_text_crashes_a_reader(name: str) -> None:
    target = TARGETS[name]()

    @settings(max_examples=examples(60), derandomize=True, database=None, deadline=None)
    @given(_TEXT)
    def give(text: str) -> None:
        assert not isinstance(again(target, text.encode("utf-8", "surrogatepass")), tuple)

    give()


def _raising(error: Exception) -> Target:
    def take(data: bytes, _: Path) -> None:
        raise error

    return Target("bad", take, (b"one", b"two"), refusals=(LookupError,))


def test_any_exception_but_a_refusal_is_a_crash_told_once_for_its_place_and_kept(tmp_path: Path) -> None:
    outcome = fuzz(_raising(ValueError("x")), 5, seed=0)
    assert (outcome.crashed, len(outcome.crashes)) == (5, 1)
    ((crash, path),) = keep(outcome, tmp_path / "found")
    assert path.read_bytes() == crash.data == b"one"
    assert again(_raising(ValueError("x")), path.read_bytes()) is not None


def test_a_refusal_without_a_sentence_is_a_crash() -> None:
    assert fuzz(_raising(LookupError("no such thing")), 3, seed=0).refused == 3
    assert fuzz(_raising(LookupError()), 3, seed=0).crashed == 3


def test_an_endless_input_is_a_crash(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fuzz_runs, "_LONGEST", 0.05)

    def take(data: bytes, _: Path) -> None:
        while True:
            pass

    told = again(Target("endless", take, ()), b"")
    assert isinstance(told, tuple)
    assert "of computing" in told[0]


def test_the_same_seed_gives_the_same_inputs_and_another_one_others() -> None:
    target = TARGETS["yaml"]()
    first, second, other = ([input_of(target, seed, number) for number in range(50)] for seed in (1, 1, 2))
    assert first == second != other


def test_what_a_soak_came_to_is_recorded_beside_what_others_did(tmp_path: Path) -> None:
    file = tmp_path / "results.toml"
    results.record("fuzz", "yaml", {"date": "2024-01-01", "seed": 1, "inputs": 5}, file)
    results.record("keys", "walks", {"date": "2024-01-02", "seed": 2, "steps": 7}, file)
    results.record("fuzz", "yaml", {"date": "2024-01-03", "seed": 3, "inputs": 9}, file)
    assert results.read(file) == {
        "fuzz": {"yaml": {"date": "2024-01-03", "seed": 3, "inputs": 9}},
        "keys": {"walks": {"date": "2024-01-02", "seed": 2, "steps": 7}},
    }
