"""Compiled kernels are found again; where they cannot be kept or read, they are compiled."""

import errno
import os
import pickle
import shutil
import subprocess
import sys
import textwrap
import zlib
from pathlib import Path
from types import SimpleNamespace

import pytest

from cutcell.runtime import compile_cache, sources
from cutcell.runtime.compiled import compiled


def one_more(number):
    return number + 1


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(compile_cache, "folders", lambda: (tmp_path,))
    monkeypatch.setattr(compile_cache, "refusals", [])
    return tmp_path


def outcome(number=1):
    """Call the kernel as a new process would: say what it returns, and if it was compiled."""
    kernel = compiled(one_more)
    result = kernel(number)
    return result, "loaded" if kernel.stats.cache_hits else "compiled"


def test_a_kernel_is_compiled_once_for_each_type(folder):
    assert outcome() == (2, "compiled")
    assert outcome() == (2, "loaded")
    assert outcome(1.5) == (2.5, "compiled")
    assert outcome(1.5) == (2.5, "loaded")
    assert outcome() == (2, "loaded")
    assert len(list(folder.iterdir())) == 2
    assert not compile_cache.refusals


def test_a_first_compile_is_logged_once(folder, monkeypatch, caplog):
    caplog.set_level("INFO", "cutcell.compile")
    for number in (1, 1.5):
        compile_cache.announce.cache_clear()
        outcome(number)
        outcome(number)
    assert [record.name for record in caplog.records] == ["cutcell.compile"] * 2
    compile_cache.mark_complete()
    compile_cache.announce.cache_clear()
    outcome(1j)
    assert len(caplog.records) == 2, "the others are there: this one takes a moment"


def test_a_notebook_is_told_of_a_first_compile(folder, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=object))
    compile_cache.announce.cache_clear()
    outcome()
    assert capsys.readouterr().err.strip() == compile_cache.ANNOUNCEMENT


DAMAGES = {
    "empty": lambda content: b"",
    "cut short": lambda content: content[:1000],
    "zeros at its end": lambda content: content[:1000] + bytes(len(content) - 1000),
    "one bit": lambda content: content[:2000] + bytes([content[2000] ^ 1]) + content[2001:],
    "not a pickle": lambda content: zlib.compress(b"something else"),
    "another pickle": lambda content: zlib.compress(pickle.dumps((1, 2))),
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_file_is_compiled_again(damage, folder):
    outcome()
    (file,) = folder.iterdir()
    content = file.read_bytes()
    file.write_bytes(damage(content))
    assert file.read_bytes() != content
    assert outcome() == (2, "compiled")
    assert outcome() == (2, "loaded")


def test_a_folder_in_place_of_a_file_is_no_harm(folder):
    outcome()
    (file,) = folder.iterdir()
    file.unlink()
    file.mkdir()
    assert outcome() == (2, "compiled")
    assert "directory" in compile_cache.refusals[0]


def test_on_a_full_disk_kernels_stay_in_memory(folder, monkeypatch):
    def write_some(path, content):
        with open(path, "wb") as file:
            file.write(content[:10])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", write_some)
    assert outcome() == (2, "compiled")
    assert not any(file.stat().st_size for file in folder.iterdir())
    assert "No space left" in compile_cache.refusals[0]
    compile_cache.mark_complete()
    assert not compile_cache.is_complete()


def test_the_next_folder_is_taken_where_one_takes_nothing(folder, monkeypatch):
    file, good = folder / "file", folder / "good"
    file.write_text("not a folder")
    monkeypatch.setattr(compile_cache, "folders", lambda: (file, good))
    assert outcome() == (2, "compiled")
    assert outcome() == (2, "loaded")
    compile_cache.mark_complete()
    assert compile_cache.is_complete()
    monkeypatch.setattr(compile_cache, "folders", lambda: (file,))
    assert outcome() == (2, "compiled")
    assert not compile_cache.is_complete()


def test_what_another_compiler_or_another_source_made_is_not_taken(folder, monkeypatch):
    outcome()
    monkeypatch.setattr(compile_cache, "source_digest", lambda path: "another source")
    assert outcome() == (2, "compiled")
    monkeypatch.setattr(compile_cache, "source_digest", lambda path: Path("nowhere").read_text())
    assert outcome() == (2, "compiled")  # in an archive
    assert len(list(folder.iterdir())) == 2


def test_a_kernel_is_compiled_again_when_a_source_of_its_package_changes(tmp_path):
    package = tmp_path / "laboratory"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "constants.py").write_text("FACTOR = 2\n")
    (package / "kernels.py").write_text(
        textwrap.dedent(
            """
            from cutcell.runtime.compiled import compiled
            from .constants import FACTOR

            @compiled
            def scaled(number):
                return FACTOR * number
            """
        )
    )
    script = "from laboratory.kernels import scaled as f; print(f(1), len(f.stats.cache_hits))"

    def run():
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        return subprocess.check_output(
            [sys.executable, "-c", script], cwd=tmp_path, env=environment, text=True
        ).split()

    assert [run(), run()] == [["2", "0"], ["2", "1"]]
    (package / "constants.py").write_text("FACTOR = 3\n")
    assert [run(), run()] == [["3", "0"], ["3", "1"]]


