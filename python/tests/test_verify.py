"""The checker reads what is executed, and emitted modules."""

import pytest

import armgen
from conftest import ROOT


def test_executed_functions_are_verified(scara):
    found = scara.verify()
    assert set(found) == set(scara.functions)
    assert all(one["points"] >= 4 and one["log2_odds"] <= -168 for one in found.values())


def test_a_module_is_verified():
    scara = armgen.load(ROOT / "robots/scara.yaml")
    for language in ("rust", "python"):
        (text,) = scara.generate(language, functions=["gravity", "inertia_matrix"]).values()
        assert set(scara.verify(text, language)) == {"gravity", "inertia_matrix"}
        wrong = text.replace("* c2 + ", "* c2 - ", 1)
        assert wrong != text
        with pytest.raises(armgen.VerificationError, match="inertia_matrix"):
            scara.verify(wrong, language)
    with pytest.raises(armgen.VerificationError):
        armgen.load(ROOT / "robots/ur5.yaml").verify(text, "python")
    with pytest.raises(ValueError, match="language"):
        scara.verify(text, "fortran")
    with pytest.raises(armgen.VerificationError, match='was read as Rust: .*"python"'):
        scara.verify(text)
