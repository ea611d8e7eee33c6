"""A short run of the fuzzer of `bind`; `python -m tests.fuzz.bind --count 2000` is the long one."""

import pytest

from tests.fuzz.bind import SEEDS
from tests.fuzz.harness import try_cases

pytestmark = pytest.mark.slow

COUNT = 8


def test_a_few_cases_pass():
    numbers = {*SEEDS, *range(COUNT)}
    report = try_cases("tests.fuzz.bind", numbers, processes=1)
    assert not report.failures, "\n".join(f"{f.number}: {f.why}" for f in report.failures)
    assert report.passed == len(numbers)
