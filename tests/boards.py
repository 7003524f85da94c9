"""What is known of the random boards of Yu, Huang and Chang (2020)."""

from __future__ import annotations

OPTIMA = (
    135, 126, 142, 158, 141, 145, 137, 123, 122, 136, 139, 138, 125, 135, 135, 138, 131, 152, 132,
    128,
)  # fmt: skip
"""Least makespans of the authors' boards, seeds 0 to 19, by an independent exact solver."""
