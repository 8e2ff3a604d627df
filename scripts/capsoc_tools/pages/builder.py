"""An extension of Sphinx: the builder of the book, and the kinds of blocks that only the pages have."""

import re

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.addnodes import start_of_file
from sphinx.builders.singlehtml import SingleFileHTMLBuilder


class Book(SingleFileHTMLBuilder):
    """All pages as one, in which an anchor is called PAGE:ANCHOR, since several pages have a heading of one name."""

    name = "book"

    def fix_refuris(self, tree):
        for link in tree.findall(nodes.reference):
            # Without the name of the file since Sphinx 7.
            if found := re.match(r"(?:index\.html)?#document-([^#]*)#?(.*)", link.get("refuri", "")):
                page, anchor = found.groups()
                link["refuri"] = f"#{page}:{anchor}" if anchor else f"#document-{page}"

    def assemble_doctree(self):
        tree = super().assemble_doctree()
        pages = list(tree.findall(start_of_file))
        named = {id(node): page["docname"] for page in pages for node in page.findall()}
        for node in tree.findall(nodes.Element):
            page = named.get(id(node), "index")
            node["ids"] = [f"{page}:{name}" for name in node["ids"]]
            if "refid" in node:
                node["refid"] = f"{page}:{node['refid']}"
        tree.next_node(nodes.section)["ids"].append("document-index")
        return tree


def setup(app):
    app.add_builder(Book)
    app.add_lexer("kinds", TextLexer)  # a block of docs/explanation/architecture.md that a test reads
    return {"parallel_read_safe": True, "parallel_write_safe": True}
