"""However a program waits, virtual time ends where plain Python's would."""

from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.clock.timed_waits import Runner, Step, random_program, wrong_of
from tests.clock.waits import WAITS
from tests.support.properties import examples


@pytest.fixture(scope="module")
def runner() -> Iterator[Runner]:
    started = Runner()
    yield started
    started.close()


@pytest.mark.parametrize("wait", WAITS)
def test_a_wait_lasts_as_long_as_it_is_told(wait: str, runner: Runner) -> None:
    program = [Step(wait, 0.1, 4, None), Step(wait, 1e-12, 1, None), Step(wait, 0.3, 1, 0.05)]
    assert wrong_of(program, runner.run(program)) is None


@settings(max_examples=examples(25))
@given(seed=st.integers(0, 2**32))
def test_programs_of_timed_waits_end_where_plain_python_ends(runner: Runner, seed: int) -> None:
    program = random_program(seed)
    assert wrong_of(program, runner.run(program)) is None
