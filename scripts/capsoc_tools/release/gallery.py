"""Makes the repository's own reports and a page that shows them all, without a network.

    scripts/tool gallery FOLDER [--capsoc FILE] [--only NAME]...

FOLDER/index.html has for each report its title, its answer, a picture, and the commands that made it. Status 1 and a
sentence: a command ended otherwise than it should. Everything takes about a minute; --only run a second.
"""

import argparse
import html
import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from capsoc_tools import ROOT


@dataclass
class Report:
    """One page, and how it is made: the commands write NAME.json, the last one NAME.html, too."""

    name: str
    title: str
    what: str  # in a sentence
    commands: list
    figure: str  # of capsoc report --list-figures
    results: tuple = ()  # of the picture, if it is not NAME.json
    ends: tuple = (0,)  # what the commands may end with


def trace(name):
    return str(ROOT / "traces" / name)


REPORTS = (
    Report(
        "run",
        "The main job",
        "The firmware calibrates the sensor of the SoC paper's Eq (21) in 400 s.",
        ["run --curves --json run.json --html run.html"],
        "angle-error",
    ),
    Report(
        "fit",
        "A recording is fitted",
        "The parameters of a recorded sensor with their intervals and a bound of the angle.",
        [f"fit {shlex.quote(trace('recorded_example.csv'))} --curves --json fit.json --html fit.html"],
        "fit-ellipse",
    ),
    Report(
        "campaign",
        "A small campaign",
        "Forty runs: the noise of the converter against the angle error.",
        [
            f"campaign run {shlex.quote(str(ROOT / 'campaigns' / 'small.toml'))} --store campaign.sqlite"
            " --json campaign.json --html campaign.html"
        ],
        "campaign-yield",
    ),
    Report(
        "regress",
        "A short regression",
        "The RTL of the coprocessor and its model, every scenario with one seed.",
        ["regress --seeds 1 --samples 5000 --accesses 2000 --json regress.json --html regress.html"],
        "regress-scenarios",
    ),
    Report(
        "reproduce",
        "The papers",
        "The SoC paper's learning curves and their table, each row with the range that it may have.",
        ["reproduce --table figure-7 --table 1 --curves --json reproduce.json --html reproduce.html"],
        "soc-8",
    ),
    Report(
        "bench",
        "Speed",
        "A kernel on the translator, on blocks and on QEMU; the numbers are this host's.",
        ["bench cpu {firmware}/bench_crc.elf --repeat 3 --json bench.json --html bench.html"],
        "bench-mips",
        ends=(0, 1),  # without QEMU it is 1, and the report says so
    ),
    Report(
        "side_by_side",
        "Two runs side by side",
        "The main job in precise arithmetic and in the paper's.",
        [
            "run --curves --json precise.json",
            "run --arithmetic paper --curves --json paper.json",
            "report precise.json paper.json --html side_by_side.html",
        ],
        "angle-error",
        ("precise.json", "paper.json"),
    ),
)

STYLE = """
:root { color-scheme: light dark; --text: #1c2128; --soft: #57606a; --back: #fff; --panel: #f6f8fa; --link: #0550ae;
  --good: #116329; --bad: #a40e26; --odd: #7d4e00; --line-1: #0550ae; --line-2: #bc4c00; }
@media (prefers-color-scheme: dark) { :root { --text: #e2e8ee; --soft: #a3adb8; --back: #12161b; --panel: #1c2128;
  --link: #8ab4f8; --good: #6bd68a; --bad: #ff8f8f; --odd: #f0c060; --line-1: #6cb0ff; --line-2: #ff9c57; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 84rem; background: var(--back); color: var(--text);
  font: 15px/1.5 system-ui, sans-serif; overflow-wrap: anywhere; }
a { color: var(--link); } h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin: 0; }
main { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); gap: 1.2rem; }
article { background: var(--panel); border-radius: 6px; padding: 1rem; min-width: 0; }
img { width: 100%; height: auto; background: #fff; border-radius: 4px; }
pre { font: 13px/1.45 ui-monospace, monospace; white-space: pre-wrap; color: var(--soft); }
.good { color: var(--good); } .bad { color: var(--bad); font-weight: 600; } .odd { color: var(--odd); }
.key { display: flex; flex-wrap: wrap; gap: 0.3rem 1.2rem; margin: 0.6rem 0; }
.key dt { color: var(--soft); font-size: 0.85rem; }
.key dd { margin: 0; font-size: 1.1rem; font-variant-numeric: tabular-nums; }
.key .a, .key .b { border-left: 3px solid var(--line-1); padding-left: 0.4rem; }
.key .b { border-color: var(--line-2); }
"""


