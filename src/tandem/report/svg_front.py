"""The trade-off as SVG for the page: every point is a link to its plan."""

from __future__ import annotations

from collections.abc import Sequence

from tandem.draw.front import bound_points, least_time, staircase, time_axis, time_of, window
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.plan.result import Front, Result, Status
from tandem.report.language import Words
from tandem.report.markup import Markup, figure, tag, text, ticks, width_of
from tandem.report.players import Player

WIDTH, HEIGHT = 740.0, 420.0
LEFT, RIGHT, TOP, BOTTOM = 80.0, 20.0, 18.0, 58.0


def front_chart(front: Front | CycleFront, t: Words, players: Sequence[Player] = ()) -> Markup:
    """The chart with dominated area, knee and, where something is not proven, bounds. Players are
    marked by diamonds.
    """
    low_x, high_x, low_y, high_y = window(front)
    shown = [
        (p.name, p.makespan, p.stress)
        for p in players
        if p.makespan is not None and p.stress is not None
    ]
    high_x = max([high_x, *(makespan + 0.12 * (high_x - low_x) for _, makespan, _ in shown)])
    high_y = max([high_y, *(stress + 0.12 * (high_y - low_y) for _, _, stress in shown)])

    def at(makespan: float, stress: float) -> tuple[float, float]:
        across = LEFT + (makespan - low_x) / (high_x - low_x) * (WIDTH - LEFT - RIGHT)
        return across, HEIGHT - BOTTOM - (stress - low_y) / (high_y - low_y) * (
            HEIGHT - TOP - BOTTOM
        )

    edge = [at(*corner) for corner in staircase(front.points, high_x, high_y)]
    area = _joined([*edge, at(high_x, high_y)])
    bounded = bound_points(front)
    bound = [at(*corner) for corner in staircase(bounded, high_x, high_y)] if bounded else []
    pieces = [
        tag("polygon", tag("title", t("front.dominated")), points=area, class_="dominated"),
        _axes(low_x, high_x, low_y, high_y, at, t(time_axis(front)), t),
        *(_between(edge, bound, t) if bounded else []),
        tag("polyline", points=_joined(edge), class_="edge"),
    ]
    places = [at(time_of(r), r.stress) for r in front]
    knee = front.knee_place
    labelled = _labelled(front, places, knee, t)
    results: tuple[Result | CycleResult, ...] = front.results
    for place, result in enumerate(results):
        bounds = at(least_time(result), result.bound.stress)
        pieces.append(
            _point(
                place,
                result,
                places[place],
                bounds,
                t,
                knee=place == knee,
                label=place in labelled,
                many=len(front) > 2,
                reaches=not bounded,
            )
        )
    for place_of, names in _together(
        [(name, at(makespan, stress)) for name, makespan, stress in shown]
    ):
        pieces.append(_diamond(", ".join(names), place_of))
    label = t("cycle.chart.front" if isinstance(front, CycleFront) else "front.chart")
    drawing = tag(
        "svg",
        *pieces,
        viewBox=f"0 0 {WIDTH:g} {HEIGHT:g}",
        width=WIDTH,
        height=HEIGHT,
        role="group",
        aria_label=label,
        class_="front",
        xmlns="http://www.w3.org/2000/svg",
    )
    return figure(drawing, label)


def _joined(corners: Sequence[tuple[float, float]]) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)


def _between(
    edge: Sequence[tuple[float, float]], bound: Sequence[tuple[float, float]], t: Words
) -> list[Markup]:
    """What is open between the points and the bound, hatched, and the bound."""
    hatch = tag(
        "pattern",
        tag("path", d="M0,8 L8,0 M-2,2 L2,-2 M6,10 L10,6", class_="hatch"),
        id="open-hatch",
        width=8,
        height=8,
        patternUnits="userSpaceOnUse",
    )
    area = _joined([*bound, *reversed(edge)])
    return [
        tag("defs", hatch),
        tag(
            "polygon",
            tag("title", t("front.between")),
            points=area,
            fill="url(#open-hatch)",
            class_="open-area",
        ),
        tag("polyline", tag("title", t("front.bound")), points=_joined(bound), class_="bound"),
    ]


