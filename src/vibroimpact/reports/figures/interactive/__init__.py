"""Interactive plots of pages, the only place that knows plotly: data and layout for plotly.js."""
