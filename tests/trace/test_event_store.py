"""The store returns the events of a run, from memory and from its file."""

import threading
from itertools import chain

import pytest

from sim.trace.events import AnyEvent, MessageSent
from sim.trace.storage import event_store, spill_file
from sim.trace.storage.event_store import EventStore
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events


def stored(size_limit: int = event_store.SIZE_LIMIT) -> EventStore:
    """A store with the events of the run, a few at a time."""
    kept = EventStore(size_limit)
    for start in range(0, len(EVENTS), 7):
        kept.take(EVENTS[start : start + 7])
    return kept


def events_in(kept: EventStore) -> list[AnyEvent]:
    return list(chain.from_iterable(kept.batches()))


def test_what_was_taken_is_given_back_in_order() -> None:
    kept = stored()
    assert events_in(kept) == EVENTS
    assert kept.missing == ""


def test_what_lies_in_the_file_is_given_back_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(event_store, "_BLOCK", 1000)
    kept = stored()
    assert kept.size > 1000
    assert events_in(kept) == EVENTS


def test_what_comes_while_it_is_read_is_not_among_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(event_store, "_BLOCK", 1000)
    kept = stored()
    batches = kept.batches()
    before = next(batches)
    writer = threading.Thread(target=kept.take, args=(EVENTS,))
    writer.start()
    writer.join()
    assert [*before, *chain.from_iterable(batches)] == EVENTS
    assert len(events_in(kept)) == 2 * len(EVENTS)


def test_a_full_store_keeps_the_beginning_whole_and_says_where_it_ends(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(event_store, "_BLOCK", 1000)
    kept = stored(size_limit=3000)
    left = events_in(kept)
    assert 0 < len(left) < len(EVENTS)
    assert left == EVENTS[: len(left)]
    assert kept.size <= 3000
    seconds = left[-1].t / 1e9
    assert kept.missing.startswith(f"what came after {seconds:.3f} s is missing, since ")
    assert kept.missing.endswith("no more than 0 MB of a run are kept")


def test_where_no_file_can_be_made_a_store_keeps_what_it_had_in_memory(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(**_: object) -> object:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(spill_file, "TemporaryFile", refuse)
    monkeypatch.setattr(event_store, "_BLOCK", 1000)
    kept = stored()
    left = events_in(kept)
    assert left == EVENTS[: len(left)]
    assert kept.missing.startswith(f"what came after {left[-1].t / 1e9:.3f} s is missing, since ")
    assert kept.missing.endswith("the temporary file cannot be written: No space left on device")


def test_what_messages_contain_is_not_kept() -> None:
    kept = EventStore()
    lost = MessageSent(0, 1, 1, None)
    kept.take([MessageSent(0, 1, 1, b"a picture"), lost])
    assert events_in(kept) == [lost]
