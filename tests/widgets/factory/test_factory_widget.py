"""The factory on screen: it draws what is set, survives any size, and looks the same again in a replay."""

from textual.app import App, ComposeResult

from cbtui.looks.theme import Charset
from cbtui.widgets.factory import FactoryPainter, FactoryView
from tests.support.runs import ns, split_groups_run
from tests.widgets.pictures import plain, shared_group, split_groups


class OneWidget(App[None]):
    def compose(self) -> ComposeResult:
        yield FactoryView()


def lines_of(view: FactoryView) -> list[str]:
    return [view.render_line(y).text for y in range(view.size.height)]


async def test_the_factory_draws_on_screen_what_its_painter_paints() -> None:
    app = OneWidget()
    timeline = shared_group()
    async with app.run_test(size=(78, 9)) as pilot:
        view = app.query_one(FactoryView)
        view.timeline, view.now = timeline, ns(12.9)
        await pilot.pause()
        assert "\n".join(lines_of(view)) == plain(FactoryPainter().paint(timeline, ns(12.9), 78, 9))
        assert view.border_title == "3 Factory"


async def test_a_longer_glance_keeps_workers_walking() -> None:
    app = OneWidget()
    async with app.run_test(size=(78, 9)) as pilot:
        view = app.query_one(FactoryView)
        view.timeline, view.now = split_groups(), ns(4.5)
        await pilot.pause()
        seated = lines_of(view)
        view.glance = ns(1.0)
        await pilot.pause()
        assert any("◂☻" in line for line in lines_of(view))
        assert not any("◂☻" in line for line in seated)


async def test_a_timeline_that_grew_is_painted_when_it_is_set_again() -> None:
    app = OneWidget()
    events = split_groups_run().events
    async with app.run_test(size=(64, 12)) as pilot:
        view = app.query_one(FactoryView)
        view.now = ns(5.0)
        view.timeline.extend(event for event in events if event.t < ns(1))
        view.timeline = view.timeline
        await pilot.pause()
        before = lines_of(view)
        view.timeline.extend(event for event in events if ns(1) <= event.t < ns(6))
        view.timeline = view.timeline
        await pilot.pause()
        assert lines_of(view) != before


async def test_the_factory_survives_any_size_and_charset() -> None:
    app = OneWidget()
    async with app.run_test(size=(80, 24)) as pilot:
        view = app.query_one(FactoryView)
        view.timeline, view.now = split_groups(), ns(9.4)
        for width, height in ((140, 40), (1, 1), (38, 10), (250, 70)):
            await pilot.resize_terminal(width, height)
            await pilot.pause()
            assert all(len(line) == view.size.width for line in lines_of(view))
        view.charset = Charset.ASCII
        await pilot.pause()
        assert "".join(lines_of(view)).isascii()
