"""The only place that draws. One module per group of figures; each public function returns Sheets:
pictures with the data they show.
"""
