"""Runs as functions of PyTorch and of JAX; without these libraries nothing is tested."""

import importlib.util
import pathlib

import amontons
import numpy as np
import pytest

KEYS = ["contact.gap", "material.elasticity.young"]
OUTPUTS = ["end_x", "pressure"]
EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
ROD = EXAMPLES.parents[1] / "amontons" / "tests" / "reference" / "gradients" / "rod.toml"


def example(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def known():
    """Values of the keys, and the derivatives of 2 u + 3 p by them."""
    values = np.array([0.02, 10.0])
    _, slopes = amontons.Case(ROD, dict(zip(KEYS, values.tolist()))).gradient(OUTPUTS, KEYS)
    return values, np.array([2.0, 3.0]) @ slopes


def test_torch_takes_the_derivatives(known):
    torch = pytest.importorskip("torch")
    values = torch.tensor(known[0], dtype=torch.float64, requires_grad=True)
    run = example("in_torch").outputs_of(ROD, OUTPUTS, KEYS)
    (run(values) * torch.tensor([2.0, 3.0], dtype=torch.float64)).sum().backward()
    assert np.allclose(values.grad.numpy(), known[1], rtol=1e-12)


def test_jax_takes_the_derivatives(known):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    run = example("in_jax").outputs_of(ROD, OUTPUTS, KEYS)
    slopes = jax.grad(lambda values: run(values) @ np.array([2.0, 3.0]))(known[0])
    assert np.allclose(np.asarray(slopes), known[1], rtol=1e-12)
