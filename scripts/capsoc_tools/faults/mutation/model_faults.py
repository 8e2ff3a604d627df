"""Faults of the coprocessor's model, made of its text: every place at which a small change could be an error of a
reader.

An operator is a pattern and what stands in its place; each occurrence in the code of models/coprocessor is one fault.
One that changes nothing that software or a pin can see is none: tests/third_reading/equivalent_faults.toml lists such
places, with reasons.
"""

import re

FOLDER = "models/coprocessor"
FILES = (
    "calibrator.cpp",
    "coprocessor.cpp",
    "datapath.cpp",
    "lms_demodulator.cpp",
    "paper_units.cpp",
    "polar_unit.cpp",
    "reference_generator.cpp",
    "register_bank.cpp",
    "register_rules.cpp",
    "sequencer.cpp",
    "turn_judge.cpp",
)
# What neither software nor a pin can see: words for the log, nodes, the kernel's next event, the limits of options.
UNSEEN_WORDS = ("saturated_after", "next_reference", "next_coefficients", "next_average")  # nodes
UNSEEN = (
    "write_complaint",
    "range_complaint",
    "agrees",  # when it is compiled
    "packet_nodes",
    "stage_nodes",
    "record_nodes",
    "next_event",
    "checked",
)

CUT = "[](auto v, unsigned s) { return static_cast<decltype(v)>(v >> s); }("
WRAPPED = "[](auto v, bool&) { return static_cast<int32_t>(v); }("
QUIET = "[](auto v, bool&) { bool q = false; return fixed::saturate32(v, q); }("
OPERATORS = (
    ("< becomes <=", r" < ", " <= "),
    ("<= becomes <", r" <= ", " < "),
    ("> becomes >=", r" > ", " >= "),
    (">= becomes >", r" >= ", " > "),
    ("== becomes !=", r" == ", " != "),
    ("!= becomes ==", r" != ", " == "),
    ("+ becomes -", r" \+ ", " - "),
    ("- becomes +", r" - ", " + "),
    ("&& becomes ||", r" && ", " || "),
    ("|| becomes &&", r" \|\| ", " && "),
    ("& becomes |", r" & ", " | "),
    ("|= becomes =", r" \|= ", " = "),
    ("a rounding is left out", r"(?:fixed::)?round_shift\(", CUT),
    ("a clamp wraps", r"(?:fixed::)?saturate32\(", WRAPPED),
    ("a clamp sets no flag", r"(?:fixed::)?saturate32\(", QUIET),
    ("a number is one more", r"(?<![\w.<])(\d+)(?![\w.xX>])", lambda m: str(int(m[1]) + 1)),
    ("a number is one less", r"(?<![\w.<])([1-9]\d*)(?![\w.xX>])", lambda m: str(int(m[1]) - 1)),
    ("true becomes false", r"\btrue\b", "false"),
    ("false becomes true", r"\bfalse\b", "true"),
    ("a negation is left out", r"!(?=[\w(])", ""),
    ("a sign is left out", r"(?<=[(,{=] )-(?=\w)|(?<=[({])-(?=\w)", ""),
    (
        "a statement is left out",
        r"(?m)^ {2,}(?!return|const|auto|int|uint|bool|break|case|static|using|[A-Z])[^\s{}][^{}\n]*;$",
        "  ;",
    ),
    ("a condition holds always", r"\bif \((?!const)([^{}\n;]*)\)(?= |\n)", r"if (true || (\1))"),
    ("a condition never holds", r"\bif \((?!const)([^{}\n;]*)\)(?= |\n)", r"if (false && (\1))"),
    ("u becomes v", r"\.u\b", ".v"),
    ("v becomes u", r"\.v\b", ".u"),
    ("sine becomes cosine", r"\.sine\b", ".cosine"),
    ("cosine becomes sine", r"\.cosine\b", ".sine"),
    ("max becomes min", r"std::max\(", "std::min("),
    ("min becomes max", r"std::min\(", "std::max("),
)


def blanked(text):
    """The text with what is no code of interest as blanks of the same length."""
    blank = lambda m: re.sub(r"[^\n]", " ", m[0])  # noqa: E731
    for pattern in (
        r"//[^\n]*",
        r'"[^"\n]*"',
        r"(?m)^#.*$",
        r"(?m)^using .*$",
        r"(?m)^static_assert.*$",
        r"(?m)^template .*$",
    ):
        text = re.sub(pattern, blank, text)
    for name in UNSEEN_WORDS:
        text = re.sub(rf"(?m)^[^\n;]*\.{name}\b[^;]*;", blank, text)
    for name in UNSEEN:
        text = re.sub(rf"(?ms)^[^\n]*\b{name}\(.*?^}}", blank, text)
    return text


def every(root):
    """All faults of the tree `root`, in the form of planting.py: `old` and `new` are the file's whole text."""
    faults = []
    for file in FILES:
        text = (root / FOLDER / file).read_text(encoding="utf-8")
        code = blanked(text)
        for name, pattern, new in OPERATORS:
            for match in re.finditer(pattern, code):
                planted = (
                    text[: match.start()] + match.expand(new) + text[match.end() :]
                    if isinstance(new, str) and "\\" in new
                    else text[: match.start()] + (new if isinstance(new, str) else new(match)) + text[match.end() :]
                )
                line = text.count("\n", 0, match.start() + len(match[0]) - len(match[0].lstrip())) + 1
                faults.append(
                    {
                        "name": f"{name}, line {line}",
                        "operator": name,
                        "file": f"{FOLDER}/{file}",
                        "old": text,
                        "new": planted,
                        "line": text.splitlines()[line - 1].strip(),
                    }
                )
    return faults
