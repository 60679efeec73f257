"""A part of a scene, as computations take it: values in SI units, compared by their digest."""

from __future__ import annotations

from dataclasses import fields
from functools import cached_property
from hashlib import blake2b

from pydantic_core import to_json


class Part:
    """Base of the frozen dataclasses that are the parts of a scene.

    Parts of equal content are equal keys of caches. Their content is hashed once: maps and meshes
    have many values.
    """

    @cached_property
    def digest(self) -> str:
        """Hash of the values of all fields, hexadecimal."""
        content = [
            (each.name, type(value).__name__, value)
            for each in fields(self)  # pyright: ignore[reportArgumentType]
            for value in [getattr(self, each.name)]
        ]
        text = to_json(content, inf_nan_mode="constants", fallback=lambda array: array.tolist())
        return blake2b(text, digest_size=16).hexdigest()

    def __eq__(self, other: object) -> bool:
        same_kind = isinstance(other, type(self))
        return self is other or (same_kind and self.digest == other.digest)

    def __hash__(self) -> int:
        return hash(self.digest)
