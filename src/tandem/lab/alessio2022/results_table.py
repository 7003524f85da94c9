"""The tables of the reproduction of Alessio et al. (2022), in Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import Any

from tandem.cell.model import Cell
from tandem.lab.alessio2022 import cells
from tandem.lab.origin import origin
from tandem.learn.baseline import best_rule

Document = Mapping[str, Any]


def table(document: Document) -> str:
    """Published, as described, our recipe and exact, side by side, as Markdown."""
    lines = [
        *origin(document, f"seeds {document['seeds'][0]} to {document['seeds'][-1]}"),
        f"Published: {document['published']}.",
    ]
    for grid in document["grids"]:
        lines += ["", *_grid_lines(grid)]
    lines += [
        "",
        *_formulation_lines(document),
        "",
        *_coverage_lines(document["coverage"]),
        "",
        *_cell_lines(document),
    ]
    return "\n".join(lines)


def _grid_lines(grid: Mapping[str, Any]) -> list[str]:
    known = grid["exact"]
    bound = (
        f"success whatever the human does, within {known['minimax']} moves of both"
        if known["minimax"]
        else "the human can prevent it"
    )
    lines = [
        f"Grid `{grid['grid']}`: success rates, mean over seeds with 95 % interval.",
        "",
        (
            "| robot trained | seeds | random human | human with a random goal | human with a wrong"
            " goal | learned adversary | greedy: wrong goal barred | greedy: bounded, exactly |"
            " moves, idle human | moves at the worst |"
        ),
        "|" + "---|" * 10,
    ]
    for row in grid["summary"]:
        rates = [
            _rate(row["success"][human])
            for human in ("random", "random goal", "wrong goal", "adversary")
        ]
        tail = [
            f"{row['barred']} of {row['seeds']}",
            f"{row['bounded']} of {row['seeds']}",
            _or_none(row["nominal"]),
            _or_none(row["worst"]),
        ]
        lines.append("| " + " | ".join([row["training"], str(row["seeds"]), *rates, *tail]) + " |")
    quick = known["quickest"]
    lines += [
        (
            f"| exact: the quickest way | | | | | 0 % | {'yes' if quick['barred'] else 'no'} |"
            f" {'yes' if quick['worst'] else 'no'} | {quick['nominal']} |"
            f" {_or_none(quick['worst'])} |"
        ),
        (
            f"| exact: minimax | | {100 * known['random']:.1f} % (best there is) | | |"
            f" {'100' if known['minimax'] else '0'} % | | {'yes' if known['minimax'] else 'no'} | |"
            f" {_or_none(known['minimax'])} |"
        ),
        "",
        f"Exact value: {bound} ({known['states']:,} states).",
    ]
    for test in grid["tests"]:
        lines.append(
            f"Against the learned adversary, {test['first']!r} {100 * test['means'][0]:.1f} % and"
            f" {test['second']!r} {100 * test['means'][1]:.1f} %: p = {test['p']:.2g} (one-sided,"
            f" permutation), {100 * test['rank_sum']:.0f} % of the pairs of seeds won."
        )
    return lines


def _formulation_lines(document: Document) -> list[str]:
    lines = [
        (
            "| random 5 x 5 grids | drawn | success can be forced | of these, the quickest way"
            " fails at the worst |"
        ),
        "|---|---|---|---|",
    ]
    for way, count in document["formulations"].items():
        lines.append(
            f"| {way} | {count['drawn']} | {count['winnable']} | {count['quickest_fails']} |"
        )
    return lines


def _coverage_lines(records: Sequence[Mapping[str, Any]]) -> list[str]:
    covered, whole, moves = (
        fmean(record[name] for record in records) for name in ("covered", "all_covered", "moves")
    )
    return [
        f"Area coverage (MathWorks' rewards), {len(records)} seeds: {100 * covered:.1f} % of the"
        f" squares covered, all in {100 * whole:.1f} %, {moves:.1f} moves of both; at least"
        f" {records[0]['least']} are needed."
    ]


def _cell_lines(document: Document) -> list[str]:
    lines = [
        (
            "Cells: seconds when the human helps most (nominal) / when it does the worst that is"
            " legal (guaranteed)."
        ),
        "",
        (
            "| cell | least nominal | least guaranteed | both at once? | optimiser's robot | best"
            " dispatch rule, planned | best rule's robot | untrained networks |"
            " learned without an adversary | with an adversary |"
        ),
        "|" + "---|" * 10,
    ]
    known = cells.cells()
    for row in document["cells"]:
        guaranteed, last = row["trade"][0][0], row["trade"][-1]
        both = (
            "yes"
            if len(row["trade"]) == 1
            else f"no: {last[1]:g} s costs a guarantee of {last[0]:g} s instead of {guaranteed:g} s"
        )
        learned = [
            _learned(row[kind], last[1], guaranteed)
            for kind in ("untrained", "plain", "adversarial")
        ]
        robot = f"{row['optimiser'][0]:g} / {row['optimiser'][1]:g}"
        planned, (name, (helped, spoiled)) = _by_rules(known[row["cell"]])
        rules = [planned, f"{helped:g} / {spoiled:g} ({name})"]
        lines.append(
            "| "
            + " | ".join(
                [row["cell"], f"{last[1]:g}", f"{guaranteed:g}", both, robot, *rules, *learned]
            )
            + " |"
        )
    price = document["price"]
    lines += [
        "",
        (
            f"Of {price['cells']} random cells ({price['tasks']} tasks), {price['free']} have a"
            " robot with both the least guaranteed and the least nominal time; the optimiser's"
            f" robot misses the least guarantee in {price['optimiser_misses']}. If the human may"
            f" choose badly but never waits: {price['free_if_diligent']} of {price['cells']}."
        ),
    ]
    return lines


def _by_rules(cell: Cell) -> tuple[str, tuple[str, tuple[float, float]]]:
    """What learns nothing: the best dispatch rule's schedule, and the robot of a rule."""
    rule = best_rule(cell, lambda makespan, _: makespan)
    assert rule is not None  # none of these cells knows limits
    return f"{rule.result.makespan:g} ({rule.name})", cells.best_rule_robot(cell)


def _learned(pairs: Sequence[Sequence[float]], nominal: float, guaranteed: float) -> str:
    """Mean (nominal / guaranteed) over the seeds, and how many reached the least of each."""
    means = [fmean(pair[index] for pair in pairs) for index in range(2)]
    counts = [
        sum(pair[0] == nominal for pair in pairs),
        sum(pair[1] == guaranteed for pair in pairs),
    ]
    return (
        f"{means[0]:.1f} / {means[1]:.1f} (least reached by {counts[0]} / {counts[1]} of"
        f" {len(pairs)})"
    )


def _rate(value: Mapping[str, Any]) -> str:
    low, high = value["ci95"]
    return f"{100 * value['mean']:.1f} % ({100 * low:.1f} to {100 * high:.1f})"


def _or_none(value: float | None) -> str:
    return "none" if value is None else f"{value:g}"
