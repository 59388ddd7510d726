"""The stubs and annotations name every public thing with its signature."""

import inspect
import subprocess
import sys

import amontons


def test_stubs_agree_with_the_module():
    command = [sys.executable, "-m", "mypy.stubtest", "amontons", "--concise"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_public_names_are_annotated_and_described():
    for name in amontons.__all__:
        value = getattr(amontons, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(value), name
        members = [value] if inspect.isfunction(value) else [
            member for key, member in vars(value).items() if inspect.isfunction(member) and not key.startswith("_")
        ]
        for member in members:
            signature = inspect.signature(member)
            assert signature.return_annotation is not inspect.Signature.empty, member
            arguments = [p for key, p in signature.parameters.items() if key != "self"]
            assert all(p.annotation is not inspect.Parameter.empty for p in arguments), member


def test_the_version_is_that_of_the_distribution():
    from importlib.metadata import version

    assert amontons.__version__ == version("amontons")
