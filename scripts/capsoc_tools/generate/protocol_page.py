#!/usr/bin/env python3
"""Writes the methods of the session protocol into docs/reference/protocol.md, out of what `capsoc serve --schema` says.

usage: protocol_page [--check] [CAPSOC]   (default: build/capsoc)
With --check nothing is written; status 1 if the page is not what it would become.
"""

import json
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
PAGE = SOURCE / "docs" / "reference" / "protocol.md"
BEGIN = "<!-- Below: written by scripts/tool protocol_page out of capsoc serve --schema. -->\n"


def table(rows, heading):
    """A Markdown table of rows of texts, or nothing without rows."""
    if not rows:
        return ""
    lines = [heading, [" --- "] * len(heading), *rows]
    texts = [
        [
            cell if cell == " --- " else f" {cell.replace('|', chr(92) + '|').strip()} ".replace("  ", " ")
            for cell in line
        ]
        for line in lines
    ]
    return "".join(f"|{'|'.join(line)}|\n" for line in texts) + "\n"


def methods(schema):
    """The reference, a section for each subject."""
    text, subject = "", None
    subjects = list(dict.fromkeys(method["name"].split(".")[0] for method in schema["methods"]))
    for method in sorted(schema["methods"], key=lambda each: subjects.index(each["name"].split(".")[0])):
        name = method["name"].split(".", maxsplit=1)[0]
        if name != subject:
            subject = name
            text += f"### {subject}\n\n"
        text += f"**`{method['name']}`** {method['text']}\n\n"
        given = [
            [f"`{part['name']}`", part["type"] + ("" if part["required"] else ", optional"), part["text"]]
            for part in method["params"]
            if part["name"] != "simulation"
        ]
        told = [[f"`{part['name']}`", part["type"], part["text"]] for part in method["result"]]
        text += table(given, ["parameter", "type", "meaning"])
        text += table(told, ["result", "type", "meaning"])
    return text.rstrip("\n") + "\n"


def page(capsoc):
    """What docs/reference/protocol.md should be."""
    schema = json.loads(subprocess.run([capsoc, "serve", "--schema"], capture_output=True, check=True).stdout)
    head, mark, _ = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    if not mark:
        raise SystemExit(f"{PAGE}: the line that begins the methods is missing")
    return head + BEGIN + "\n" + methods(schema)


def main(arguments):
    check = "--check" in arguments
    rest = [word for word in arguments if word != "--check"]
    if len(rest) > 1 or any(word.startswith("-") for word in rest):
        print(__doc__, file=sys.stderr)
        return 2
    text = page(rest[0] if rest else SOURCE / "build" / "capsoc")
    if text == PAGE.read_text(encoding="utf-8"):
        return 0
    if check:
        print(
            "docs/reference/protocol.md is not what capsoc serve --schema says: scripts/tool protocol_page",
            file=sys.stderr,
        )
        return 1
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
