"""A lesson in lines: its predictions and its explanation."""

from collections.abc import Callable
from dataclasses import dataclass
from threading import Thread

from cbtui.learning.lesson_page import PageSection, PageState, page_of
from cbtui.learning.outcome import Observe, OutcomeRun, PredictionOutcome
from cbtui.learning.stage import all_predicted, is_revealed
from cbtui.screens.linear.dialogue import Dialogue, LineHost
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.teaching.learning import signs
from lessons.lesson import Lesson
from lessons.progress import Progress
from sim.engine.setup import RealRos


@dataclass
class Teaching(ScreenPart):
    """Asks for predictions and explains the lesson; ``observe`` makes the run that shows the true answers.

    ``found`` gets the answers, on that run's own thread; ``real`` returns the ROS 2 in use.
    """

    host: LineHost
    lesson: Lesson
    observe: Observe
    found: Callable[[PredictionOutcome], None]
    real: Callable[[], RealRos | None]
    progress: Progress

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer open predictions, and the explanation."""
        return action != "predict" or self.can_predict

    @property
    def can_predict(self) -> bool:
        """Whether a question is open and its answer still locked."""
        known = self.progress.of(self.lesson.id)
        return not known.seen and not all_predicted(self.lesson, known)

    def predict(self) -> Dialogue:
        """Ask the open questions; an empty line leaves them open."""
        given = len(self.progress.of(self.lesson.id).answers)
        for place, prediction in enumerate(self.lesson.predictions[given:], start=given):
            self.host.tell_page(prediction.question)
            for number, answer in enumerate(prediction.answers, start=1):
                self.host.tell(f"{number}: {answer}")
            line = yield "Your answer is final. Type its number, or nothing to go on without predicting:"
            while line and not (line.isdecimal() and 0 < int(line) <= len(prediction.answers)):
                last = len(prediction.answers)
                line = yield f"There is no answer {line}. Type a number from 1 to {last}, or nothing:"
            if not line:
                return
            self.progress.answer(self.lesson.id, place, int(line) - 1)

    def action_predict(self) -> None:
        """Ask the open questions, and tell what to watch for."""
        self.host.ask(self._predict_and_watch())

    def _predict_and_watch(self) -> Dialogue:
        yield from self.predict()
        self.tell_page(PageSection.GUIDE)

    def action_explain(self) -> None:
        """Print the true answers and their reasons; open questions are asked first."""
        self.host.ask(self._explain())

    def _explain(self) -> Dialogue:
        is_new = not is_revealed(self.lesson, self.progress.of(self.lesson.id))
        if self.can_predict:
            yield from self.predict()
        self.progress.explain(self.lesson.id)
        if is_new:
            self.tell_page(PageSection.GUIDE)
        run = OutcomeRun(self.lesson, self.observe, self.real())
        self.host.tell("The lesson runs once more, in the background.")
        Thread(target=lambda: self.found(run.run()), name="outcome", daemon=True).start()

    def tell_explanation(self, outcome: PredictionOutcome) -> None:
        """Print the true answers, and the explanation."""
        self.tell_page(PageSection.SHOWN, PageSection.EXPLANATION, outcome=outcome)

    def tell_page(self, *sections: PageSection, outcome: PredictionOutcome | None = None) -> None:
        """Print those of some sections of the lesson's page that are unlocked."""
        page = page_of(self.lesson, PageState(self.progress.of(self.lesson.id), outcome), signs())
        for section in sections:
            self.host.tell_page(page.get(section, ""))
