#!/usr/bin/env python3
"""Writes CMake's add_test() for every Python test: discover.py FILE... (CMake calls it while it configures).

A test file is called *_test.py and says in a literal CTEST how it is run:

    name         before the colon of its entries' names, one entry a class; with "whole" the name of its only entry
    whole        True: one entry for the file
    timeout      seconds, 300 if nothing is said
    long         classes with the label "long" (scripts/test --all runs them); True: all
    serial       True: beside nothing else
    interpreter  another Python than the one that CMake found

Status 2 and a sentence on standard error: a file without CTEST, with unknown keys, or without tests.
"""

import ast
import sys
from pathlib import Path

KEYS = {"name", "whole", "timeout", "long", "serial", "interpreter"}


class BadTest(Exception):
    """A file that cannot be registered, and why."""


def classes_with_tests(tree):
    """Names of the classes of a file that have their own tests, or of a class of the same file, in order."""
    having = []
    for node in tree.body:
        if not isinstance(node, ast.ClassDef):
            continue
        own = any(isinstance(part, ast.FunctionDef) and part.name.startswith("test") for part in node.body)
        if own or any(isinstance(base, ast.Name) and base.id in having for base in node.bases):
            having.append(node.name)
    return having


def read(path):
    """(CTEST, classes with tests) of a file."""
    tree = ast.parse(path.read_text(encoding="utf-8"), str(path))
    said = [
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and [getattr(target, "id", None) for target in node.targets] == ["CTEST"]
    ]
    if len(said) != 1:
        raise BadTest(f"{path}: has no CTEST = {{...}}; say how it is run (tests/discover.py lists the keys)")
    settings = ast.literal_eval(said[0])
    if unknown := settings.keys() - KEYS:
        raise BadTest(f"{path}: CTEST has no key {sorted(unknown)[0]}; tests/discover.py lists the keys")
    classes = classes_with_tests(tree)
    if not classes:
        raise BadTest(f"{path}: has no class with tests; is it a test?")
    return settings, classes


def entries(path, settings, classes):
    """(name, class or nothing, whether it takes long) of each entry."""
    long = settings.get("long", [])
    if unknown := set([] if long is True else long) - set(classes):
        raise BadTest(f'{path}: CTEST["long"] has no class {sorted(unknown)[0]}')
    if settings.get("whole"):
        yield settings["name"], None, long is True
    else:
        for name in classes:
            yield f"{settings['name']}: {name}", name, long is True or name in long


def cmake_of(path):
    """add_test() for a file's entries."""
    settings, classes = read(path)
    interpreter = settings.get("interpreter", "${Python3_EXECUTABLE}")
    for name, suite, is_long in entries(path, settings, classes):
        yield f"add_test(NAME [==[{name}]==] COMMAND {interpreter} [==[{path}]==] -v {suite or ''})"
        properties = ["TIMEOUT", str(settings.get("timeout", 300)), "ENVIRONMENT", "${CAPSOC_PYTHON_TEST_ENVIRONMENT}"]
        properties += ["RUN_SERIAL", "TRUE"] if settings.get("serial") else []
        properties += ["LABELS", "long"] if is_long else []
        quoted = " ".join(f'"{word}"' for word in properties)
        yield f"set_tests_properties([==[{name}]==] PROPERTIES {quoted})"


def main():
    try:
        for name in sys.argv[1:]:
            print(*cmake_of(Path(name)), sep="\n")
    except (BadTest, SyntaxError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
