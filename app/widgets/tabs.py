"""The strip of tabs that chooses a panel."""

import param
from panel.custom import JSComponent

from .modules import script


class Tabs(JSComponent):
    """Tabs in a row, an icon and a word each."""

    value = param.String("", doc="Id of the chosen tab.")
    tabs = param.List([], doc="(id, title, what its SVG of 24 by 24 units holds) of each.")
    label = param.String("Panels", doc="What the whole strip is called to a screen reader.")

    _esm = script("widgets/tabs")
