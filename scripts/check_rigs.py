"""Check rigs in a GitHub workflow: findings as annotations, a summary, a page with pictures.

    python scripts/check_rigs.py PATTERN... [--fail-on error] [--out findings] [--no-pictures]

`action.yml` runs it. Each file is examined by `cutcell diagnose` in a process of its own. Exit code
1 means that a finding is at least as severe as `--fail-on`, 2 that nothing could be checked.
"""

from __future__ import annotations

import argparse
import glob
import html
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SEVERITIES = ("error", "warning")
"""Those that are annotated and drawn, the most severe first; notes are in the summary alone."""
MAX_PICTURES = 40
SIZE = "720x540"


@dataclass(frozen=True)
class Result:
    """A finding of a file, and its picture, if one was drawn."""

    path: Path
    finding: dict[str, Any]
    picture: Path | None = None


def cutcell(*words: str) -> subprocess.CompletedProcess[str]:
    """Run a command of cutcell."""
    command = [sys.executable, "-m", "cutcell", *words]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8")


def examine(path: Path, resolution: int) -> list[dict[str, Any]]:
    """Return the findings of a file; a process that fails is one, too."""
    done = cutcell("diagnose", str(path), "--json", "--resolution", str(resolution))
    try:
        return json.loads(done.stdout)["findings"]
    except ValueError:
        why = done.stderr.strip() or f"cutcell diagnose ended with code {done.returncode}"
        return [
            {"code": "unreadable", "severity": "error", "title": "Not checked", "message": why,
             "advice": "Run cutcell diagnose on this file.", "details": []}
        ]  # fmt: skip


def draw(path: Path, finding: dict[str, Any], resolution: int, out: Path) -> Path | None:
    """Draw where a finding is; None if it cannot be drawn, which is printed."""
    if finding["code"] == "unreadable":
        return None
    picture = out / f"{'-'.join(path.with_suffix('').parts[-3:])}-{finding['code']}.png"
    view = ["--panel", "check", "--finding", finding["code"], "--size", SIZE, "--quiet"]
    done = cutcell("render", str(path), str(picture), *view, "--resolution", str(resolution))
    if done.returncode:
        print(f"{path}: no picture of {finding['code']}: {done.stderr.strip()}", flush=True)
        return None
    return picture


def annotation(result: Result) -> str:
    """Return the line by which GitHub shows a finding beside its file."""
    finding = result.finding

    def escaped(text: str, also: str = "") -> str:
        for sign in "%\r\n" + also:
            text = text.replace(sign, f"%{ord(sign):02X}")
        return text

    place = f"file={escaped(result.path.as_posix(), ':,')},title={escaped(finding['title'], ':,')}"
    return f"::{finding['severity']} {place}::{escaped(finding['message'])}%0A" + escaped(
        finding["advice"]
    )


def summary(results: Sequence[Result], count: int) -> str:
    """Return the summary of a run in Markdown."""
    said = [
        "| file | severity | finding | advice |\n|---|---|---|---|",
        *(
            "| {} | {} | **{}**: {} | {} |".format(
                *(
                    html.escape(text).replace("|", "&#124;").replace("\n", " ")
                    for text in (
                        one.path.as_posix(),
                        *(one.finding[key] for key in ("severity", "title", "message", "advice")),
                    )
                )
            )
            for one in results
        ),
    ]
    head = f"## Characters: {count} checked, {len(results)} findings\n\n"
    return head + ("\n".join(said) if results else "Nothing found.") + "\n"


def page(results: Sequence[Result]) -> str:
    """Return a page with a picture of each finding that has one."""
    blocks = []
    for one in results:
        title, message, advice, severity = (
            html.escape(one.finding[key]) for key in ("title", "message", "advice", "severity")
        )
        image = f'<p><img src="{html.escape(one.picture.name)}" alt=""></p>' if one.picture else ""
        blocks.append(
            f"<h2>{html.escape(one.path.as_posix())}: {title} ({severity})</h2>"
            f"<p>{message} {advice}</p>{image}"
        )
    style = "body{font:16px/1.5 sans-serif;max-width:48rem;margin:2rem auto;padding:0 1rem}"
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>Findings</title>'
        f"<style>{style} img{{max-width:100%}}</style><h1>Findings</h1>{''.join(blocks)}</html>\n"
    )


def check(paths: Sequence[Path], resolution: int, out: Path | None) -> Iterator[Result]:
    """Yield the findings of all files, with pictures of the severe ones."""
    pictures = 0
    for path in paths:
        for finding in examine(path, resolution):
            picture = None
            if out and finding["severity"] in SEVERITIES and pictures < MAX_PICTURES:
                picture = draw(path, finding, resolution, out)
                pictures += picture is not None
            yield Result(path, finding, picture)


def main(argv: Sequence[str] | None = None) -> int:
    """Read the command line, check, report."""
    parser = argparse.ArgumentParser(prog="python scripts/check_rigs.py", description=__doc__)
    parser.add_argument(
        "patterns", nargs="+", help="files, with * and **; several lines are several patterns"
    )
    parser.add_argument("--fail-on", choices=SEVERITIES, default="error")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--out", type=Path, default=Path("findings"))
    parser.add_argument("--pictures", action=argparse.BooleanOptionalAction, default=True)
    options = parser.parse_args(argv)
    patterns = [line.strip() for one in options.patterns for line in one.splitlines()]
    matches = {match for one in patterns for match in glob.glob(one, recursive=True)}
    paths = [path for path in map(Path, sorted(matches)) if path.is_file()]
    if not paths:
        print(f"::error title=No characters::no file matches {' '.join(patterns)}")
        return 2
    options.out.mkdir(parents=True, exist_ok=True)
    results = []
    for result in check(paths, options.resolution, options.out if options.pictures else None):
        results.append(result)
        if result.finding["severity"] in SEVERITIES:
            print(annotation(result), flush=True)
    (options.out / "index.html").write_text(page(results), encoding="utf-8")
    text = summary(results, len(paths))
    if target := os.environ.get("GITHUB_STEP_SUMMARY"):
        with open(target, "a", encoding="utf-8") as file:
            file.write(text)
    else:
        print(text)
    severe = SEVERITIES[: SEVERITIES.index(options.fail_on) + 1]
    return int(any(one.finding["severity"] in severe for one in results))


if __name__ == "__main__":
    sys.exit(main())
