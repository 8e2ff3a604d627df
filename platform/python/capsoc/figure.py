"""Figures for notebooks: SVG without a library."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

WIDTH, HEIGHT, MARGIN, PARTS = 640, 120, 90, 320


def _thinned(values: Sequence[float]) -> list[tuple[float, float]]:
    """(position from 0 to 1, value): the least and the largest value of each of up to PARTS parts, without NaN."""
    points = []
    step = max(1, len(values) / PARTS)
    for part in range(min(PARTS, len(values))):
        begin = int(part * step)
        piece = [(float(values[i]), i) for i in range(begin, int((part + 1) * step)) if values[i] == values[i]]
        for value, index in sorted({min(piece), max(piece)}, key=lambda point: point[1]) if piece else ():
            points.append((index / max(1, len(values) - 1), value))
    return points


def line_plot(values: Sequence[float], name: str) -> str:
    """An SVG of a curve over the number of the sample, with its least and largest value; "" of no values."""
    points = _thinned(values)
    if not points:
        return ""
    low, high = min(value for _, value in points), max(value for _, value in points)
    span = (high - low) or 1.0
    width, height = WIDTH - MARGIN - 8, HEIGHT - 16
    path = " ".join(f"{MARGIN + x * width:.1f},{8 + (high - y) / span * height:.1f}" for x, y in points)
    labels = ((14, f"{high:.4g}"), (HEIGHT / 2 + 4, name), (HEIGHT - 6, f"{low:.4g}"))
    texts = "".join(
        f'<text x="{MARGIN - 6}" y="{y:g}" text-anchor="end" font-size="11" fill="currentColor">{escape(text)}</text>'
        for y, text in labels
    )
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" role="img" aria-label="{escape(name)}">{texts}'
        f'<polyline points="{path}" fill="none" stroke="#3572b0"/></svg>'
    )
