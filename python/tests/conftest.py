import pathlib

import numpy as np
import pytest

import armgen

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROBOTS = sorted([*ROOT.glob("robots/*.yaml"), *ROOT.glob("tests/robots/*.yaml")])


def pytest_configure(config):
    # Robots of the tests have doubts; the test of warnings asks for its own.
    config.addinivalue_line("filterwarnings", "ignore::armgen.DescriptionWarning")


@pytest.fixture(scope="session")
def panda():
    return armgen.load(ROOT / "robots/panda7.yaml")


@pytest.fixture(scope="session")
def scara():
    return armgen.load(ROOT / "robots/scara4.yaml")


@pytest.fixture
def random():
    return np.random.default_rng(1)
