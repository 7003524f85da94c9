"""What is to be assembled and who is there to do it: the one model behind files, Python and the
studio.

A `Cell` is frozen and sound once it exists: whoever holds one need not check it again. What a
single value must look like is said by the types in `parts.py`; what values must be to each other is
said in `soundness.py`, one rule a function.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from decimal import Decimal
from functools import cached_property
from typing import Any, Self

from pydantic import ValidationError, model_validator

from tandem.cell import soundness
from tandem.cell.exposures import exposures
from tandem.cell.parts import Fields
from tandem.cell.variants import at_variant, left_out_in_vain, merged
from tandem.errors import CellError, Fault


class Cell(Fields):
    """One workstation: its operators and the tasks of one product.

    Raises:
      CellError: with every fault, when the parts are well formed but do not fit together.
      pydantic.ValidationError: when a part is not well formed; `tandem.load` turns it into a
        `CellError` too.
    """

    @model_validator(mode="after")
    def _is_sound(self) -> Self:
        if faults := list(soundness.faults(self)):
            raise CellError(faults)
        if self.variants and (faults := list(self._faults_of_variants())):
            raise CellError(faults)
        return self

    def _faults_of_variants(self) -> Iterator[Fault]:
        for name in self.variants:
            yield from left_out_in_vain(self.to_dict(), name)
            try:
                self.variant(name)
            except CellError as error:
                yield from (at_variant(name, fault) for fault in error.faults)
            except ValidationError as error:
                for item in error.errors(include_url=False):
                    yield at_variant(name, Fault(f"{item['msg']}.", item["loc"]))

    @cached_property
    def exposures(self) -> Mapping[str, Mapping[tuple[str, str], Decimal]]:
        """Scale -> {(task, human): the value of one execution}: `exposures.exposures`, once."""
        return exposures(self)

    @cached_property
    def digest(self) -> str:
        """Sixteen hexadecimal digits that change when anything in the cell does."""
        return hashlib.sha256(json.dumps(self.to_dict(), sort_keys=True).encode()).hexdigest()[:16]

    def to_dict(self) -> dict[str, Any]:
        """The cell as a cell file holds it: plain values, keys that say nothing left out."""
        data = self.model_dump(mode="json", exclude_defaults=True)
        return {"format": self.format, **plain(data)}

    def variant(self, name: str) -> Cell:
        """The cell of a variant: this one with its changes. Raises KeyError when there is none of
        this name.
        """
        document = merged(self.to_dict(), self.variants[name].tasks)
        document["name"] = f"{self.name}, {name}" if self.name else name
        return type(self).model_validate(document)

    def replace(self, **changes: Any) -> Cell:
        """A checked variant: the same cell with some top-level keys changed."""
        return type(self).model_validate(
            {**{field: getattr(self, field) for field in type(self).model_fields}, **changes}
        )


def plain(value: Any) -> Any:
    """Whole floats as ints and tuples as lists, as a person would write them."""
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value
