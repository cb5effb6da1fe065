"""A table answers like a plain list of rows, whatever of it is spilled."""

from bisect import bisect_left, bisect_right, insort_right

from hypothesis import given
from hypothesis import strategies as st

from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

rows = st.lists(st.tuples(st.integers(-20, 20), st.integers(-(2**63), 2**63 - 1)), max_size=60)
spills = st.builds(SpillFile, cache_size=st.integers(1, 400), entries=st.integers(1, 7))


def key(row: tuple[int, int]) -> int:
    return row[0]


def table_of(spill: SpillFile, rows: list[tuple[int, int]]) -> IntegerTable:
    table = IntegerTable(spill, 2)
    for row in rows:
        table.add(list(row))
    return table


@given(spills, rows)
def test_rows_stand_in_order_of_their_first_cell_then_of_arrival(
    spill: SpillFile, rows: list[tuple[int, int]]
) -> None:
    table, naive = table_of(spill, rows), list[tuple[int, int]]()
    for row in rows:
        insort_right(naive, row, key=key)
    assert len(table) == len(naive)
    assert [tuple(table.row(number)) for number in range(len(table))] == naive
    if naive:
        assert (table.last(0), table.last(1)) == naive[-1]


@given(spills, rows)
def test_appended_rows_keep_the_numbers_they_got(spill: SpillFile, rows: list[tuple[int, int]]) -> None:
    table = IntegerTable(spill, 2)
    assert [table.append(list(row)) for row in rows] == list(range(len(rows)))
    assert [(table.cell(number, 0), table.cell(number, 1)) for number in range(len(rows))] == rows


@given(spills, rows, st.integers(-21, 21))
def test_a_search_finds_how_many_rows_begin_before_and_until_a_key(
    spill: SpillFile, rows: list[tuple[int, int]], at: int
) -> None:
    table, naive = table_of(spill, rows), sorted(rows, key=key)
    assert table.before(at) == bisect_left(naive, at, key=key)
    assert table.until(at) == bisect_right(naive, at, key=key)


@given(spills, rows, st.slices(60))
def test_a_column_is_cut_and_walked_like_a_list(
    spill: SpillFile, rows: list[tuple[int, int]], cut: slice
) -> None:
    table = IntegerTable(spill, 2)
    for row in rows:
        table.append(list(row))
    column, naive = table.column(1, range(len(table))), [row[1] for row in rows]
    assert list(column) == naive
    assert list(column[cut]) == naive[cut]
    assert [column[cut][place] for place in range(len(naive[cut]))] == naive[cut]
    assert list(reversed(column)) == naive[::-1]


@given(spills, rows, st.lists(st.tuples(st.integers(0, 59), st.integers(0, 1), st.integers(-99, 99))))
def test_a_changed_cell_stays_changed(
    spill: SpillFile, rows: list[tuple[int, int]], changes: list[tuple[int, int, int]]
) -> None:
    table, naive = IntegerTable(spill, 2), [list(row) for row in rows]
    for row in rows:
        table.append(list(row))
    for number, column, value in changes:
        if number < len(naive):
            table.change(number, column, value)
            naive[number][column] = value
    assert [list(table.row(number)) for number in range(len(table))] == naive


@given(spills, rows, st.integers(0, 10))
def test_the_newest_cells_are_the_last_ones_of_their_column(
    spill: SpillFile, rows: list[tuple[int, int]], count: int
) -> None:
    table = IntegerTable(spill, 2)
    for row in rows:
        table.append(list(row))
    count = min(count, spill.entries)
    assert list(table.newest(1, count)) == [row[1] for row in rows][max(0, len(rows) - count) :]
