"""No message to a page is left lying: with viser alone a call at the wrong moment puts the sender to sleep for good."""

import asyncio
import threading
from types import SimpleNamespace

import pytest
import viser._messages as messages
from viser.infra._async_message_buffer import AsyncMessageBuffer

from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.wakeups import keep_waking

WAIT_S = 0.5
"""A message is sent within a sixtieth of a second."""


@pytest.fixture
def loop():
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever)
    thread.start()
    yield loop
    loop.call_soon_threadsafe(loop.stop)
    thread.join(10.0)
    loop.close()


class Wire:
    """What a page receives from a buffer; ``push_while_falling_asleep`` chooses the one moment that matters."""

    def __init__(self, loop, *, is_mended):
        self._loop = loop
        self.received = []
        self._came = threading.Condition()
        self.buffer = self._on_loop(self._make(is_mended))
        self._task = None
        self._on_loop(self._begin())

    async def _make(self, is_mended):
        buffer = AsyncMessageBuffer(self._loop, persistent_messages=False)
        if is_mended:
            keep_waking(SimpleNamespace(get_message_buffer=lambda: buffer))
        return buffer

    async def _begin(self):
        self._task = self._loop.create_task(self._send())

    async def _send(self):
        async for window in self.buffer.window_generator(0):
            with self._came:
                self.received += [message.uuid for message in window]
                self._came.notify_all()

    def _on_loop(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(10.0)

    def push(self, uuid):
        self.buffer.push(messages.RemoveNotificationMessage(uuid))

    def push_while_falling_asleep(self, uuid):
        """Push from another thread when the sender has looked at the event and does not sleep yet."""
        event = self.buffer.message_event
        # asyncio asks for the loop between the two.
        find_loop = event._get_loop

        def pushed_meanwhile():
            del event._get_loop
            other = threading.Thread(target=self.push, args=(uuid,))
            other.start()
            other.join(10.0)
            return find_loop()

        event._get_loop = pushed_meanwhile

    def has(self, *uuids):
        with self._came:
            return self._came.wait_for(lambda: self.received == list(uuids), WAIT_S)

    def close(self):
        async def end():
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

        self._on_loop(end())


@pytest.mark.parametrize("is_mended", [True, False], ids=["mended", "viser alone"])
def test_a_message_that_comes_while_the_sender_falls_asleep_wakes_it(loop, is_mended):
    wire = Wire(loop, is_mended=is_mended)
    wire.push_while_falling_asleep("b")
    wire.push("a")
    assert wire.has("a", "b") is is_mended
    wire.push("c")
    assert wire.has("a", "b", "c") is is_mended
    wire.close()


def test_messages_of_an_atomic_block_are_sent_when_it_ends(loop):
    wire = Wire(loop, is_mended=True)
    wire.push("a")
    assert wire.has("a")
    wire.buffer.atomic_start()
    wire.push("b")
    assert not wire.has("a", "b")
    wire.push("c")
    wire.buffer.atomic_end()
    assert wire.has("a", "b", "c")
    wire.close()


def test_the_server_and_every_page_are_mended(monkeypatch, tmp_path):
    from stair_inspector.viewer import app as module

    mended = []
    monkeypatch.setattr(module, "keep_waking", lambda handler: mended.append(handler))
    monkeypatch.setattr(module, "Session", lambda *_: SimpleNamespace(close=lambda: None))
    monkeypatch.setattr(module, "limit_uploads", lambda *_: None)
    app = App([tmp_path / "a.ply"], Params(), port=0)
    try:
        assert mended == [app._server._websock_server]
        client = SimpleNamespace(client_id=0, _websock_connection=object())
        app._connect(client)
        assert mended[1:] == [client._websock_connection]
    finally:
        app.stop()
