"""Packages that are imported when they are first needed."""

from __future__ import annotations

import importlib
from types import ModuleType


def package(name: str, purpose: str, extra: str) -> ModuleType:
    """The package, or an error that says how to install it."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise ModuleNotFoundError(
            f'{purpose} needs the package {name}, which is not installed: pip install "amontons[{extra}]"', name=name
        ) from None


def pandas(purpose: str) -> ModuleType:
    return package("pandas", purpose, "frames")
