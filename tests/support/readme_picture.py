"""Draws the README's picture from a real run: ``python -m tests.support.readme_picture``."""

import asyncio
from pathlib import Path

import cbtui
from tests.support.console import RecordedConsole, settle
from tests.support.engine_runs import run_lesson

PICTURE = Path(cbtui.__file__).with_name("screen.svg")
SIZE = (132, 36)
MOMENT = 12.48


async def _draw() -> None:
    app = RecordedConsole("shared-group", run_lesson("shared-group", MOMENT + 1).events, MOMENT)
    async with app.run_test(size=SIZE) as pilot:
        await settle(pilot)
        PICTURE.write_text(app.export_screenshot(title="cbtui"))


if __name__ == "__main__":
    asyncio.run(_draw())
