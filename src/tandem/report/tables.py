"""The tables of the page: the plans, each plan's steps, the balance of operators, the tasks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from tandem.cell.model import Cell
from tandem.draw.style import Look, looks, task_label
from tandem.plan.cycle.result import CycleFront
from tandem.plan.result import Front, Result, Status
from tandem.report.language import Words
from tandem.report.limits import limit_heads, used_of_limits
from tandem.report.markup import Markup, hatch_id, join, tag
from tandem.report.waits import wait_words
from tandem.schedule.critical import critical_path, slack
from tandem.schedule.measures import (
    changing,
    idle,
    mode_of,
    resting,
    stress_by_human,
    utilisation,
    working,
)
from tandem.schedule.model import Assignment, Schedule

MOST_PLANS = 6
"""So many plans have a column of their own in the table of tasks."""

MOST_PRINTED = 20
"""Of more plans than that, paper lists those that have a column."""


def table(
    heads: Sequence[tuple[str, str]], rows: Iterable[Markup], label: str, *, on_paper: str = ""
) -> Markup:
    """A table that can be scrolled on a narrow screen. A head is (words, class); `on_paper` is
    printed above the heads on every page.
    """
    line = [tag("tr", tag("th", on_paper, colspan=len(heads)), class_="paper")] if on_paper else []
    head = tag(
        "thead",
        *line,
        tag("tr", *(tag("th", words, scope="col", class_=kind or None) for words, kind in heads)),
    )
    return tag(
        "div",
        tag("table", head, tag("tbody", *rows), aria_label=label),
        class_="wide",
        role="region",
        aria_label=label,
        tabindex="0",
    )


def plans(front: Front, t: Words) -> Markup:
    """One row a point: numbers, how far proven, who does what."""
    shown = list(looks(front.cell).values())
    shown = shown if len(shown) <= 4 else []
    heads = [
        (t("front.plan"), ""),
        (t("front.makespan"), "number"),
        (t("front.stress"), "number"),
        *([(t("front.cost"), "number")] if front.cell.cost is not None else []),
        (t("front.status"), ""),
        (t("front.digest"), ""),
    ]
    heads += [(t("front.does", who=look.label), "screen") for look in shown]
    rows = []
    printed = range(len(front)) if len(front) <= MOST_PRINTED else shown_plans(front)
    for place, result in enumerate(front, 1):
        link = tag("a", str(place), href=f"#plan-{place}")
        mark = (
            join([link, " ", tag("span", t("plan.recommended"), class_="badge")])
            if len(front) > 1 and result is front.knee
            else link
        )
        cells = [
            tag("th", mark, scope="row"),
            _number(result.makespan, t),
            _number(result.stress, t),
            *([_number(result.cost, t)] if result.cost is not None else []),
            tag("td", status(result, t)),
            tag("td", tag("code", result.schedule.digest)),
        ]
        cells += [
            tag("td", tasks_of(result.schedule, look.operator, t), class_="screen")
            for look in shown
        ]
        more = None if place - 1 in printed else "more"
        rows.append(tag("tr", *cells, data_plan=place, class_=more))
    some = t("front.some", shown=len(printed), n=len(front)) if len(printed) < len(front) else ""
    return join([table(heads, rows, t("front.table")), tag("p", some, class_="paper some note")])


def doubt(front: Front, t: Words) -> list[str]:
    """That another point may be the recommended one when more is known."""
    if front.is_knee_certain:
        return []
    proven = front.knee.status == Status.OPTIMAL
    return [t("summary.knee.proven" if proven else "summary.knee.open", n=front.knee_place + 1)]


def status(result: Result, t: Words) -> str:
    """Proven and by whom, or the gap and the bounds."""
    if result.status == Status.OPTIMAL:
        return proven(result, t)
    return t(
        "front.gap",
        gap=t.share(result.gap),
        low_makespan=t.seconds(result.bound.makespan),
        low_stress=t.number(result.bound.stress),
    )


def proven(result: Result, t: Words) -> str:
    """That it is proven; by whom, where that is known."""
    by = result.bound.proved_by
    if by is None:
        return t("front.proven")
    makespan, stress = (t(f"prover.{one.name.lower()}") for one in by)
    if makespan == stress:
        return t("front.proven.by", both=makespan)
    return t("front.proven.each", makespan=makespan, stress=stress)


def tasks_of(schedule: Schedule, operator: str, t: Words, most: int = 12) -> str:
    """The operator's tasks in order; of many, the first ones and how many more."""
    names = [a.task for a in schedule.of(operator)]
    if len(names) <= most:
        return ", ".join(names) or "–"
    return f"{', '.join(names[: most - 2])} {t('front.more', n=len(names) - most + 2)}"


