"""Finds the prose of the tree: passages of pages, comments and messages, each with its file and line."""

import io
import re
import subprocess
import tokenize
from dataclasses import dataclass
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]

C_LIKE = {".cpp", ".h", ".c", ".def", ".sv"}
#: Written by a tool out of other sources below this mark, so its texts are counted there.
GENERATED = "<!-- Below: written by "
#: Messages are what a user reads: not what a test prints, and not what is RTL.
MESSAGES_OF = ("platform/", "models/", "firmware/", "scripts/")
#: Texts that are not ours to edit, or that list the words.
LEFT_OUT = ("scripts/capsoc_tools/text/", "tests/quality/readability_test.py")


@dataclass(frozen=True)
class Passage:
    """A paragraph, list item, table cell, comment or string. `line`: where it begins, from 1."""

    kind: str
    file: str
    line: int
    text: str


def tracked(folder=SOURCE):
    """Paths of the files under version control, relative to the top folder."""
    command = ["git", "-c", "safe.directory=*", "-C", folder, "ls-files"]
    names = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return [name for name in names if not name.startswith(LEFT_OUT) and (folder / name).is_file()]


def kind_of_page(name):
    """Guide, reference, explanation and developer are folders of docs/; the rest stands elsewhere."""
    found = re.match(r"docs/(guide|reference|explanation|developer)/", name)
    return f"pages: {found[1]}" if found else "pages: others"


def page_passages(name, text):
    """Paragraphs, list items and table cells of a Markdown page, without code, pictures and comments."""
    kind, line, begin, gathered = kind_of_page(name), 0, 0, []
    fenced, after_blank = False, True

    def flush():
        nonlocal gathered
        if gathered:
            yield Passage(kind, name, begin, " ".join(gathered))
        gathered = []

    for line, raw in enumerate(text.splitlines(), 1):
        if raw.startswith(GENERATED):
            break
        if raw.lstrip().startswith("```"):
            fenced = not fenced
            yield from flush()
            continue
        blank = not raw.strip()
        if fenced or blank or raw.startswith(("#", "<!--", "![")) or (after_blank and raw.startswith("    ")):
            yield from flush()
            # Code goes on behind a blank line of its own; a line of prose ends it.
            after_blank = blank or after_blank or raw.startswith("#")
            continue
        after_blank = False
        if raw.startswith("|"):
            yield from flush()
            for cell in re.split(r"(?<!\\)\|", raw.strip().strip("|")):
                if re.search(r"[A-Za-z]", cell):
                    yield Passage(kind, name, line, cell.strip())
            continue
        if re.match(r"\s*([-*]|\d+\.) ", raw):
            yield from flush()
        if not gathered:
            begin = line
        gathered.append(re.sub(r"^\s*([-*]|\d+\.) ", "", raw).strip())
    yield from flush()


# A number may have digit separators, which are no quotation marks.
TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<raw>R"(?P<mark>\w*)\(.*?\)(?P=mark)")
      | (?P<text>"(?:\\.|[^"\\\n])*")
      | (?P<other>'(?:\\.|[^'\\\n])+'|\b\d[\w'.]*|[^\s"'/]+|.)""",
    re.VERBOSE | re.DOTALL,
)


def joined_comments(name, comments):
    """Passages of comments: (line, whether it has the line alone, text) in order. Neighbouring lines are one passage.

    Lines with columns or a deep indentation are tables and code, and left out.
    """
    begin, last, gathered = 0, -1, []
    for line, alone, text in [*comments, (-1, True, "")]:
        content = re.sub(r"^(///?<?|/\*+|#:?)|\*/$", "", text)
        item = re.match(r"\s*[-*] ", content)
        table = content.startswith(("   ", " |")) or "   " in content.strip()
        new = line != last + 1 or not alone or item or not content.strip() or table
        if new and gathered:
            if not gathered[0].startswith("usage: "):
                yield Passage("comments", name, begin, " ".join(gathered))
            gathered = []
        last = line
        if not table and not re.match(r"\s*(NOLINT|clang-format|flake8|noqa|pylint|!)", content):
            if not gathered:
                begin = line
            gathered += [re.sub(r"^\s*[-*] ", "", content).strip()] if content.strip() else []


def is_message(text):
    """Whether a string is words for a reader and not a name, a format or code."""
    return len(re.findall(r"(?<![\w./-])[a-z]{2,}(?![\w(=/])", text)) >= 4


