"""Takes pictures of three reports for the documentation (docs/images/report_*.png) with a headless Chromium.

    scripts/tool report_pictures [--capsoc FILE] [--output FOLDER]

Small ones: one screen, in as few colours as a plot needs (rsvg-convert is not asked; pngs are written again with
a palette).
"""

import argparse
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

from capsoc_tools import ROOT, browser

WIDTH, HEIGHT = 1000, 700
#: The command, and the section that is shown; None: the first screen.
REPORTS = {
    "run": (["run"], None),
    "fit": (["fit", str(ROOT / "traces" / "csfn_h3.toml"), "--method", "adam"], None),
    "reproduce": (["reproduce", "--table", "figure-7", "--table", "1"], "section-2"),
}


def chunks(png):
    place = 8
    while place < len(png):
        (length,), kind = struct.unpack(">I", png[place : place + 4]), png[place + 4 : place + 8]
        yield kind, png[place + 8 : place + 8 + length]
        place += 12 + length


def pixels(png):
    """Rows of (r, g, b) of a PNG of 8 bits without interlacing."""
    parts = list(chunks(png))
    width, height, depth, colour, *_ = struct.unpack(">IIBBBBB", parts[0][1])
    if depth != 8 or colour not in (2, 6):
        sys.exit("report_pictures: the browser's picture is of another kind")
    size = 3 if colour == 2 else 4
    data = zlib.decompress(b"".join(body for kind, body in parts if kind == b"IDAT"))
    stride, last = width * size, bytearray(width * size)
    for y in range(height):
        how, row = data[y * (stride + 1)], bytearray(data[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            a, b = (row[i - size] if i >= size else 0), last[i]
            c = last[i - size] if i >= size else 0
            if how == 4:
                p = a + b - c
                nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[i] = (row[i] + (0, a, b, (a + b) // 2, nearest if how == 4 else 0)[how]) & 255
        last = row
        yield [tuple(v & 0xE0 | 0x10 if v < 0xF0 else 0xFF for v in row[i : i + 3]) for i in range(0, stride, size)]


def small(png):
    """The same with three bits a colour, as a palette of the most frequent 16."""
    rows = list(pixels(png))
    counts = {}
    for row in rows:
        for pixel in row:
            counts[pixel] = counts.get(pixel, 0) + 1
    palette = [p for p, _ in sorted(counts.items(), key=lambda item: (-item[1], item[0]))[:16]]
    near = {p: min(range(len(palette)), key=lambda i: sum((a - b) ** 2 for a, b in zip(p, palette[i]))) for p in counts}
    packed = b"".join(
        b"\0" + bytes(near[row[i]] << 4 | (near[row[i + 1]] if i + 1 < len(row) else 0) for i in range(0, len(row), 2))
        for row in rows
    )

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 4, 3, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"PLTE", bytes(v for p in palette for v in p))
        + chunk(b"IDAT", zlib.compress(packed, 9))
        + chunk(b"IEND", b"")
    )


def take(capsoc, name, folder):
    command, section = REPORTS[name]
    page = folder / f"{name}.html"
    done = subprocess.run([capsoc, *command, "--html", page], capture_output=True, text=True, check=False, cwd=folder)
    if done.returncode != 0:
        sys.exit(f"report_pictures: capsoc {' '.join(command)} ended with {done.returncode}:\n{done.stderr}")
    tab = browser.Browser()
    try:
        tab.emulate(width=WIDTH, dark=False)
        tab.devtools(
            "Emulation.setDeviceMetricsOverride", width=WIDTH, height=HEIGHT, deviceScaleFactor=1, mobile=False
        )
        tab.open(page)
        tab.wait("return document.documentElement.dataset.ready", "the page's script has run")
        if section:
            tab.run("document.getElementById(arguments[0]).scrollIntoView();", section)
        return small(tab.picture())
    finally:
        tab.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--capsoc", type=Path, default=ROOT / "build" / "capsoc")
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "images")
    arguments = parser.parse_args()
    if reason := browser.missing():
        sys.exit(f"report_pictures: {reason}")
    with tempfile.TemporaryDirectory() as folder:
        for name in REPORTS:
            picture = take(arguments.capsoc.resolve(), name, Path(folder))
            (arguments.output / f"report_{name}.png").write_bytes(picture)
            print(f"report_{name}.png: {len(picture)} bytes")


if __name__ == "__main__":
    main()
