"""All pages as one PDF, printed by a headless Chromium."""

import base64
import re
import tempfile
from pathlib import Path

from capsoc_tools import browser
from capsoc_tools.pages.sphinx import build

FOOTER = '<div style="font-size: 7pt; width: 100%; text-align: center"><span class="pageNumber"></span></div>'
DATE = re.compile(rb"(/(?:CreationDate|ModDate) \(D:)\d{14}")


def printed(page):
    """The PDF of an HTML page, with an outline of its headings and numbers on its sheets."""
    shown = browser.Browser()
    try:
        shown.open(page)
        answer = shown.devtools(
            "Page.printToPDF",
            preferCSSPageSize=True,
            printBackground=True,
            displayHeaderFooter=True,
            headerTemplate="<span></span>",
            footerTemplate=FOOTER,
            generateTaggedPDF=True,
            generateDocumentOutline=True,
        )
    finally:
        shown.close()
    # The day of printing is no part of the pages.
    return DATE.sub(rb"\g<1>19700101000000", base64.b64decode(answer["data"]))


def write(top, file):
    """Writes the book of a tree's pages. Raises Faults, and OSError."""
    with tempfile.TemporaryDirectory(prefix="capsoc-book-") as temporary:
        folder = Path(temporary) / "book"
        build(top, "book", folder)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(printed(folder / "index.html"))
