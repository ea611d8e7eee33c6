"""Lessons: Markdown files with front matter, one step each, or several steps in one file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

import yaml

from cutcell.errors import FileError

FOLDER = Path(__file__).parent / "built_in"
"""The lesson that comes with the page."""

KINDS = ("choice", "number", "vertex", "joint", "paint", "act")
"""Ways to answer: an option, a number, a click on the body or on a bone, a painted selection, or
something that is done in the flat scene or by one of the step's buttons."""

PLOTS = ("falloff", "error")  # beside a text: see `plots.py`

SIDE = 4 * 2**20  # bytes of the largest file that is read


@dataclass(frozen=True)
class Answer:
    """The answer that a step asks for.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    prompt : str
        Sentence that says how to answer.
    options : list of str
        Of a choice. Where a page cannot be clicked or painted, these take the place of that.
    expected : str, float or list of str, optional
        The option, the number, the joints that are right, or the least score of what is painted;
        without it nothing is right or wrong.
    tolerance : float
        Largest difference of a number that is right.
    unit : str
    button : str
        Label of the button that ends painting.
    joint : str
        Of what is painted: the vertices that this joint and those below it move are right.
    """

    kind: str
    prompt: str = ""
    options: list[str] = field(default_factory=list)
    expected: Any = None
    tolerance: float = 0.0
    unit: str = ""
    button: str = "Done"
    joint: str = ""


@dataclass(frozen=True)
class Step:
    """A step of a lesson.

    Parameters
    ----------
    title, question : str
    address : str
        Query of the page's address that sets the scene of the question.
    answer : Answer
    reveal : str
        Entries of the address that differ once a person has answered.
    offers : dict
        Buttons by their labels, with the entries of the address that each sets.
    text : str
        Paragraphs that are read after the answer, separated by empty lines. A choice of the page
        in braces, as in `{alpha}`, is replaced by its value.
    sentence : str
        What remains of the step.
    picture : str
        Description of the picture for those who do not see it.
    notes : str
        For the speaker.
    plot : str
        Plot beside the text, one of `PLOTS`.
    captions : dict
        Captions of methods side by side, by the methods' names.
    """

    title: str
    question: str
    address: str
    answer: Answer
    reveal: str = ""
    offers: dict[str, str] = field(default_factory=dict)
    text: str = ""
    sentence: str = ""
    picture: str = ""
    notes: str = ""
    plot: str = ""
    captions: dict[str, str] = field(default_factory=dict)

    def scene(self, is_revealed: bool) -> str:
        """Return the address of the question's scene, or of the answer's."""
        return f"{self.address}&{self.reveal}" if is_revealed and self.reveal else self.address

    @property
    def demo(self) -> str:
        """Demo character of the step; empty where it applies to the character that is open."""
        return dict(parse_qsl(self.address)).get("rig", "")

    @property
    def characters(self) -> list[str]:
        """Names of characters that the step opens, as in `Session.character`."""
        queries = " ".join([self.address, *self.offers.values()])
        return [f"demo {name}" for name in re.findall(r"\brig=([\w-]+)", queries)]

    def shows(self, panel: str) -> bool:
        """Return whether a panel is the lesson's own or of the step's addresses."""
        queries = " ".join([self.address, self.reveal, *self.offers.values()])
        panels = re.findall(r"\bpanel=(\w+)", queries)
        return panel in ("learn", *panels) or "panel=" not in self.address

    @property
    def named(self) -> list[str]:
        """Choices of the page that the text names."""
        return re.findall(r"\{(\w+)\}", self.text)

    def read_answer(self, text: str) -> Any:
        """Return the answer that an address says; raise a ValueError for none."""
        return float(text) if text and self.answer.kind in ("number", "paint") else text

    def to_json(self) -> dict[str, Any]:
        """Return the step as the card needs it."""
        names = ("title", "question", "text", "sentence", "picture", "notes", "plot")
        answer = {name: value for name, value in vars(self.answer).items() if value not in ("", [])}
        return {
            **{name: getattr(self, name) for name in names},
            "answer": {name: value for name, value in answer.items() if value is not None},
            "offers": list(self.offers),
        }


@dataclass(frozen=True)
class Lesson:
    """Steps in their order."""

    steps: tuple[Step, ...]

    def __getitem__(self, index: int) -> Step:
        return self.steps[index]

    def __len__(self) -> int:
        return len(self.steps)


Problems = Callable[[str], list[str]]
"""Takes a part of an address; returns its entries that the page does not have."""


def read(path: Path | str, problems: Problems = lambda query: []) -> Lesson:
    """Read a lesson: a file, or the Markdown files of a folder in the order of their names.

    Raises
    ------
    FileError
        There is no step, or a step is wrong: the message names the file, the line and the key.
    """
    path = Path(path)
    files = sorted(path.glob("*.md")) if path.is_dir() else [path]
    steps = tuple(step for file in files for step in _steps(file, problems))
    if not steps:
        raise FileError(f"{path.name} has no step of a lesson: Markdown with front matter")
    return Lesson(steps)


@cache
def built_in() -> Lesson:
    """Return the lesson that comes with the page."""
    return read(FOLDER)


