"""The block ```layers of a page as a picture in SVG: a folder includes those in the rows below it."""

import re
from xml.sax.saxutils import escape

BLOCK = re.compile(r"(?m)^```layers\n(.*?)^```$", re.DOTALL)
WIDTH, LETTER, BOX, GAP = 960, 7.3, 26, 8  # pixels: the picture, a letter, a box's height, between boxes


def wrapped(names):
    """A row's names in lines that fit the picture, each as (name, left, width)."""
    lines, left = [[]], 2 * GAP
    for name in names:
        width = len(name) * LETTER + 2 * GAP
        if lines[-1] and left + width > WIDTH - GAP:
            lines.append([])
            left = 2 * GAP
        lines[-1].append((name, left, width))
        left += width + GAP
    return lines


def layers(block):
    """SVG of a block: a band for each of its lines, a box for each folder in it."""
    parts, top = [], GAP
    for row in block.splitlines():
        lines = wrapped(row.split())
        height = len(lines) * (BOX + GAP) + GAP
        parts.append(f'<rect x="{GAP}" y="{top}" width="{WIDTH - 2 * GAP}" height="{height}" fill="#eef2f6"/>')
        for number, line in enumerate(lines):
            y = top + GAP + number * (BOX + GAP)
            for name, left, width in line:
                style = f'rx="3" fill="{"#cfe3d4" if name.startswith("models/") else "#cfdcf0"}" stroke="#57606a"'
                parts.append(f'<rect x="{left:.1f}" y="{y}" width="{width:.1f}" height="{BOX}" {style}/>')
                parts.append(f'<text x="{left + GAP:.1f}" y="{y + 17}">{escape(name)}</text>')
        top += height + GAP
    size = f'width="{WIDTH}" height="{top}" viewBox="0 0 {WIDTH} {top}"'
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img">',
            "<title>Folders in layers: each includes only folders in the rows below it</title>",
            '<g font-family="\'DejaVu Sans Mono\', Consolas, monospace" font-size="12">',
            *parts,
            "</g>",
            "</svg>\n",
        ]
    )


def drawn(text):
    """A page's text with its blocks as pictures, and the pictures by their name."""
    pictures = {}

    def picture(block):
        name = f"layers_{len(pictures) + 1}.svg"
        pictures[name] = layers(block[1])
        return f"![folders in layers: each includes only folders in the rows below it]({name})"

    return BLOCK.sub(picture, text), pictures
