"""Paints the factory as rows of text in inks; needs no terminal, so that a picture can be tested as text."""

from collections.abc import Sequence

from cbtui.looks.theme import Charset, TextRun
from cbtui.widgets.factory.areas import AreaPainter
from cbtui.widgets.factory.belts import BeltPainter
from cbtui.widgets.factory.canvas import FAINT, STRONG, WARN, Canvas
from cbtui.widgets.factory.plan import LARGE, LEAST_HEIGHT, LEAST_WIDTH, AreaPlacement, FactoryPlan, plan_for
from cbtui.widgets.factory.scene import FactoryScene, scene_of
from cbtui.widgets.factory.texts import Headline, first_fitting, headlines
from cbtui.widgets.factory.yard import draw_bench, draw_large_yard, draw_yard
from sim.quantities.plural import plural
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

GLANCE: Nanoseconds = 150_000_000
"""Nanoseconds for which a worker is shown walking, by default."""


class FactoryPainter:
    """Paints a run as a factory: areas with seats, belts that bring work, workers that do it."""

    def __init__(self, charset: Charset = Charset.BRAILLE) -> None:
        self.charset = charset

    def paint(
        self, timeline: Timeline, now: Nanoseconds, width: int, height: int, glance: Nanoseconds = GLANCE
    ) -> Sequence[Sequence[TextRun]]:
        """Paint the factory at ``now`` in ``width`` x ``height`` cells.

        A worker whose callback began or ended less than ``glance`` nanoseconds ago is shown walking.
        """
        if width <= 0 or height <= 0:
            return ()
        canvas = Canvas(width, height, self.charset)
        scene = scene_of(timeline, now, glance)
        summaries = headlines(scene)
        if width < LEAST_WIDTH or height < LEAST_HEIGHT:
            texts = [each.text for each in summaries]
            canvas.write(0, 0, first_fitting(texts, width) or texts[-1], STRONG, width)
            return canvas.runs()
        _draw(canvas, scene, plan_for(scene, width, height), summaries)
        return canvas.runs()


def _draw(canvas: Canvas, scene: FactoryScene, plan: FactoryPlan, summaries: Sequence[Headline]) -> None:
    columns = plan.columns
    areas = AreaPainter(canvas, scene, columns)
    belts = BeltPainter(canvas, scene, door=columns.belts - 1)
    above: AreaPlacement | None = None
    for place in plan.places:
        if plan.density.top:
            areas.top(place.area, place.first - 1, joined=above is not None and not plan.density.bottom)
        areas.inner(place, plan.density)
        if plan.density.bottom:
            areas.bottom(place.area, place.first + place.rows)
        _draw_belts(belts, place, plan)
        above = place
    if above is not None and plan.density.last:
        areas.bottom(above.area, above.first + above.rows)
    _draw_words(canvas, scene, plan, summaries)


def _draw_belts(belts: BeltPainter, place: AreaPlacement, plan: FactoryPlan) -> None:
    rows = plan.density.belt
    hidden = len(place.area.belts) - len(place.belts) + place.area.more
    line = place.first
    for number in place.belts:
        belts.draw(place.area.belts[number], place.area, line, min(rows, 2))
        line += rows
    if hidden and line < place.first + place.rows:
        belts.more(hidden, line)


def _draw_words(
    canvas: Canvas, scene: FactoryScene, plan: FactoryPlan, summaries: Sequence[Headline]
) -> None:
    columns = plan.columns
    more = f" +{plan.hidden} more {plural(plan.hidden, 'group')} " if plan.hidden else ""
    canvas.write(canvas.width - len(more), 0, more, FAINT, len(more))
    if plan.headline is not None:
        own = not plan.places or plan.places[0].first - plan.density.top > plan.headline
        room = canvas.width - len(more) - 2 if own else columns.belts - 2
        shown = next((each for each in summaries if len(each.text) <= room), Headline(""))
        at = canvas.write(1, plan.headline, shown.lead, STRONG, room)
        canvas.write(at, plan.headline, shown.trouble, WARN, len(shown.trouble))
    if plan.captions is not None:
        for column, caption in ((1, "belts"), (columns.belts + 2, "areas")):
            canvas.write(column, plan.captions, caption, FAINT, columns.area)
    if columns.yard:
        column = columns.aisle_at + columns.aisle
        first = plan.places[0].first if plan.places else 1
        canvas.write(column, max(0, first - 2), "workers", FAINT, columns.yard)
        large = plan.density is LARGE and first + 4 * len(scene.workers) <= canvas.height + 1
        if large:
            draw_large_yard(canvas, scene, column, first)
        else:
            draw_yard(canvas, scene, column, first, canvas.height)
    elif plan.bench is not None:
        draw_bench(canvas, scene, plan.bench)