def steps(cell: Cell, schedule: Schedule, t: Words) -> Markup:
    """One row a task, in order of the start."""
    path = {link.assignment.task: link for link in critical_path(cell, schedule)}
    slacks, shown = slack(cell, schedule), looks(cell)
    keys = (
        ("task", ""),
        ("who", ""),
        ("start", "number"),
        ("end", "number"),
        ("time", "number screen"),
        ("stress", "number"),
        ("slack", "number"),
    )
    rows = []
    for a in schedule:
        mode = mode_of(cell, a)
        load = sum(mode.stress.values()) if mode else 0.0
        late = t("plan.step.critical") if a.task in path else t.number(slacks[a.task])
        cells = [
            tag("th", named(cell, a.task), scope="row"),
            tag("td", " + ".join(shown[o].label for o in a.operators)),
            *(_number(value, t) for value in (a.start, a.end)),
            tag("td", t.number(a.end - a.start), class_="number screen"),
            tag("td", t.number(load) if mode and mode.stress else "–", class_="number"),
            tag("td", late, class_="number"),
        ]
        rows.append(tag("tr", *cells, class_="critical" if a.task in path else None))
    return table([(t(f"plan.step.{key}"), kind) for key, kind in keys], rows, t("plan.steps"))


def balance(cell: Cell, schedule: Schedule, t: Words) -> Markup:
    """One row an operator: how the time to the makespan is spent, and the stress collected."""
    busy, free, used, loads = (
        working(cell, schedule),
        idle(cell, schedule),
        utilisation(cell, schedule),
        stress_by_human(cell, schedule),
    )
    swaps, resting_s = changing(cell, schedule), resting(cell, schedule)
    total = max((a.end for a in schedule), default=0.0)
    keys = (
        "operator",
        "kind",
        "tasks",
        "busy",
        between(cell),
        "break",
        "idle",
        "utilisation",
        "stress",
    )
    heads = [(t(f"balance.{key}"), "" if key in ("operator", "kind") else "number") for key in keys]
    rows = []
    for name, look in looks(cell).items():
        off = resting_s[name]
        limit = cell.operators[name].stress_limit
        load = (
            "–"
            if name not in loads
            else t.number(loads[name])
            if limit is None
            else t("balance.limit", stress=t.number(loads[name]), limit=t.number(limit))
        )
        words = t(
            "balance.bar.walking" if cell.walking else "balance.bar",
            busy=t.number(busy[name]),
            changeover=t.number(swaps[name]),
            off=t.number(off),
            idle=t.number(free[name]),
        )
        parts = (busy[name], swaps[name], off)
        bar = _spent(parts, total, words, hatch_id(look, looks(cell)))
        cells = [
            tag("th", look.label, scope="row"),
            tag("td", t(look.kind)),
            _number(len(schedule.of(name)), t),
            *(_number(value, t) for value in (busy[name], swaps[name], off, free[name])),
            tag("td", tag("span", bar, t.share(used[name]), class_="key"), class_="number"),
            tag("td", load, class_="number"),
        ]
        rows.append(tag("tr", *cells))
    return table(heads, rows, t("balance.title"))


def used_limits(cell: Cell, schedule: Schedule, t: Words) -> Markup:
    """One row a limit of a person: what is used of it. Nothing where nobody has `limits`."""
    rows = [
        tag(
            "tr",
            tag("th", who, scope="row"),
            tag("td", measure),
            *(tag("td", number, class_="number") for number in numbers),
        )
        for who, measure, *numbers in (one.words(t) for one in used_of_limits(cell, schedule))
    ]
    if not rows:
        return Markup("")
    title = t("limits.title")
    said = [(head, "number" if place > 1 else "") for place, head in enumerate(limit_heads(t))]
    return tag("div", tag("h4", title), table(said, rows, title))


def _spent(parts: tuple[float, float, float], total: float, words: str, fill: str) -> Markup:
    """How an operator spends the makespan as a small bar: busy, walks and changeovers, breaks,
    idle; in words for who does not see it.
    """
    busy, swap, off = parts
    x, pieces = 0.0, []
    for value, paint in (
        (busy, f"url(#{fill})"),
        (swap, "url(#fill-changeover)"),
        (off, "url(#fill-break)"),
    ):
        width = 160 * value / total if total else 0.0
        pieces.append(tag("rect", x=x, y=0, width=width, height=18, fill=paint))
        x += width
    return tag(
        "svg",
        tag("title", words),
        *pieces,
        width=160,
        height=18,
        viewBox="0 0 160 18",
        preserveAspectRatio="none",
        role="img",
        aria_label=words,
    )


def shown_plans(front: Front | CycleFront, point: int | None = None) -> list[int]:
    """Indices of the plans that get a column: all, or the ends, the knee, the chosen `point` and
    some between.
    """
    if len(front) <= MOST_PLANS:
        return list(range(len(front)))
    spread = {round(i * (len(front) - 1) / (MOST_PLANS - 2)) for i in range(MOST_PLANS - 1)}
    return sorted(spread | {front.knee_place, front.knee_place if point is None else point - 1})


