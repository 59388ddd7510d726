"""What the tests share: the case files, the program, and small cases."""

import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
# The paper's example on a small mesh.
SMALL = {"mesh.n": 8, "time.steps": 8, "output.every": 4}


@pytest.fixture(scope="session")
def paper():
    return ROOT / "cases" / "paper.toml"


@pytest.fixture(scope="session")
def program():
    """The program, built from the same sources."""
    path = pathlib.Path(os.environ.get("AMONTONS", ROOT / "target" / "release" / "amontons"))
    assert path.is_file(), f"{path}: build the program first, or name it with AMONTONS"

    def call(*arguments, code=0):
        done = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == code, done.stderr
        return done

    return call
