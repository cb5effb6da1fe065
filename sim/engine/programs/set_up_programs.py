"""Runs the programs of a set-up, from their start until all have ended."""

from collections.abc import Callable
from pathlib import Path

from sim.engine.programs.program import STOPPED, ProgramOutcome, script
from sim.engine.programs.programs import ProgramSupervisor
from sim.engine.programs.ros2_lines import Ros2Lines
from sim.engine.programs.starting import ProgramStarter, StartError
from sim.engine.setup import ProgramSetup


def run_programs(
    setup: tuple[ProgramSetup, ...], programs: ProgramSupervisor, starter: ProgramStarter, lines: Ros2Lines
) -> ProgramOutcome:
    """Run all programs, or without programs all lines, to their ends; return the outcome."""
    if len(setup) == 1 and not setup[0].is_launch_file:
        return programs.run_only(script(setup[0].path, setup[0].arguments))
    interrupts: list[Callable[[], None]] = []
    try:
        for place, program in enumerate(setup, start=1):
            if program.is_launch_file:
                launch = starter.launch(None, program.path, program.arguments, _ignore_end)
                interrupts.append(launch.interrupt)
            else:
                label = f"{Path(program.path).stem}-{place}"
                started = programs.start(script(program.path, program.arguments), label, _ignore_end)
                interrupts.append(started.interrupt)
        programs.wait_until(lambda: not (programs.any_run or lines.any_left))
    except KeyboardInterrupt:
        lines.interrupt_all()
        for interrupt in interrupts:
            interrupt()
        programs.wait_until(lambda: not programs.any_run)
        return ProgramOutcome(STOPPED, failed=False)
    except StartError as error:
        programs.interrupt_all()
        return ProgramOutcome(str(error), failed=True, status=1)
    return programs.joint_outcome()


def _ignore_end(_end: object) -> None:
    """Ignore the end of a program for which no line waits."""