def _axes(
    low_x: float, high_x: float, low_y: float, high_y: float, at: object, time: str, t: Words
) -> Markup:
    assert callable(at)
    base, pieces = HEIGHT - BOTTOM, []
    for value in ticks(low_x, high_x, 10):
        x, _ = at(value, low_y)
        pieces.append(tag("line", x1=x, x2=x, y1=TOP, y2=base + 5, class_="grid"))
        pieces.append(text(x, base + 23, t.number(value), text_anchor="middle", class_="faint"))
    for value in ticks(low_y, high_y, 8):
        _, y = at(low_x, value)
        pieces.append(tag("line", x1=LEFT - 5, x2=WIDTH - RIGHT, y1=y, y2=y, class_="grid"))
        pieces.append(text(LEFT - 10, y + 5.5, t.number(value), text_anchor="end", class_="faint"))
    pieces.append(tag("path", d=f"M{LEFT:g},{TOP:g} V{base:g} H{WIDTH - RIGHT:g}", class_="axis"))
    pieces.append(text((LEFT + WIDTH) / 2, HEIGHT - 8, time, text_anchor="middle"))
    middle = (TOP + base) / 2
    pieces.append(
        text(
            20,
            middle,
            t("front.stress"),
            text_anchor="middle",
            transform=f"rotate(-90 20 {middle:g})",
        )
    )
    return tag("g", *pieces)


def _label(result: Result | CycleResult, t: Words, *, knee: bool) -> str:
    values = t("picture.point", makespan=t.seconds(time_of(result)), stress=t.number(result.stress))
    return f"{values} ({t('front.knee')})" if knee else values


def _labelled(
    front: Front | CycleFront, places: list[tuple[float, float]], knee: int, t: Words
) -> set[int]:
    """The knee and the ends, then every other point whose label meets no other point or label."""
    boxes = [(x - 9, y - 9, x + 9, y + 9) for x, y in places]
    chosen: set[int] = set()
    for place in dict.fromkeys([knee, 0, len(front) - 1, *range(len(front))]):
        x, y = places[place]
        box = (
            x + 17,
            y - 28,
            x
            + 19
            + width_of(_label(front[place], t, knee=False), 16)
            + (120 if place == knee else 0),
            y - 8,
        )
        free = not any(
            box[0] < b[2] and b[0] < box[2] and box[1] < b[3] and b[1] < box[3] for b in boxes
        )
        if free or place == knee:
            chosen.add(place)
            boxes.append(box)
    return chosen


def _together(
    marks: list[tuple[str, tuple[float, float]]],
) -> list[tuple[tuple[float, float], list[str]]]:
    """Marks that would cover each other, as one with all their names."""
    groups: list[tuple[tuple[float, float], list[str]]] = []
    for name, (x, y) in marks:
        near = next(
            (names for (a, b), names in groups if abs(a - x) < 12 and abs(b - y) < 12), None
        )
        if near is None:
            groups.append(((x, y), [name]))
        else:
            near.append(name)
    return groups


def _diamond(names: str, at: tuple[float, float]) -> Markup:
    x, y = at
    inside = x + 14 + width_of(names, 16) < WIDTH
    label = text(
        x + 14 if inside else x - 14,
        y + 24,
        names,
        text_anchor="start" if inside else "end",
        class_="faint",
    )
    return tag(
        "g",
        tag("title", names),
        tag("path", d=f"M{x:.2f},{y - 11:.2f} l11,11 l-11,11 l-11,-11 Z", class_="player"),
        label,
    )


def _point(
    place: int,
    result: Result | CycleResult,
    at: tuple[float, float],
    bounds: tuple[float, float],
    t: Words,
    *,
    knee: bool,
    label: bool,
    many: bool,
    reaches: bool,
) -> Markup:
    x, y = at
    proven = result.status == Status.OPTIMAL
    room = "cycle" if isinstance(result, CycleResult) else "front"
    key = f"{room}.point.proven" if proven else f"{room}.point.open"
    values = {"makespan": t.seconds(time_of(result)), "stress": t.number(result.stress)}
    words = t(
        key,
        n=place + 1,
        low_makespan=t.seconds(least_time(result)),
        low_stress=t.number(result.bound.stress),
        **values,
    )
    pieces = [tag("title", words)]
    if not proven and reaches:
        pieces.append(
            tag(
                "path",
                d=f"M{bounds[0]:.2f},{y - 6:.2f} v12 m0,-6 H{x:.2f} V{bounds[1]:.2f} m-6,0 h12",
                class_="bounds",
            )
        )
    if knee:
        pieces.append(tag("circle", cx=x, cy=y, r=14, class_="knee"))
    pieces.append(tag("circle", cx=x, cy=y, r=17, class_="target"))
    pieces.append(tag("circle", cx=x, cy=y, r=8, class_="dot" if proven else "dot open"))
    target = f"#plan-{place + 1}"
    point = tag("a", *pieces, href=target, class_="point", data_plan=place + 1, aria_label=words)
    if not label:
        return point
    shown = _label(result, t, knee=knee and many)
    inside = x + 19 + width_of(shown, 16) < WIDTH
    written = text(
        x + 19 if inside else x - 19,
        y - 13,
        shown,
        text_anchor="start" if inside else "end",
        class_="strong" if knee else None,
    )
    # The point's own name says all of it: what is written beside it leads there too, but is not
    # read out or reached a second time.
    beside = tag("a", written, href=target, aria_hidden="true", tabindex=-1)
    return tag("g", point, beside)
