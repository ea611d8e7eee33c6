"""Error and time of a bone's distances over the resolution, as curves."""

from collections.abc import Callable, Sequence

import panel as pn
from bokeh.models import FixedTicker, NumeralTickFormatter
from bokeh.plotting import figure

from cutcell_viewers.palette import JOINT_COLORS

from ..scenes.measured_distance import ErrorPoint
from ..state.distance import MEASURES, RESOLUTIONS

HEIGHT = 150
LEGEND_HEIGHT = 80
TICKS = [0.03, 0.1, 0.3, 1, 3, 10, 30]
WIDTH = 2.5


def error_curves(points: Sequence[ErrorPoint]) -> list[pn.pane.Bokeh]:
    """Return one plot of errors and one of seconds, a curve for each connectivity."""
    seconds = _plot(points, "Seconds", lambda point: point.seconds)
    seconds.object.legend.visible = False  # the one of the errors counts for both
    errors = _plot(points, "Mean error in %", lambda point: 100 * point.error)
    errors.object.height += LEGEND_HEIGHT
    return [errors, seconds]


def _plot(
    points: Sequence[ErrorPoint], title: str, value: Callable[[ErrorPoint], float]
) -> pn.pane.Bokeh:
    plot = figure(
        title=title,
        height=HEIGHT,
        sizing_mode="stretch_width",
        x_axis_type="log",
        y_axis_type="log",
        toolbar_location=None,
        tools="",
    )
    plot.xaxis.ticker = FixedTicker(ticks=list(RESOLUTIONS))
    plot.yaxis.ticker = FixedTicker(ticks=TICKS)
    plot.yaxis.formatter = NumeralTickFormatter(format="0.[00]")
    measures = dict.fromkeys(point.measure for point in points)
    for measure, color in zip(measures, JOINT_COLORS, strict=False):
        of_measure = [point for point in points if point.measure == measure]
        x, y = [point.resolution for point in of_measure], [value(point) for point in of_measure]
        name = MEASURES[measure]
        plot.line(x, y, line_width=WIDTH, color=color, legend_label=name)
        plot.scatter(x, y, size=6, color=color, legend_label=name)
    plot.add_layout(plot.legend[0], "below")
    return pn.pane.Bokeh(plot, sizing_mode="stretch_width", margin=(4, 0))
