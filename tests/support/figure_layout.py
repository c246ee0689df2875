"""What is wrong with the layout of a figure: texts that are cut or cover each other."""

from itertools import combinations

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

SLACK_PX = 1.5


def drawn_texts(figure):
    """[(text, box in pixels)] of what a figure shows, after it was drawn."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    hidden, shown = set(), set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            labels = {
                label for tick in axis.get_major_ticks() for label in (tick.label1, tick.label2)
            }
            labels |= {
                label for tick in axis.get_minor_ticks() for label in (tick.label1, tick.label2)
            }
            visible = axes.get_visible() and axes.axison and axis.get_visible()
            drawn = axis._update_ticks() if visible else []
            hidden |= set() if visible else {axis.label, axis.offsetText}
            shown |= {label for tick in drawn for label in (tick.label1, tick.label2)}
            hidden |= labels
    texts = [
        text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()
    ]
    texts = [text for text in texts if text not in hidden or text in shown]
    texts = [text for text in texts if text.axes is None or text.axes.get_visible()]
    renderer = canvas.get_renderer()
    return [(text, Text.get_window_extent(text, renderer)) for text in texts]


def layout_faults(figure):
    """Sentences on every text that is cut by the edge of the figure or covers another one."""
    texts = drawn_texts(figure)
    width, height = figure.bbox.width, figure.bbox.height
    faults = [
        f"'{text.get_text()}' is cut: {box.extents.round()} of {width:g} x {height:g}"
        for text, box in texts
        if box.x0 < -SLACK_PX
        or box.y0 < -SLACK_PX
        or box.x1 > width + SLACK_PX
        or box.y1 > height + SLACK_PX
    ]
    faults += [
        f"'{one.get_text()}' covers '{other.get_text()}'"
        for (one, box), (other, other_box) in combinations(texts, 2)
        if min(box.x1, other_box.x1) - max(box.x0, other_box.x0) > SLACK_PX
        and min(box.y1, other_box.y1) - max(box.y0, other_box.y0) > SLACK_PX
    ]
    return faults
