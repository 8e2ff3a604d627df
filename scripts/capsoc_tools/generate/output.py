"""What the generators have in common: a fault of the source with its line, and outputs written only if they change."""

import sys
from pathlib import Path


class SourceError(Exception):
    """What is wrong and what to do, with the line it is on."""

    def __init__(self, line, message):
        super().__init__(message)
        self.line = line


def write_if_changed(path, text):
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def generate(arguments, usage, texts):
    """Writes what `texts(source)` returns, a text by name, of the source to the output folder: the two arguments.
    Returns the status: 2 with a sentence on standard error if something is wrong, and nothing is written then.
    """
    if len(arguments) != 2:
        print(f"usage: {usage}", file=sys.stderr)
        return 2
    source, output = Path(arguments[0]), Path(arguments[1])
    try:
        made = texts(source)
        output.mkdir(parents=True, exist_ok=True)
        for name, text in made.items():
            write_if_changed(output / name, text)
    except SourceError as error:
        print(f"{source}:{error.line}: {error}", file=sys.stderr)
        return 2
    except (OSError, UnicodeDecodeError) as error:
        print(f"{source}: {error}; check the paths", file=sys.stderr)
        return 2
    return 0
