"""What was planned, its measures, and the checker that knows no solver."""

from tandem.schedule.model import Assignment, Schedule

__all__ = ["Assignment", "Schedule"]
