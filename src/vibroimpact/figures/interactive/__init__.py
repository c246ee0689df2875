"""Interactive plots of the page of a study, the only place that knows plotly.

They are data and layout for plotly.js; nothing is drawn here.
"""
