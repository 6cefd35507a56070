"""Orders of a list's buttons: each is heard, also when the next one has come before anybody could look."""

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

from stair_inspector.viewer.bridge.notices import orders_from_page
from stair_inspector.viewer.parts.docked import part
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import await_that


def test_two_orders_at_once_are_both_heard():
    control, heard, may_go = SimpleNamespace(value=""), [], threading.Event()

    def act(order):
        may_go.wait(5.0)
        heard.append(order)

    called = orders_from_page(act, lambda: control.value)

    async def two_messages():
        for order in ("delete 1", "delete 2"):
            control.value = order
            await called(SimpleNamespace(client="page"))
        await called(SimpleNamespace(client=None))
        may_go.set()

    # Where the tests of the browser ran before, this thread has a loop already.
    with ThreadPoolExecutor(1) as other:
        other.submit(asyncio.run, two_messages()).result()
    assert sorted(heard) == ["delete 1", "delete 2"]


def test_two_clicks_on_rows_are_both_heard(page, session, monkeypatch):
    heard = []
    monkeypatch.setattr(part, "pick_row", lambda desk, message: heard.append(message))
    uuid = part_of(session, "docked").uuid
    for order in ("1:1", "2:2", "1:3"):
        page._send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": order}})
    await_that(lambda: len(heard) == 3, "an order was lost")
    assert sorted(heard) == ["1:1", "1:3", "2:2"]
