"""A front as Markdown for wikis: the plans, the recommended one step by step, instructions for each
operator, assumptions.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tandem.draw.imprint import imprint, remarks
from tandem.draw.style import looks
from tandem.plan.result import Front, Result
from tandem.report.html import summary
from tandem.report.instructions import Row, columns, instructed, origin, rules, steps
from tandem.report.language import Words, words
from tandem.report.limits import limit_heads, used_of_limits
from tandem.report.risk import is_told, risk_heads, risk_note, risk_rows
from tandem.report.sources import assumptions, made
from tandem.report.tables import named, status
from tandem.schedule.critical import critical_path, slack
from tandem.schedule.measures import mode_of


def markdown(
    front: Front,
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
    point: int | None = None,
    stale: bool = False,
) -> str:
    """The report as text; see `write`. Raises UsageError when reports do not speak the language."""
    t = words(language)
    parts = [
        f"# {escaped(t('title', name=front.cell.name or t('unnamed')))}",
        *map(escaped, summary(front, t, point, stale)),
    ]
    if len(front):
        parts += [f"## {t('front.title')}", _front(front, t)]
        if is_told(front):
            parts += [f"### {t('risk.title')}", table(risk_heads(front, t), risk_rows(front, t))]
            parts.append(risk_note(front, t))
        result = front.shown(point)
        title = t(
            "plan.title",
            n=front.results.index(result) + 1,
            makespan=t.seconds(result.makespan),
            stress=t.number(result.stress),
        )
        parts += [f"## {title}", f"*{escaped(imprint(result, t, stale=stale))}*", _steps(result, t)]
        if told := used_of_limits(result.cell, result.schedule):
            parts += [f"### {t('limits.title')}"]
            rows = [list(map(escaped, one.words(t))) for one in told]
            parts += [table(limit_heads(t), rows)]
        plan = "; ".join([title, *remarks(result, t, stale=stale)])
        parts += [
            part
            for operator in instructed(front.cell)
            for part in _instructions(result, operator, plan, t)
        ]
    parts += [
        f"## {t('assume.title')}",
        "\n".join(f"- {escaped(sentence)}" for sentence in assumptions(front, t)),
    ]
    parts += [
        f"## {t('made.title')}",
        "\n".join(f"- {what}: {escaped(value)}" for what, value in made(front, t, command, date)),
        f"*{escaped(t('safety'))}*",
    ]
    return "\n\n".join(parts) + "\n"


def _front(front: Front, t: Words) -> str:
    shown = looks(front.cell)
    heads = [
        t("front.plan"),
        t("front.makespan"),
        t("front.stress"),
        *([t("front.cost")] if front.cell.cost is not None else []),
        t("front.status"),
        t("front.digest"),
        *(escaped(t("front.does", who=look.label)) for look in shown.values()),
    ]
    rows = []
    for place, result in enumerate(front, 1):
        mark = (
            f"**{place}** ({t('plan.recommended')})"
            if len(front) > 1 and result is front.knee
            else str(place)
        )
        does = [
            ", ".join(a.task for a in result.schedule.of(name)) or "–"
            for name in front.cell.operators
        ]
        rows.append(
            [
                mark,
                t.number(result.makespan),
                t.number(result.stress),
                *([t.number(result.cost)] if result.cost is not None else []),
                status(result, t),
                result.schedule.digest,
                *map(escaped, does),
            ]
        )
    return table(heads, rows)


def _steps(result: Result, t: Words) -> str:
    cell, schedule = result.cell, result.schedule
    critical, free, shown = (
        {link.assignment.task for link in critical_path(cell, schedule)},
        slack(cell, schedule),
        looks(cell),
    )
    rows = []
    for a in schedule:
        mode = mode_of(cell, a)
        load = t.number(sum(mode.stress.values())) if mode and mode.stress else "–"
        late = t("plan.step.critical") if a.task in critical else t.number(free[a.task])
        who = " + ".join(shown[o].label for o in a.operators)
        rows.append(
            [
                escaped(named(cell, a.task)),
                escaped(who),
                t.number(a.start),
                t.number(a.end),
                load,
                late,
            ]
        )
    return table(
        [t(f"plan.step.{key}") for key in ("task", "who", "start", "end", "stress", "slack")], rows
    )


def _instructions(result: Result, operator: str, plan: str, t: Words) -> list[str]:
    found = steps(result.cell, result.schedule, operator, t)
    title = f"### {escaped(t('steps.title', who=looks(result.cell)[operator].label))}"
    if not found:
        return [title, t("steps.none")]
    shown = columns(found)
    rows = [[said(step, key, t) for key in shown] for step in found]
    return [
        title,
        *map(escaped, rules(result.cell, operator, t)),
        table([t(f"steps.{key}") for key in shown], rows),
        escaped(origin(result, operator, plan, t)),
    ]


def said(step: Row, key: str, t: Words) -> str:
    """What stands in a column of an instruction sheet; of the conditions, the one expected last in
    bold.
    """
    if key == "begin":
        return "<br>".join(
            f"**{escaped(condition.says)}**" if condition.last else escaped(condition.says)
            for condition in step.begin
        )
    value = getattr(step, key)
    if isinstance(value, tuple):
        return "<br>".join(map(escaped, value)) or "–"
    if isinstance(value, float):
        return t.number(value)
    return "–" if value in ("", None) else escaped(str(value))


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of GitHub's flavour."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def escaped(text: str) -> str:
    """The text with nothing in it that Markdown or HTML would take for a sign."""
    escaped = text.replace("&", "&amp;").replace("<", "&lt;")
    for sign in "\\`*_[]|#":
        escaped = escaped.replace(sign, f"\\{sign}")
    return " ".join(escaped.split())
