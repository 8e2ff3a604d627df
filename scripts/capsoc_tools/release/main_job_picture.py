"""Draws what the main job prints as an SVG of text (docs/images/main_job.svg).

    scripts/tool main_job_picture [--capsoc FILE] [--output FILE]

Left out: the host's time, which differs from run to run, and what repeats itself.
"""

import argparse
import html
import os
import re
import subprocess
import sys
from pathlib import Path

from capsoc_tools import ROOT

PROMPT = "$ capsoc run"

# A terminal of its own colours, so it reads the same on a light and on a dark page.
BACKGROUND, BORDER, TEXT, PROMPT_COLOUR, FIGURE = "#1c2128", "#57606a", "#d9e0e8", "#8ab4f8", "#7ee2a0"
SIZE, ADVANCE, LEADING, MARGIN = 13, 7.8, 18, 16
# What the eye shall find: the angle error before and after.
FIGURES = ("largest angle error", "  last turn", "  in calibration mode", "all six", "selfcal: pass")


def output_of(capsoc):
    """The lines of UART 0, and those of the table on stderr."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("CAPSOC_")}
    run = subprocess.run([capsoc, "run"], capture_output=True, text=True, check=False, env=clean)
    if run.returncode != 0:
        sys.exit(f"main_job_picture: {capsoc} run ended with {run.returncode}:\n{run.stderr}")
    return run.stdout.splitlines(), run.stderr.splitlines()


def left_out(uart):
    """What the picture can do without: most of the progress and of the angles, and the table that comes again below."""
    progress = [line for line in uart if line.startswith("t ")]
    angles = [line for line in uart if line.startswith("angle ")]
    table = [line for line in uart if line.startswith(("parameter ", "a1 ", "a2 ", "b1 ", "b2 ", "beta ", "phi "))]
    if not (progress and angles and table):
        sys.exit("main_job_picture: the main job printed no progress, no angles or no parameters")
    return progress[1:-1] + angles[1:-1] + table


def shown(uart, table):
    """Without what differs from run to run; dots for what is left out."""
    out = left_out(uart)
    kept = [PROMPT]
    for line in uart:
        if line not in out:
            kept.append(line)
        elif kept[-1] != "...":
            kept.append("...")
    return kept + [re.sub(r"simulated s in .*?times real time\)", "simulated s", line) for line in table]


def draw(lines):
    width = round(2 * MARGIN + ADVANCE * max(map(len, lines)))
    height = 2 * MARGIN + LEADING * len(lines)
    svg = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" role="img">',
        "<title>What the main job prints: the firmware's UART, then the identified parameters "
        "and the angle error</title>",
        f'<rect x="0.5" y="0.5" width="{width - 1}" height="{height - 1}" rx="8" '
        f'fill="{BACKGROUND}" stroke="{BORDER}"/>',
        f"<g font-family=\"ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace\" "
        f'font-size="{SIZE}" fill="{TEXT}">',
    ]
    for row, line in enumerate(lines):
        if not line:
            continue
        colour = PROMPT_COLOUR if row == 0 else FIGURE if line.startswith(FIGURES) else None
        y = MARGIN + LEADING * row + SIZE
        fill = f' fill="{colour}"' if colour else ""
        # Each column by itself, since viewers take several spaces for one. textLength: it has its width in any font.
        for part in re.finditer(r"\S+( \S+)*", line):
            x = MARGIN + ADVANCE * part.start()
            length = ADVANCE * len(part[0])
            svg.append(f'<text x="{x:g}" y="{y}" textLength="{length:.4g}"{fill}>{html.escape(part[0])}</text>')
    return "\n".join(svg + ["</g>", "</svg>"]) + "\n"


def main():
    parser = argparse.ArgumentParser(description="Draws what the main job prints as an SVG.")
    parser.add_argument("--capsoc", type=Path, default=ROOT / "build" / "capsoc", help="the program (build/capsoc)")
    parser.add_argument(
        "--output", type=Path, default=ROOT / "docs" / "images" / "main_job.svg", help="(docs/images/main_job.svg)"
    )
    arguments = parser.parse_args()
    try:
        arguments.output.write_text(draw(shown(*output_of(arguments.capsoc))))
    except OSError as error:
        sys.exit(f"main_job_picture: {error.filename}: {error.strerror}")


if __name__ == "__main__":
    main()
