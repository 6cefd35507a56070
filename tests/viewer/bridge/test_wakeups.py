"""No message to a page is left lying: with viser alone a call at the wrong moment puts the sender to sleep for good."""

import asyncio
import threading
from types import SimpleNamespace

import pytest
import viser._messages as messages
from viser.infra._async_message_buffer import AsyncMessageBuffer

from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.bridge.wakeups import keep_waking
from tests.viewer.wire_page import SETTLE_S

NEVER_S = 0.5
"""What has not come by then does not come: a message is sent within a sixtieth of a second."""


class Wire:
    """What a page receives from a buffer."""

    def __init__(self, loop):
        self._loop = loop
        self._received = []
        self._came = threading.Condition()
        self.buffer, self._task = self._on_loop(self._begin())

    async def _begin(self):
        buffer = AsyncMessageBuffer(self._loop, persistent_messages=False)
        return buffer, self._loop.create_task(self._send(buffer))

    async def _send(self, buffer):
        async for window in buffer.window_generator(0):
            with self._came:
                self._received += [message.uuid for message in window]
                self._came.notify_all()

    def _on_loop(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(SETTLE_S)

    def mend(self):
        keep_waking(SimpleNamespace(get_message_buffer=lambda: self.buffer))

    def push(self, uuid):
        self.buffer.push(messages.RemoveNotificationMessage(uuid))

    def send_while_falling_asleep(self, first, second, push):
        """Push a message, and another one when the sender has looked at the event and does not sleep yet."""
        event, has_pushed = self.buffer.message_event, threading.Event()
        # asyncio asks for the loop between the two.
        find_loop = event._get_loop

        def pushed_meanwhile():
            del event._get_loop
            other = threading.Thread(target=push, args=(second,))
            other.start()
            other.join(SETTLE_S)
            has_pushed.set()
            return find_loop()

        event._get_loop = pushed_meanwhile
        self.push(first)
        assert has_pushed.wait(SETTLE_S), "the sender does not fall asleep as it did"

    def receives(self, *uuids):
        with self._came:
            return self._came.wait_for(lambda: self._received == [*uuids], SETTLE_S)

    def stays_at(self, *uuids):
        with self._came:
            return not self._came.wait_for(lambda: self._received != [*uuids], NEVER_S)

    def close(self):
        async def end():
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

        self._on_loop(end())


@pytest.fixture
def wire():
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever)
    thread.start()
    wire = Wire(loop)
    yield wire
    wire.close()
    loop.call_soon_threadsafe(loop.stop)
    thread.join(SETTLE_S)
    loop.close()


def from_a_loop_of_its_own(push):
    """Return a function that pushes as a program does whose threads have event loops too."""

    async def pushing(uuid):
        push(uuid)

    return lambda uuid: asyncio.run(pushing(uuid))


@pytest.mark.parametrize("has_loop", [False, True], ids=["plain thread", "thread with a loop"])
def test_a_message_that_comes_while_the_sender_falls_asleep_wakes_it(wire, has_loop):
    wire.mend()
    wire.send_while_falling_asleep("a", "b", from_a_loop_of_its_own(wire.push) if has_loop else wire.push)
    assert wire.receives("a", "b")
    wire.push("c")
    assert wire.receives("a", "b", "c")


def test_viser_alone_sleeps_on_and_is_woken_once_it_is_mended(wire):
    """The test above proves something; and a call that was lost before the mend is made up for."""
    wire.send_while_falling_asleep("a", "b", wire.push)
    assert wire.receives("a")
    wire.push("c")
    assert wire.stays_at("a")
    wire.mend()
    wire.push("d")
    assert wire.receives("a", "b", "c", "d")


def test_messages_of_an_atomic_block_are_sent_when_it_ends(wire):
    wire.mend()
    wire.push("a")
    assert wire.receives("a")
    wire.buffer.atomic_start()
    wire.push("b")
    wire.push("c")
    assert wire.stays_at("a")
    wire.buffer.atomic_end()
    assert wire.receives("a", "b", "c")


def test_the_server_and_every_page_are_mended(monkeypatch, tmp_path):
    mended = []
    monkeypatch.setattr("stair_inspector.viewer.bridge.server.keep_waking", mended.append)
    monkeypatch.setattr("stair_inspector.viewer.app.limit_uploads", lambda *_: None)
    monkeypatch.setattr("stair_inspector.viewer.app.check_values", lambda _: None)
    monkeypatch.setattr("stair_inspector.viewer.app.Page", lambda *_: SimpleNamespace(close=lambda: None))
    app = App([tmp_path / "a.ply"], Params(), port=0)
    try:
        client = SimpleNamespace(client_id=0, _websock_connection=object())
        app._connect(client)
        assert mended == [app._server._websock_server, client._websock_connection]
    finally:
        app.stop()
