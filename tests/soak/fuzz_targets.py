"""Every target by its name. Each is made when it is asked for: some need a moment, or a node."""

from collections.abc import Callable

from tests.soak.fuzz_target import Target
from tests.soak.fuzz_targets_files import (
    config,
    interfaces,
    lesson,
    packages,
    parameters,
    progress,
    setup,
    yaml,
)
from tests.soak.fuzz_targets_lines import arguments, completion, log, prompt
from tests.soak.fuzz_targets_runs import commands, events, recording, run

TARGETS: dict[str, Callable[[], Target]] = {
    "recording": recording,
    "events": events,
    "run": run,
    "commands": commands,
    "setup": setup,
    "prompt": prompt,
    "completion": completion,
    "yaml": yaml,
    "parameters": parameters,
    "lesson": lesson,
    "config": config,
    "interfaces": interfaces,
    "packages": packages,
    "arguments": arguments,
    "progress": progress,
    "log": log,
}