def messages(name, strings):
    """Passages of strings that are words for a reader: (line, text with escapes)."""
    for line, text in strings:
        for part in re.split(r"\\n|\n", text):
            if is_message(part):
                yield Passage("messages", name, line, re.sub(r"\{[^{}]*\}|%[-\d.]*l*[sduxfg]", "X", part).strip())


def c_passages(name, text):
    """Comments and messages of C, C++ and SystemVerilog."""
    comments, strings, adjacent = [], [], False
    text = re.sub(r'(?m)^[ \t]*#[ \t]*include "[^"]*"', lambda found: " " * len(found[0]), text)
    for found in TOKEN.finditer(text):
        if found["comment"]:
            line = text.count("\n", 0, found.start()) + 1
            alone = not text[text.rfind("\n", 0, found.start()) + 1 : found.start()].strip()
            for number, part in enumerate(found["comment"].split("\n")):
                comments.append((line + number, alone, part if number == 0 else part.strip().lstrip("*")))
        elif found["text"] or found["raw"]:
            part = found["text"][1:-1] if found["text"] else found["raw"]
            if adjacent:
                strings[-1] = (strings[-1][0], strings[-1][1] + part)
            else:
                strings.append((text.count("\n", 0, found.start()) + 1, part))
            adjacent = True
        elif not found[0].isspace():
            adjacent = False
    yield from joined_comments(name, comments)
    if name.startswith(MESSAGES_OF):
        yield from messages(name, [(line, re.sub(r'\\"', '"', part)) for line, part in strings])


def python_tokens(text):
    """Tokens in which a formatted string is one, as Python's were before 3.12."""
    begins, depth = None, 0
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        kind = tokenize.tok_name[token.type]
        if kind == "FSTRING_START":
            begins, depth = begins or token.start, depth + 1
        elif kind == "FSTRING_END":
            depth -= 1
            if depth == 0:
                rows = text.split("\n")[begins[0] - 1 : token.end[0]]
                rows[-1] = rows[-1][: token.end[1]]
                rows[0] = rows[0][begins[1] :]
                yield tokenize.TokenInfo(tokenize.STRING, "\n".join(rows), begins, token.end, token.line)
                begins = None
        elif depth == 0:
            yield token


def python_passages(name, text):
    """Comments, documentation strings and messages of Python."""
    comments, strings, docs = [], [], []
    begins, adjacent = True, False
    for token in python_tokens(text):
        line = token.start[0]
        if token.type == tokenize.COMMENT:
            comments.append((line, not token.line[: token.start[1]].strip(), token.string))
            continue
        if token.type == tokenize.STRING:
            part = re.sub(r"""^[a-zA-Z]*("{3}|'{3}|"|')|("{3}|'{3}|"|')$""", "", token.string)
            if begins:
                docs += [(line + number, row) for number, row in enumerate(part.split("\n"))]
            elif adjacent:
                strings[-1] = (strings[-1][0], strings[-1][1] + part)
            else:
                strings.append((line, part))
            adjacent = True
        elif token.type != tokenize.NL:
            adjacent = False
        begins = token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.NL) or (
            begins and token.type in (tokenize.ENCODING, tokenize.COMMENT)
        )
        begins = begins and (token.type != tokenize.NL or not token.line.rstrip().endswith(("(", ",", "[", "{")))
    yield from joined_comments(name, comments)
    yield from joined_comments(name, [(line, True, " " + row if row.strip() else "") for line, row in docs])
    if name.startswith(MESSAGES_OF):
        yield from messages(name, strings)


def passages(name, text):
    """All prose of a file, by its ending; of other files nothing."""
    ending = Path(name).suffix
    if ending == ".md":
        return page_passages(name, text)
    if ending in C_LIKE:
        return c_passages(name, text)
    if ending == ".py":
        return python_passages(name, text)
    return iter(())


#: The end of a sentence. The next begins with a capital letter, a digit, emphasis, a program's or a file's name.
END = re.compile(r"(?<=[.!?])[)\"']?\s+(?=[\"'(*]*(?:[A-Z0-9-]|capsoc\b|\w+\.(?:h|cpp|md)\b)|\*[a-z])")


def sentences(passage):
    """(line, words) of the sentences of a passage. Code in backticks is one word, of a link its text counts."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)\s]*\)", r"\1", passage.text)
    text = re.sub(r"`[^`]*`", "Code", text)
    text = re.sub(r"https?://\S+", "Link", text)
    for sentence in END.split(text):
        words = re.findall(r"[A-Za-z0-9][\w'’.,/%^-]*", sentence)
        if len(words) > 4:
            yield sentence.strip(), len(words)
