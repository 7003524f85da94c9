"""Sweeps: methods of planning and policies of dispatch over cells, seeds and people, one file for
each job, and tables with intervals made of them.
"""

from tandem.bench.spec import Spec, read_spec
from tandem.bench.summary import read_runs, summarised
from tandem.bench.sweep import carry_on

__all__ = ["Spec", "carry_on", "read_runs", "read_spec", "summarised"]
