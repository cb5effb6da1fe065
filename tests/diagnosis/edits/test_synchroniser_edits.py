"""Edits of synchronisers of ``message_filters``."""

import pytest

from sim.diagnosis.edits.synchronisers import allow_slop, lengthen_queues
from tests.diagnosis.edits.edited_source import changed

IMPORT = "from message_filters import TimeSynchronizer\n\n\n"


@pytest.mark.parametrize(
    ("made", "after"),
    [
        ("message_filters.TimeSynchronizer(subs, 9)", "message_filters.Approximate…(subs, 9, slop=0.05)"),
        ("mf.TimeSynchronizer(fs=subs, queue_size=9)", None),
        ("mf.TimeSynchronizer(subs, queue_size=9)", "mf.Approximate…(subs, queue_size=9, slop=0.05)"),
        ("mf.ApproximateTimeSynchronizer(subs, 9, 0.01)", "mf.Approximate…(subs, 9, 0.05)"),
        ("mf.ApproximateTimeSynchronizer(subs, 9, slop=SLOP)", "mf.Approximate…(subs, 9, slop=0.05)"),
        ("mf.Cache(sub, 9)", None),
    ],
)
def test_a_synchroniser_gets_a_slop(made: str, after: str | None) -> None:
    whole = after and after.replace("Approximate…", "ApproximateTimeSynchronizer")
    expected = whole and [f"-sync = {made}  # here", f"+sync = {whole}  # here"]
    assert changed(f"sync = {made}  # here\n", allow_slop, "0.05") == expected


def test_an_imported_synchroniser_is_replaced_in_the_import() -> None:
    assert changed(f"{IMPORT}sync = TimeSynchronizer(subs, 9)  # here\n", allow_slop, "0.05") == [
        "-from message_filters import TimeSynchronizer",
        "+from message_filters import ApproximateTimeSynchronizer",
        "-sync = TimeSynchronizer(subs, 9)  # here",
        "+sync = ApproximateTimeSynchronizer(subs, 9, slop=0.05)  # here",
    ]


@pytest.mark.parametrize(
    ("arguments", "after"),
    [
        ("subs, 9, slop=0.1", "subs, 90, slop=0.1"),
        ("subs, queue_size=9", "subs, queue_size=90"),
        ("subs, N", None),
    ],
)
def test_a_synchroniser_keeps_more_messages(arguments: str, after: str | None) -> None:
    expected = after and [
        f"-sync = TimeSynchronizer({arguments})  # here",
        f"+sync = TimeSynchronizer({after})  # here",
    ]
    assert changed(f"sync = TimeSynchronizer({arguments})  # here\n", lengthen_queues) == expected