class Failed(Exception):
    """A command ended otherwise than it should."""


class Gallery:
    """Makes reports in a folder."""

    def __init__(self, folder, capsoc):
        self.folder = folder
        self.capsoc = capsoc
        self.clean = {name: value for name, value in os.environ.items() if not name.startswith("CAPSOC_")}

    def call(self, *arguments, ends=(0,)):
        done = subprocess.run(
            [self.capsoc, *arguments], cwd=self.folder, env=self.clean, capture_output=True, text=True, check=False
        )
        if done.returncode not in ends:
            last = (done.stderr or done.stdout).strip().splitlines()[-1:]
            raise Failed(f"capsoc {shlex.join(arguments)}: ended with {done.returncode}: {' '.join(last)}")

    def make(self, report):
        """The commands as a user types them in the source tree."""
        (self.folder / f"{report.name}.sqlite").unlink(missing_ok=True)  # another program's is not continued
        shown = []
        for command in report.commands:
            command = command.format(firmware=shlex.quote(str(self.capsoc.parent / "firmware")))
            self.call(*shlex.split(command), ends=report.ends)
            shown.append("capsoc " + command.replace(f"{ROOT}/", ""))
        results = report.results or (f"{report.name}.json",)
        self.call("report", *results, "--figure", report.figure, "--plot", f"{report.name}.svg")
        return shown

    def article(self, report, commands):
        """The report's entry: its first screen is taken from its page."""
        page = (self.folder / f"{report.name}.html").read_text(encoding="utf-8")
        answer = re.search(r'<p class="answer">.*?</p>', page, re.DOTALL)
        key = re.search(r'<dl class="key">.*?</dl>', page, re.DOTALL)
        if answer is None:
            raise Failed(f"{report.name}.html: does not begin with an answer")
        return f"""<article id="{report.name}">
<h2><a href="{report.name}.html">{html.escape(report.title)}</a></h2>
<p>{html.escape(report.what)}</p>
{answer[0]}
{key[0] if key else ""}
<a href="{report.name}.html"><img src="{report.name}.svg" alt="A plot of the report: {html.escape(report.title)}"></a>
<pre>{html.escape(chr(10).join(commands))}</pre>
</article>
"""


def index(articles):
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>capsoc: reports</title>
<style>{STYLE}</style>
</head>
<body>
<h1>capsoc: reports</h1>
<p>Each entry has the answer of a report, a plot of it, and the commands that made it in the source tree.</p>
<main>
{"".join(articles)}</main>
</body>
</html>
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="where the pages go; made if it is not there")
    parser.add_argument("--capsoc", type=Path, default=ROOT / "build" / "capsoc", help="the program of a build tree")
    parser.add_argument(
        "--only", action="append", choices=[report.name for report in REPORTS], help="only this report; may be repeated"
    )
    arguments = parser.parse_args()
    if not os.access(arguments.capsoc, os.X_OK):
        parser.error(f"--capsoc {arguments.capsoc}: is no program; build it, or name another")
    try:
        arguments.folder.mkdir(parents=True, exist_ok=True)
        gallery, articles = Gallery(arguments.folder, arguments.capsoc.resolve()), []
        for report in REPORTS:
            if arguments.only and report.name not in arguments.only:
                continue
            articles.append(gallery.article(report, gallery.make(report)))
            print(f"{report.name}.html: {report.title}", flush=True)
        (arguments.folder / "index.html").write_text(index(articles), encoding="utf-8")
    except (Failed, OSError) as error:
        sys.exit(f"gallery: {error}")
    print(f"{arguments.folder / 'index.html'}: {len(articles)} reports")


if __name__ == "__main__":
    main()
