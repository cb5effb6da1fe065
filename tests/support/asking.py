"""Sessions of a puzzle without an engine: they ask who goes on."""

from cbtui.engines.session import Deliver, Ended
from lessons.puzzles import puzzles
from sim.engine.commands import Choose, Command
from sim.engine.setup import RunSetup
from sim.trace.events import ChoiceAsked, RunEnded
from tests.support.builder import Run, ns

PUZZLE = next(puzzle for puzzle in puzzles() if puzzle.id == "serve-all")
NODE = str(PUZZLE.node_path)


def question(number: int, others: tuple[str, ...] = ()) -> ChoiceAsked:
    """One about a worker that runs and one that looks for work."""
    threads = ("ThreadPoolExecutor-0_0", "ThreadPoolExecutor-0_1")
    return ChoiceAsked(ns(0.1), number, threads, ("order", ""), ((NODE, 20), ("", 0)), True, others, (0, 1))


class Asking:
    """Sessions that ask ``questions`` times behind the choices of their seed, and then say what is wanted.

    That is said if the second option was chosen each time.
    """

    def __init__(self, questions: int = 2) -> None:
        self.sessions: list[_Session] = []
        self._questions = questions

    def __call__(self, setup: RunSetup, deliver: Deliver, ended: Ended) -> "_Session":
        self.sessions.append(_Session(setup, deliver, self._questions))
        return self.sessions[-1]

    @property
    def latest(self) -> "_Session":
        """The session that was opened last."""
        return self.sessions[-1]


class _Session:
    def __init__(self, setup: RunSetup, deliver: Deliver, questions: int) -> None:
        self.setup = setup
        self.commands: list[Command] = []
        self._deliver = deliver
        self._questions = questions
        pairs = [each.partition("=") for each in str(setup.seed).removeprefix("ask:").split(",") if each]
        self._chosen = [int(option) for _, _, option in pairs]

    def start(self) -> None:
        run = Run(target="serve-all")
        run.thread("ThreadPoolExecutor-0_0")
        run.timer(run.reentrant(run.node("/kitchen")), "order", 0.1)
        self._deliver(run.events)
        self._go_on()

    def _go_on(self) -> None:
        if len(self._chosen) < self._questions:
            self._deliver([question(len(self._chosen))])
        else:
            run = Run()
            if all(self._chosen):
                run.log("both served", 0.1)
            self._deliver([*run.events[1:], RunEnded(ns(0.19), "its time was up", False, time_was_up=True)])

    def send(self, command: Command) -> None:
        self.commands.append(command)
        if isinstance(command, Choose):
            self._chosen.append(command.option)
            self._go_on()

    def stop(self) -> None:
        """There is nothing to stop."""