def tasks(front: Front, t: Words) -> Markup:
    """One row a task: who can do it in what time, stress, conditions, and what each plan chose."""
    cell, shown = front.cell, looks(front.cell)
    columns = shown_plans(front)
    has_part, rules = (
        any(task.part for task in cell.tasks.values()),
        {name: conditions(cell, name, t) for name in cell.tasks},
    )
    heads = [
        (t("tasks.task"), ""),
        *([(t("tasks.part"), "")] if has_part else []),
        (t("tasks.after"), ""),
        (t("tasks.who"), ""),
        (t("tasks.stress"), "number"),
    ]
    heads += [(t("tasks.rules"), "")] if any(rules.values()) else []
    heads += [(t("tasks.plan", n=place + 1), "") for place in columns]
    chosen = [{a.task: a for a in front[place].schedule} for place in columns]
    rows = []
    for name, task in cell.tasks.items():
        cells = [
            tag("th", named(cell, name), scope="row"),
            *([tag("td", task.part or "")] if has_part else []),
        ]
        cells += [
            tag("td", ", ".join(task.predecessors) or "–"),
            tag("td", ways(cell, name, shown, t), class_="ways"),
            tag("td", _loads(cell, name, shown, t), class_="number ways"),
        ]
        cells += [tag("td", pieces(rules[name]))] if any(rules.values()) else []
        cells += [tag("td", _choice(plan.get(name), shown, t), class_="choice") for plan in chosen]
        rows.append(tag("tr", *cells))
    note = (
        tag("p", t("tasks.some", shown=len(columns), n=len(front)), class_="note")
        if len(columns) < len(front)
        else Markup("")
    )
    return join([note, table(heads, rows, t("tasks.title"))])


def named(cell: Cell, task: str) -> str:
    """Name and label of a task."""
    label = task_label(cell, task)
    return label if label == task else f"{task}: {label}"


def ways(cell: Cell, task: str, shown: dict[str, Look], t: Words) -> Markup:
    """Every way of doing a task in words: `Anna: 6.5 s, Anna + Cobot: 8 s`."""
    return pieces(
        f"{' + '.join(shown[o].label for o in mode.operators)}: {t.seconds(mode.time)}"
        for mode in cell.modes(task)
    )


def pieces(found: Iterable[str]) -> Markup:
    """A list in which a line breaks between the entries only."""
    entries = list(found)
    return join(
        tag("span", entry + ("," if place < len(entries) - 1 else ""), class_="piece")
        for place, entry in enumerate(entries)
    )


def between(cell: Cell) -> str:
    """The column of a balance for what operators do between their tasks."""
    return "walking" if cell.walking else "changeover"


def conditions(cell: Cell, name: str, t: Words) -> list[str]:
    """What else holds for a task: place, tools, zone, earliest start, waits, deadline."""
    task = cell.tasks[name]
    found = [t("tasks.place", place=task.place)] if task.place else []
    found += _tools(cell, name, t)
    found += [t("tasks.zone", zone=task.zone)] if task.zone else []
    found += [t("tasks.release", release=t.number(task.release))] if task.release else []
    found += wait_words(cell, name, t)
    return found + (
        [t("tasks.deadline", deadline=t.number(task.deadline))] if task.deadline is not None else []
    )


def _tools(cell: Cell, name: str, t: Words) -> list[str]:
    """The tool of a task; where it depends on who does it, each with those who need it."""
    task, shown, who_needs = cell.tasks[name], looks(cell), dict[str, list[str]]()
    if not isinstance(task.tool, Mapping) and all(way.tool is None for way in task.together):
        return [t("tasks.tool", tool=task.tool)] if task.tool else []
    for mode in cell.modes(name):
        for who, tool in mode.tools.items():
            others = [shown[other].label for other in mode.operators if other != who]
            said = shown[who].label
            if others:
                said = t("tasks.tool.with", who=said, others=" + ".join(others))
            who_needs.setdefault(tool, []).append(said)
    return [t("tasks.tool.of", tool=tool, who=", ".join(who)) for tool, who in who_needs.items()]


def _loads(cell: Cell, task: str, shown: dict[str, Look], t: Words) -> Markup | str:
    """The stress of a task: one number when it is the same for everyone alone, else per human."""
    alone = {
        mode.operators[0]: next(iter(mode.stress.values()))
        for mode in cell.modes(task)
        if len(mode.operators) == 1 and mode.stress
    }
    joint = {
        mode.operators: sum(mode.stress.values())
        for mode in cell.modes(task)
        if len(mode.operators) > 1 and mode.stress
    }
    if not joint and len(set(alone.values())) == 1:
        return t.number(next(iter(alone.values())))
    found = [f"{shown[who].label}: {t.number(load)}" for who, load in alone.items()]
    found += [
        f"{' + '.join(shown[o].label for o in who)}: {t.number(load)}"
        for who, load in joint.items()
    ]
    return pieces(found) if found else "–"


def _choice(a: Assignment | None, shown: dict[str, Look], t: Words) -> Markup | str:
    if a is None:
        return "–"
    lines = (
        " + ".join(shown[o].label for o in a.operators),
        f"{t.number(a.start)}–{t.number(a.end)} s",
    )
    return join(tag("span", line, " ", class_="piece") for line in lines)


def _number(value: float, t: Words) -> Markup:
    return tag("td", t.number(value), class_="number")
