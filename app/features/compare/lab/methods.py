"""The table of methods: which are seen, and how good they are."""

import param

from ....server.protocol.received import Message, ShowMethod
from ....widgets.modules import Clickable, script


class Methods(Clickable):
    """A table with a box to tick in each row; a tick reports the method's name and the box."""

    columns = param.List([], doc="(heading, what it means) of the columns after the name.")
    rows = param.List([], doc="id, title, values, note, and state of each; see `methods.js`.")
    heading = param.String("Method", doc="Heading of the names.")
    single = param.Boolean(False, doc="Whether one row at most is ticked, by round boxes.")
    label = param.String("Methods", doc="Name of the table for a screen reader.")

    _esm = script("tables/methods")

    def receive(self, message: Message) -> None:
        """Report a method that is ticked or not."""
        if isinstance(message, ShowMethod) and message.id in {row["id"] for row in self.rows}:
            self.click((message.id, message.on))
