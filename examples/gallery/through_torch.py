"""Floats as PyTorch's tensors, in double precision."""

from __future__ import annotations

TENSOR = f"{__name__}:tensor"


def tensor(numbers):
    """A tensor of double precision."""
    import torch

    return torch.tensor(numbers, dtype=torch.float64)