@pytest.mark.parametrize("patience", [60, 0.1])
def test_a_process_waits_for_another_one_that_compiles(patience, folder, monkeypatch):
    monkeypatch.setattr(compile_cache, "PATIENCE", patience)
    source = f"""
        import time
        from pathlib import Path
        from cutcell.runtime import compile_cache
        compile_cache.folders = lambda: (Path({str(folder)!r}),)
        with compile_cache.only_process():
            print("locked", flush=True)
            time.sleep(2)
            compile_cache.mark_complete()
    """
    command = [sys.executable, "-c", textwrap.dedent(source)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "locked\n"
        with compile_cache.only_process():
            assert compile_cache.is_complete() is (patience > 2)


def test_without_a_folder_to_lock_no_process_waits(folder, monkeypatch):
    (folder / "file").write_text("not a folder")
    monkeypatch.setattr(compile_cache, "folders", lambda: (folder / "file",))
    with compile_cache.only_process(), compile_cache.only_process():
        assert not compile_cache.is_complete()


@pytest.mark.parametrize(
    "what",
    ["numba.__version__", "sys.implementation.cache_tag", "sys.platform", "config.CPU_NAME",
     "config.CPU_FEATURES"],
)  # fmt: skip
def test_each_compiler_has_a_set_of_its_own(what, monkeypatch):
    name = compile_cache._set_name.__wrapped__()
    assert name == compile_cache._set_name.__wrapped__()
    monkeypatch.setattr(f"cutcell.runtime.compile_cache.{what}", "another")
    assert name != compile_cache._set_name.__wrapped__()


@pytest.mark.parametrize(
    "part", ["animation/declaration.py", "runtime/compiled.py", "graph/rays.py"]
)
def test_a_change_of_any_source_makes_all_kernels_stale(part, tmp_path, monkeypatch):
    copied = tmp_path / "cutcell"
    shutil.copytree(sources.PACKAGE, copied, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(compile_cache, "PACKAGE", copied)
    monkeypatch.setattr(compile_cache, "source_digest", sources.source_digest.__wrapped__)

    before = compile_cache._set_name.__wrapped__()
    assert before == compile_cache._set_name.__wrapped__()
    text = (copied / part).read_text()
    (copied / part).write_text(text.replace("REACH = 6.0", "REACH = 2.0") + "# changed\n")
    assert compile_cache._set_name.__wrapped__() != before


def test_no_kernel_uses_the_cache_of_numba():
    files = compile_cache.PACKAGE.rglob("*.py")
    using = [file.name for file in files if "njit" in file.read_text(encoding="utf-8")]
    assert using == ["compiled.py"]


def test_old_sets_are_removed_but_for_a_few(tmp_path, monkeypatch):
    for age in range(6):
        old = tmp_path / f"kernels-{age}"
        old.mkdir()
        os.utime(old, (1e9 - age, 1e9 - age))
    (tmp_path / "other").mkdir()
    monkeypatch.setattr(compile_cache, "folders", lambda: (tmp_path / "kernels-new",))
    monkeypatch.setattr(compile_cache, "refusals", [])
    compile_cache.mark_complete()
    left = {"kernels-new", "kernels-0", "kernels-1", "kernels-2", "other"}
    assert {path.name for path in tmp_path.iterdir()} == left


def raise_without_home(*names, **options):
    raise RuntimeError("Could not determine home directory.")


@pytest.mark.parametrize("cache_dir", [raise_without_home, lambda *_, **__: "~/.cache/cutcell"])
def test_without_a_home_there_is_no_folder_for_the_user(cache_dir, monkeypatch):
    monkeypatch.setattr("platformdirs.user_cache_dir", cache_dir)
    (folder,) = compile_cache.folders.__wrapped__()
    assert folder.parent == compile_cache.PACKAGE / "__pycache__"
    monkeypatch.setitem(vars(compile_cache.config), "CACHE_DIR", "chosen")
    chosen, _ = compile_cache.folders.__wrapped__()
    assert chosen.parent == Path("chosen").absolute()


@pytest.mark.slow
def test_without_the_compiler_weights_are_the_same():
    code = """
    import cutcell
    from tests.bars import bar
    weights = [cutcell.bind(bar(6), 8, connectivity=c).weights for c in (6, 26, "any")]
    print([[f"{w + 0:.9f}" for w in each.ravel()] for each in weights])
    """
    outputs = [
        subprocess.run(
            [sys.executable, "-W", "error", "-c", textwrap.dedent(code)],
            env={**os.environ, **options}, capture_output=True, text=True, check=True,
        ).stdout
        for options in ({}, {"NUMBA_DISABLE_JIT": "1"})
    ]  # fmt: skip
    assert outputs[0] == outputs[1] != ""
