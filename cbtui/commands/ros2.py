"""``cbtui ros2``: carries out a ros2 line in a running engine."""

from cbtui.commands.options.targets import refuse
from cbtui.text.output import is_text


def ros2(words: list[str]) -> int:
    """Carry out a ros2 line; ``--engine PID`` before it chooses one of several runs."""
    process = None
    if words[:1] == ["--engine"]:
        if len(words) < 2 or not words[1].isdecimal():
            refuse("--engine needs the process number of a cbtui run")
        process, words = int(words[1]), words[2:]
    if not all(map(is_text, words)):
        refuse("a ros2 line has to be text in UTF-8")
    from cbtui.runs.headless.ros2_line import run_line

    return run_line(words, process)
