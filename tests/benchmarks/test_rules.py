"""Each rule can be switched off, and the table counts what that changes."""

from cutcell_lab.benchmarks import rules
from tests.benchmarks.markdown import read_tables


def test_rules_name_what_the_code_has():
    for offs in rules.RULES.values():
        for off in offs:
            assert all(hasattr(off.module, name) for name in off.values)


def test_characters_and_makers_are_counted():
    changed = [("khronos_Fox", 0.5), ("khronos_CesiumMan", 0.9), ("boxman", 1.2), ("bubba", 1.01)]
    (rows,) = read_tables(rules.table({"radius": changed}).markdown()).values()
    assert list(rows[0].values()) == ["radius", "4", "2 : 1", "2", "0.859"]
