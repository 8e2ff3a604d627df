"""SAIF 2.0 (IEEE 1801, annex of the switching activity interchange format): T0, T1 and TC of each net."""

import re

NET = re.compile(r"\(\s*(\w+)\s*((?:\(\s*\w+\s+\d+\s*\)\s*)+)\)")


def write_saif(path, instance, duration, nets, timescale="1 ns"):
    """nets: (time at 0, time at 1, toggles) by name, times and `duration` in units of the timescale."""
    lines = [
        "(SAIFILE",
        '  (SAIFVERSION "2.0")',
        '  (DIRECTION "backward")',
        "  (DIVIDER / )",
        f"  (TIMESCALE {timescale})",
        f"  (DURATION {duration})",
        f"  (INSTANCE {instance}",
        "    (NET",
    ]
    lines += [
        f"      ({name} (T0 {low}) (T1 {high}) (TX 0) (TC {count}) (IG 0))" for name, (low, high, count) in nets.items()
    ]
    path.write_text("\n".join([*lines, "    )", "  )", ")", ""]), encoding="ascii")


def read_saif(path):
    """(duration, {name: (time at 0, time at 1, toggles)}) of a file with one instance. ValueError: not so."""
    text = path.read_text(encoding="ascii")
    duration = re.search(r"\(DURATION\s+(\d+)\)", text)
    if (
        not text.startswith("(SAIFILE")
        or not duration
        or text.count("(INSTANCE") != 1
        or text.count("(") != text.count(")")
    ):
        raise ValueError(f"{path}: not a SAIF file of one instance")
    nets = {}
    for name, fields in NET.findall(text):
        values = {key: int(value) for key, value in re.findall(r"\((\w+)\s+(\d+)\s*\)", fields)}
        if "TC" in values:
            nets[name] = (values["T0"], values["T1"], values["TC"])
    return int(duration[1]), nets
