"""All figures; nothing else in the library draws.

There is one module per group of figures. Each public function returns Sheets: pictures with the
data they show.
"""
