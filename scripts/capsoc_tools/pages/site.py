"""Makes the site and the book of README.md and the pages of docs; both are read without a network.

    scripts/tool site [--out FOLDER] [--book FILE.pdf]

The site is a folder of HTML pages with a search. It is opened as a file (index.html) or from a server. The same pages
give the same bytes. The book is a PDF of all pages, printed by a headless Chromium.
"""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from capsoc_tools import ROOT, browser
from capsoc_tools.pages import book, sphinx
from capsoc_tools.pages.staging import Faults


def replace(made, out):
    """Puts a made site where one was before, or where nothing is."""
    if out.exists():
        if any(out.iterdir()) and not (out / "searchindex.js").is_file():
            raise Faults([f"{out}: holds files that are no site; name another folder"])
        shutil.rmtree(out)
    out.parent.mkdir(parents=True, exist_ok=True)
    shutil.copytree(made, out)


def make(options):
    if options.out or not options.book:
        out = options.out or ROOT / "build" / "site"
        with tempfile.TemporaryDirectory(prefix="capsoc-site-") as temporary:
            made = Path(temporary) / "site"
            sphinx.build(options.source, "html", made)
            replace(made, out)
        print(out / "index.html")
    if options.book:
        book.write(options.source, options.book)
        print(options.book)


def main(arguments):
    parser = argparse.ArgumentParser(prog="site", description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="where the site is written (build/site)")
    parser.add_argument("--book", type=Path, metavar="FILE.pdf", help="writes the book; the site then only with --out")
    parser.add_argument(
        "--source", type=Path, default=ROOT, metavar="FOLDER", help="the tree with the pages (this one)"
    )
    options = parser.parse_args(arguments)
    try:
        if why := sphinx.missing() or (options.book and browser.missing()):
            raise Faults([why])
        make(options)
    except Faults as faults:
        for sentence in faults.sentences:
            print(f"site: {sentence}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"site: {error}; check the paths", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
