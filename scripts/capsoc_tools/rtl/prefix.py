"""Names of the RTL that every design in a project shares: modules, packages, types and macros get a prefix.

A kit goes into projects that have a `datapath` and a `sample_t` already.
"""

import re

PREFIX = "capsoc_"
OPENING = re.compile(r"^(?:module|package|interface)\s+(\w+)", re.MULTILINE)
# A type outside of any module: their declarations begin in the first column.
TYPE = re.compile(r"^typedef\s[^;]*?(?:\{[^}]*\}\s*)?(\w+)\s*;", re.MULTILINE)
MACRO = re.compile(r"^\s*`define\s+(\w+)", re.MULTILINE)
# What may hold a name; a name after a dot is a port's, a parameter's or a member's, one after :: a package's.
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|"[^"\n]*"|(?:\.|::)\s*\w+|\w+', re.DOTALL)
FILE = re.compile(r"\b(\w+)(?=\.sv\b)")


def shared_names(texts):
    """The names of the sources `texts` that have no prefix yet."""
    found = set()
    for text in texts:
        for kind in (OPENING, TYPE, MACRO):
            found.update(kind.findall(text))
    return {name for name in found if not name.startswith((PREFIX, PREFIX.upper()))}


def prefixed(name):
    """Macros are in capitals."""
    return (PREFIX.upper() if name.isupper() else PREFIX) + name


def file_name(file):
    return file.name if file.name.startswith(PREFIX) else PREFIX + file.name


def with_prefix(text, names):
    """A source with its shared `names` prefixed; in comments those of files."""

    def changed(token):
        word = token[0]
        if word.startswith(("//", "/*")):
            return FILE.sub(lambda file: prefixed(file[1]) if file[1] in names else file[1], word)
        return prefixed(word) if word in names else word

    return TOKEN.sub(changed, text)
