"""Every public name is there, and its docstring tells what a person needs (numpydoc)."""

import ast
import inspect
import re
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

import cutcell
import cutcell_lab
from tests.conftest import ROOT

PACKAGES = [
    *(f"cutcell.{name}" for name in ("io", "graph", "geodesics", "weights", "editing")),
    *(f"cutcell.{name}" for name in ("binding", "pose", "priors")),
    "cutcell_lab.metrics",
    "cutcell_lab.baselines",
]
ROOT_FUNCTIONS = sorted(
    name
    for name in cutcell.__all__
    if name != "__version__" and inspect.isfunction(getattr(cutcell, name))
)
CLASSES = sorted(
    name
    for name in cutcell.__all__
    if name != "__version__" and inspect.isclass(getattr(cutcell, name))
)
FUNCTIONS = sorted(
    {
        (package, name)
        for package in PACKAGES
        for name in import_module(package).__all__
        if inspect.isfunction(getattr(import_module(package), name))
    }
)


def sections(thing) -> dict[str, str]:
    """Split a docstring at its underlined headings; the part before them is called ""."""
    parts = re.split(r"^(\w[\w ]*)\n-+\n", inspect.getdoc(thing) or "", flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def described(section: str) -> set[str]:
    """Names that the unindented lines of a Parameters section describe."""
    heads = [line.partition(":")[0] for line in section.splitlines() if re.match(r"\S", line)]
    return {name.strip().lstrip("*") for head in heads for name in head.split(",")}


def test_every_name_is_there_and_documented():
    names = [name for name in cutcell.__all__ if name != "__version__"]
    assert [name for name in names if not inspect.getdoc(getattr(cutcell, name))] == []
    assert cutcell.__version__


def faults(by_name: dict) -> dict:
    """Return those names of which something is missing, with what is."""
    return {name: missing for name, missing in by_name.items() if missing}


def test_dir_lists_the_public_names_and_others_are_unknown():
    assert dir(cutcell) == cutcell.__all__
    assert cutcell_lab.metrics.weight_l1([[1.0]], [[1.0]]) == 0
    with pytest.raises(AttributeError, match="blind"):
        cutcell.blind  # noqa: B018


def test_functions_say_what_they_take_give_and_raise():
    missing = {}
    for name in ROOT_FUNCTIONS:
        function = getattr(cutcell, name)
        required = {"Parameters", "Raises"}
        if inspect.signature(function).return_annotation not in (None, "None"):
            required.add("Returns")
        missing[name] = required - sections(function).keys()
    assert faults(missing) == {}


def test_every_parameter_is_spoken_of():
    """One by one in a section, or, where one sentence says all, in that sentence."""
    undescribed = {}
    for package, name in FUNCTIONS:
        function = getattr(import_module(package), name)
        parameters = set(inspect.signature(function).parameters)
        text = sections(function)
        if "Parameters" in text:
            undescribed[package, name] = parameters ^ described(text["Parameters"])
        elif len(parameters) > 3 or not text[""].strip():
            undescribed[package, name] = parameters
    assert faults(undescribed) == {}


def test_every_parameter_and_result_has_a_type():
    untyped = {}
    for package, name in FUNCTIONS:
        signature = inspect.signature(getattr(import_module(package), name))
        types = {p.name: p.annotation for p in signature.parameters.values()}
        types["return"] = signature.return_annotation
        untyped[package, name] = [key for key, kind in types.items() if kind is signature.empty]
    assert faults(untyped) == {}


def test_every_field_of_a_dataclass_is_described():
    missing = {}
    for name in (c for c in CLASSES if not c.endswith(("Error", "Cancelled"))):
        kind = getattr(cutcell, name)
        fields = set(kind.__dataclass_fields__) - {"name"}  # says it all
        text = inspect.getdoc(kind)
        missing[name] = [field for field in fields if not re.search(rf"\b{field}\b", text)]
    assert len(missing) > 5
    assert faults(missing) == {}


def test_the_stub_lists_what_the_modules_say_is_public():
    """What `cutcell` has of a module is in that module's own list."""
    stub = ast.parse(Path(cutcell.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    for node in stub.body:
        if isinstance(node, ast.ImportFrom) and node.module:
            module = import_module(f"cutcell.{node.module}")
            listed = getattr(module, "__all__", vars(module))
            assert {alias.name for alias in node.names} <= set(listed), node.module


def test_the_script_that_is_type_checked_strictly_uses_every_public_name():
    """`make test` and `make lint` check it: see mypy's settings."""
    script = Path(__file__).with_name("typing_example.py")
    used = set(re.findall(r"\bcutcell\.(\w+)", script.read_text(encoding="utf-8")))
    assert set(cutcell.__all__) <= used
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert settings["tool"]["mypy"]["modules"] == ["tests.typing_example"]


def test_errors_have_one_base_that_is_a_value_error():
    errors = [getattr(cutcell, name) for name in CLASSES if name.endswith("Error")]
    assert all(issubclass(error, cutcell.CutcellError) for error in errors)
    assert issubclass(cutcell.CutcellError, ValueError)


def test_cancelling_is_no_error_of_the_input():
    assert not issubclass(cutcell.Cancelled, cutcell.CutcellError)
