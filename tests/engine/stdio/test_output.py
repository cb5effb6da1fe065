from sim.engine.stdio.output import LineSink


def lines_of(*texts: str) -> list[str]:
    lines: list[str] = []
    sink = LineSink(lines.append)
    for text in texts:
        sink.write(text)
    sink.finish()
    return lines


def test_a_line_is_handed_on_when_it_is_complete_and_the_last_one_at_the_end() -> None:
    assert lines_of("a", "b\nc\n", "\n", "d") == ["ab", "c", "", "d"]


def test_lines_may_end_as_in_a_terminal_in_raw_mode() -> None:
    assert lines_of("one\r\ntwo\r", "\n", "50 %\r100 %\n") == ["one", "two", "50 %\r100 %"]


def test_bytes_are_text_too_and_those_that_are_none_are_spelt_out() -> None:
    lines: list[str] = []
    sink = LineSink(lines.append)
    letter = "ä".encode()
    assert sink.buffer.write(b"a\xff" + letter[:1]) == 3
    sink.buffer.write(letter[1:] + b"\n")
    assert lines == ["a\\xffä"]


def test_a_line_that_is_too_long_comes_in_pieces_ended_or_not() -> None:
    assert [len(line) for line in lines_of("x" * 10_000 + "\n")] == [4096, 4096, 1808]
    assert [len(line) for line in lines_of("x" * 5_000, "y" * 5_000)] == [4096, 4096, 1808]
    assert [len(line) for line in lines_of("x" * 4096 + "\n", "y" * 4096)] == [4096, 4096]


def test_nothing_is_lost_of_a_very_long_line() -> None:
    text = "0123456789" * 1_000_000
    assert "".join(lines_of(text)) == text