def _steps(file: Path, problems: Problems) -> Iterator[Step]:
    try:
        if file.stat().st_size > SIDE:
            raise FileError(f"{file.name} is too large for a lesson")
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{file.name} cannot be read as text ({error})") from None
    rules = [number for number, line in enumerate(lines) if line.rstrip() == "---"]
    if not rules or len(rules) % 2 or any(line.strip() for line in lines[: rules[0]]):
        raise FileError(f"{file.name}: each step begins with front matter between two lines ---")
    for begin, end in zip(rules[::2], rules[1::2], strict=True):
        after = [number for number in rules if number > end]
        text = "\n".join(lines[end + 1 : after[0] if after else None]).strip()
        front = _Front(file.name, begin + 2, "\n".join(lines[begin + 1 : end]))
        step = front.step(text)
        front.check_addresses(step, problems)
        yield step


class _Front:
    """Front matter of a step, with the line of each key for messages."""

    def __init__(self, name: str, first: int, text: str) -> None:
        self._name, self._first = name, first
        self._lines: dict[str, int] = {}
        try:
            node = yaml.compose(text, yaml.SafeLoader)
            self._values = yaml.safe_load(text)
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            line = first + (mark.line if mark else 0)
            problem = getattr(error, "problem", None) or "it cannot be read"
            raise FileError(f"{name}, line {line}: no valid YAML ({problem})") from None
        if not isinstance(self._values, dict):
            raise FileError(f"{name}, line {first}: front matter must be lines of KEY: VALUE")
        self._note(node, "")

    def _note(self, node: Any, prefix: str) -> None:
        for key, value in node.value:
            self._lines[f"{prefix}{key.value}"] = self._first + key.start_mark.line
            if isinstance(value, yaml.MappingNode):
                self._note(value, f"{prefix}{key.value}.")

    def _fail(self, key: str, problem: str) -> FileError:
        line = self._lines.get(key, self._lines.get(key.rpartition(".")[0], self._first))
        return FileError(f"{self._name}, line {line}, {key}: {problem}")

    def step(self, text: str) -> Step:
        """Return the step with its text."""
        paragraphs = (" ".join(one.split()) for one in re.split(r"\n\s*\n", text))
        values = {**self._checked(self._values, Step, ""), "text": "\n\n".join(paragraphs)}
        raw = self._values["answer"]
        if not isinstance(raw, dict):
            raise self._fail("answer", "must be lines of KEY: VALUE, the first of them kind")
        if values.get("plot", PLOTS[0]) not in PLOTS:
            raise self._fail("plot", f"must be one of {', '.join(PLOTS)}")
        values["answer"] = self._answer(Answer(**self._checked(raw, Answer, "answer.")))
        for key, label in ((k, one) for k in ("offers", "captions") for one in values.get(k, {})):
            if not isinstance(label, str) or not isinstance(values[key][label], str):
                raise self._fail(f"{key}.{label}", f"must be two texts. {QUOTES}")
        return Step(**values)

    def check_addresses(self, step: Step, problems: Problems) -> None:
        """Raise an error for an entry of an address that the page does not have."""
        offers = {f"offers.{label}": query for label, query in step.offers.items()}
        for key, query in {"address": step.address, "reveal": step.reveal, **offers}.items():
            if entries := problems(query):
                raise self._fail(key, f"the page does not have {', '.join(entries)}")

    def _checked(self, values: dict[str, Any], kind: Any, prefix: str) -> dict[str, Any]:
        """Return values for the fields of a class; raise an error for wrong ones."""
        allowed = {f.name: str(f.type) for f in fields(kind) if f.name != "text"}
        for name, value in values.items():
            if name not in allowed:
                names = ", ".join(allowed)
                raise self._fail(f"{prefix}{name}", f"there is no such key; there are {names}")
            if not _fits(value, allowed[name]):
                raise self._fail(f"{prefix}{name}", f"must be {_KINDS[allowed[name]]}")
        for name in allowed:
            required = name in ("title", "question", "address", "answer", "kind")
            if required and not values.get(name):
                raise self._fail(f"{prefix}{name}", "is missing")
        folded = ("question", "sentence", "picture", "prompt")
        return {n: " ".join(v.split()) if n in folded else v for n, v in values.items()}

    def _answer(self, answer: Answer) -> Answer:
        """Return an answer whose parts fit its kind."""
        kind, expected = answer.kind, answer.expected
        if kind not in KINDS:
            raise self._fail("answer.kind", f"must be one of {', '.join(KINDS)}")
        if kind == "choice" and len(answer.options) < 2:
            raise self._fail("answer.options", "a choice needs two options or more")
        if kind == "choice" and expected not in (None, *answer.options):
            raise self._fail("answer.expected", f"must be one of the options. {QUOTES}")
        if kind in ("number", "paint") and not _fits(expected, "float"):
            raise self._fail("answer.expected", "must be a number")
        return answer


QUOTES = "Put Yes, No and numbers in quotes"
_KINDS = {
    "str": f"a text. {QUOTES}", "float": "a number", "list[str]": f"a list of texts. {QUOTES}",
    "dict[str, str]": "lines of LABEL: TEXT", "Answer": "lines of KEY: VALUE",
}  # fmt: skip


def _fits(value: Any, kind: str) -> bool:
    if kind == "float":
        return isinstance(value, int | float) and not isinstance(value, bool)
    if kind == "list[str]":
        return isinstance(value, list) and all(isinstance(one, str) for one in value)
    types = {"str": str, "dict[str, str]": dict, "Answer": dict}
    return isinstance(value, types.get(kind, object))
