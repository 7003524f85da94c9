"""A training under way."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

from tandem.learn.algorithm import Algorithm, Learners, TrainingOrder
from tandem.learn.training.runs import RunFolder
from tandem.plan.result import Front


@dataclass
class Training:
    """A training under way."""

    order: TrainingOrder
    folder: RunFolder
    algorithm: Algorithm
    front: Front | None
    learners: Learners
    interval: int = 0
    cpu_s: float = 0.0
    tensorboard: Any = None
    since: float = field(default_factory=time.process_time)

    @property
    def share(self) -> float:
        """How much of the budget the slowest seed has behind it, 0 to 1."""
        return self.algorithm.share(self.learners)

    def spent(self) -> float:
        """CPU seconds so far, compiling included."""
        return self.cpu_s + time.process_time() - self.since
