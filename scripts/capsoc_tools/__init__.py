"""The project's tools other than set-up and tests; `scripts/tool` lists and runs them."""

from pathlib import Path

#: The top folder of the sources.
ROOT = Path(__file__).resolve().parents[2]
