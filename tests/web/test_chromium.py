"""The console in a real browser, where there is one."""

import asyncio

import pytest

from tests.web.chromium import PROGRAM, Page, page_of
from tests.web.serving import serving


async def until(page: Page, expression: str) -> None:
    async with asyncio.timeout(60):
        while not await page.value_of(expression):
            await asyncio.sleep(0.05)


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="there is no Chromium here")
async def test_a_lesson_is_run_paused_and_left_in_a_browser_that_asks_nobody_else() -> None:
    with serving() as server:
        async with page_of(server.way_in) as page:
            await page.until_drawn("Split groups")
            await until(page, "document.body.classList.contains('-first-byte')")
            await page.press("3")
            await page.press("\r")
            await page.until_drawn("What do you expect?")
            await page.press_escape()
            await page.until_drawn("LIVE")
            await page.press("s")
            await page.until_drawn("/motor_power replied")
            await page.press(" ")
            await page.until_drawn("PAUSED")
            await page.press("[")
            await page.until_drawn("BACK")
            await page.press("0")
            await page.press(" ")
            await page.until_drawn("LIVE")
            await page.press("q")
            await page.until_drawn("Unit 5")
            assert not await page.value_of("document.body.classList.contains('-closed')")
            await page.press("q")
            await until(page, "document.body.classList.contains('-closed')")
            asked = [address for address in page.requests if not address.startswith("data:")]
    assert asked
    assert all(address.startswith(server.address) for address in asked), asked
