"""Messages to the browser that Panel would leave on the server.

While Panel writes a message, further ones wait. One that comes in the very moment in which the
write ends stays behind until something else changes: the page would show what was, without a word.
"""

from __future__ import annotations

from bokeh.document import Document
from panel.io import document
from tornado.websocket import WebSocketClosedError

_write_waiting = document._dispatch_msgs


async def write_all(doc: Document) -> None:
    """Write the messages that wait for the browser of a document, and those that come meanwhile."""
    try:
        await _write_waiting(doc)
        while doc in document._WRITE_MSGS and doc not in document._WRITE_BLOCK:
            document._WRITE_BLOCK[doc] = True
            await _write_waiting(doc)
    except WebSocketClosedError:  # The browser left between two parts of a message.
        document._WRITE_BLOCK.pop(doc, None)


def patch_panel_dispatch() -> None:
    """Patch Panel to write all messages, in every document of this process."""
    document._dispatch_msgs = write_all
