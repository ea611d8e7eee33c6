"""What `load_kernels` has loaded, no binding has to compile."""

import subprocess
import sys
import textwrap

from tests.conftest import ROOT

SCRIPT = textwrap.dedent(
    """
    import sys
    from numba.core.dispatcher import Dispatcher
    import cutcell
    from assets import demo_path
    from cutcell.skinning import load_kernels

    def versions():
        return {
            f"{module.__name__}.{name}": len(kernel.signatures)
            for module in list(sys.modules.values())
            if module and module.__name__.startswith("cutcell")
            for name, kernel in vars(module).items()
            if isinstance(kernel, Dispatcher)
        }

    load_kernels()
    loaded = versions()
    assert loaded
    for demo in ("robot", "biped_cape"):
        rig = cutcell.load(demo_path(demo))
        for options in ({}, {"connectivity": 6, "falloff": "paper"}, {"connectivity": 26}):
            cutcell.bind(rig, 24, **options)
    now = versions()
    print({name for name in now if now[name] != loaded.get(name, 0)})
    """
)


def test_nothing_is_compiled_after_the_first_time():
    command = [sys.executable, "-c", SCRIPT]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=240)
    assert done.stdout.strip() == "set()", done.stdout + done.stderr
