"""Sphinx: ./dev docs makes build/docs/index.html of this folder. Packages: python3-sphinx, python3-myst-parser, furo,
libjs-katex, fonts-katex of Debian 12 or 13. sphinx/kerf_docs.py holds what is our own."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "sphinx"))

project = "kerf"
author = "the kerf developers"
copyright = author
version = release = (pathlib.Path(__file__).parent.parent / "VERSION").read_text().strip()
extensions = ["myst_parser", "kerf_docs"]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
exclude_patterns = ["sphinx"]
smartquotes = False  # values of keys are copied
html_theme = "furo"
html_title = f"kerf {release}"
html_static_path = ["sphinx/static"]
html_css_files = ["kerf.css"]
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False
html_math_renderer = "katex"
