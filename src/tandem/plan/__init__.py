"""Offline planning: a cell in, a front out.

`tandem.plan` is a room and a verb: `tandem.plan.methods` is a module, and `tandem.plan(cell)`
plans, as `tandem.plan.methods.plan` does.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any


class _Room(ModuleType):
    def __call__(self, *args: Any, **options: Any) -> Any:
        from tandem.plan.methods import plan

        return plan(*args, **options)


sys.modules[__name__].__class__ = _Room
