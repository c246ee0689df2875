"""How Sphinx builds the documentation site; `make docs` runs it."""

import sys
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "docs")]

project = "vibroimpact"
author = "The vibroimpact authors"
release = version = import_module("vibroimpact").__version__
html_title = f"vibroimpact {release}"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx-mathjax-offline", "site_pages"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 4
exclude_patterns = ["_build", "examples", "generated/*.md"]

autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "exclude-members": "model_config"}
add_module_names = False

# Nothing is fetched: the theme uses the fonts of the system, MathJax comes with its extension.
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
pygments_style = "friendly"
highlight_language = "text"
