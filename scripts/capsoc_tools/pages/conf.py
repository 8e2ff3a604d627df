"""Sphinx configuration of the site and the book (scripts/tool site).

Sphinx rather than MkDocs Material, and its "Read the Docs" theme rather than furo: with Debian's packages these work
in a browser that has opened a page as a file. Sphinx loads its search index as a script. MkDocs loads its own by a
request, which browsers refuse for files. Debian's furo takes a style from the top folder of a server, and its script
imports modules that are not there.
"""

project = "capsoc"
author = "capsoc maintainers"
root_doc = "index"
extensions = ["myst_parser", "capsoc_tools.pages.builder"]
nitpicky = True
smartquotes = False  # text is copied into terminals

# Pages are in GitHub's Markdown: with its anchors, without MyST's own syntax inside a line.
myst_heading_anchors = 6
myst_disable_syntax = ["myst_role", "myst_line_comment", "myst_block_break", "myst_target"]
highlight_language = "none"

html_theme = "sphinx_rtd_theme"
html_static_path = ["static"]
html_css_files = ["pages.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_last_updated_fmt = None
html_use_index = False
# Excerpts of found pages would come by requests.
html_show_search_summary = False
