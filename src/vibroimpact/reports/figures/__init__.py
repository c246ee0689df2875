"""All figures; nothing else in the library draws.

There is one module per group of figures. A public function returns Plots: panels, axes and curves
as data, which `drawing` draws with matplotlib and `interactive` with plotly. A picture that is not
a plot, such as the layout of a tube, is a Sheet of matplotlib.
"""
