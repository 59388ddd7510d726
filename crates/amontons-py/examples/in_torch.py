"""A run as a function of PyTorch: numbers at its end by keys of the case, with exact derivatives."""

import torch

import amontons


class Run(torch.autograd.Function):
    """Outputs of a case at values of keys; the run and its derivatives are made together."""

    @staticmethod
    def forward(ctx, values, case, outputs, keys):
        given = dict(zip(keys, values.tolist()))
        numbers, slopes = amontons.Case(case, given).gradient(outputs, keys)
        ctx.save_for_backward(torch.as_tensor(slopes, dtype=values.dtype))
        return torch.as_tensor(numbers, dtype=values.dtype)

    @staticmethod
    def backward(ctx, weights):
        (slopes,) = ctx.saved_tensors
        return weights @ slopes, None, None, None


def outputs_of(case, outputs, keys):
    """The function of a vector of values that gives the vector of the outputs."""
    outputs, keys = list(outputs), list(keys)
    return lambda values: Run.apply(values, case, outputs, keys)
