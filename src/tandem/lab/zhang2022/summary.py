"""What the records of Zhang et al. (2022) say: means over seeds with their intervals, the table,
and what the human is shown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tandem.cell.model import Cell
from tandem.lab.origin import origin
from tandem.lab.zhang2022.display import episode, lines, shown

WITHIN = 0.05
"""What counts as near the matching point."""


def summary(
    rows: Sequence[Mapping[str, Any]], optimum: Mapping[float, float]
) -> list[dict[str, Any]]:
    """One entry an arm and factor. Means come with the half width of their 95 % interval over
    seeds.

    `noise_helps`: for an arm with noise, how much less a noisy human costs than in the same recipe
    without it, seed by seed; above 0 is better.
    """
    from tandem.lab.kinat2023.experiment import mean

    found = []
    for arm, factor in dict.fromkeys((row["arm"], row["factor"]) for row in rows):
        own = [row for row in rows if (row["arm"], row["factor"]) == (arm, factor)]
        gaps, losses = (
            [row["greedy"]["gap"] for row in own],
            [loss for row in own for loss in row["changed"]["losses"]],
        )
        plain = [
            row
            for row in rows
            if (row["recipe"], row["factor"]) == (own[0]["recipe"], factor)
            and not row["noise"]
            and not row["changes"]
        ]
        without = {row["seed"]: row["noisy"]["cost"] for row in plain}
        helps = [
            without[row["seed"]] - row["noisy"]["cost"]
            for row in own
            if row["noise"] and row["seed"] in without
        ]
        found.append(
            {
                "arm": arm,
                "factor": factor,
                "seeds": len(own),
                "finished": sum(row["greedy"]["finished"] for row in own),
                "makespan": mean([row["greedy"]["makespan"] for row in own]),
                "difficulty": mean([row["greedy"]["difficulty"] for row in own]),
                "gap": mean(gaps),
                "largest_gap": max(gaps),
                "within": sum(gap <= WITHIN for gap in gaps),
                "beyond": mean([row["greedy"]["beyond"] for row in own]),
                "noisy_cost": mean([row["noisy"]["cost"] for row in own]),
                "noisy_gap": mean([row["noisy"]["cost"] / optimum[factor] - 1 for row in own]),
                "noise_helps": mean(helps) if helps else None,
                "changed_episodes": sum(row["changed"]["episodes"] for row in own),
                "changed_finished": sum(row["changed"]["finished"] for row in own),
                "changed_cost": mean([row["changed"]["cost"] for row in own]),
                "loss": mean(losses),
                "losses": len(losses),
                "fatigue": mean([row["greedy"]["fatigue"] for row in own]),
                "cpu_s": mean([row["cpu_s"] for row in own]),
            }
        )
    return found


def guides(cell: Cell, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What the human is shown in one learned assembly, and in one in which something unforeseen
    happens: the alternative sequence.
    """
    own = next(row for row in rows if row["recipe"] == "ours" and row["changes"])
    calm = episode(cell, own["greedy"]["action"])
    example = own["changed"]["example"]
    changed = episode(cell, example["action"], _change(example["change"]))
    since = changed.at or 0.0
    return {
        "arm": own["arm"],
        "factor": own["factor"],
        "seed": own["seed"],
        "assignments": calm.schedule.to_list(),
        "shown": shown(cell, calm.schedule),
        "change": {
            "happened": changed.happened,
            "at": changed.at,
            "assignments": changed.schedule.to_list(),
            "shown": shown(cell, changed.schedule, since=since),
        },
    }


def _change(numbers: Sequence[float]) -> Any:
    import numpy as np

    from tandem.lab.zhang2022.change import Change

    return Change(np.int32(numbers[0]), np.float32(numbers[1]), np.float32(numbers[2]))


def table(document: Mapping[str, Any]) -> str:
    """Published, as described, ours and exact, an arm a line; then what the human is shown.
    Markdown.
    """
    text = [
        *origin(document, f"seeds {document['seeds'][0]} to {document['seeds'][-1]}"),
        (
            "Published: not public (cell, numbers and results). The cell is alternator-like, an"
            " ASSUMPTION. Cost = seconds + factor x difficulty. Means over seeds with the half"
            " width of their 95 % interval; a loss is held against the re-planned optimum of what"
            " was left."
        ),
        "",
        _line(*HEAD),
        "|" + "---|" * len(HEAD),
    ]
    for factor, (makespan, difficulty) in document["matching"].items():
        best = makespan + float(factor) * difficulty
        text.append(
            _line(
                factor,
                "exact: the front's matching point",
                f"{makespan:g}",
                f"{difficulty:g}",
                "0 %",
            )
        )
        text += [_arm(row) for row in document["summary"] if f"{row['factor']:g}" == factor]
        rule, chance = document["rule"][factor], document["random"][factor]
        above = (rule["makespan"] + float(factor) * rule["difficulty"]) / best - 1
        text.append(
            _line(
                factor,
                f"best dispatch rule ({rule['rule']})",
                f"{rule['makespan']:g}",
                f"{rule['difficulty']:g}",
                f"{100 * above:.1f} %",
            )
        )
        text.append(_random(factor, chance, best))
    points = ", ".join(f"{t:g}/{d:g}" for t, d in document["exact_front"])
    proof = "complete, proven" if document["exact_front_complete"] else "not proven complete"
    text += ["", f"Exact front (makespan/difficulty; {proof}): {points}.", ""]
    text += [_noise(row) for row in document["summary"] if row["noise_helps"]]
    text += [_other(row) for row in document["other_cells"]]
    return "\n".join([*text, "", *_display(document["display"])])


HEAD = (
    "factor",
    "method",
    "makespan, s",
    "difficulty",
    "cost above the exact (at most)",
    f"within {WITHIN:.0%}",
    "cost beside a noisy human",
    "finished after a change",
    "loss after a change",
)


def _arm(row: Mapping[str, Any]) -> str:
    return _line(
        f"{row['factor']:g}",
        row["arm"],
        _mean(row["makespan"]),
        _mean(row["difficulty"]),
        f"{_mean(row['gap'], 100)} % ({100 * row['largest_gap']:.1f} %)",
        f"{row['within']} of {row['seeds']}",
        f"{_mean(row['noisy_cost'])} (+{100 * row['noisy_gap']['mean']:.1f} %)",
        f"{row['changed_finished']} of {row['changed_episodes']}",
        f"{_mean(row['loss'], 100)} % of {row['losses']}",
    )


def _random(factor: str, chance: Mapping[str, float], best: float) -> str:
    above, noisy = (100 * (chance[name] / best - 1) for name in ("cost", "noisy_cost"))
    finished = f"{chance['changed_finished']} of {chance['changed_episodes']}"
    plain = f"{chance['makespan']:.1f}", f"{chance['difficulty']:.1f}", f"{above:.1f} %"
    return _line(
        factor,
        "random player",
        *plain,
        "",
        f"{chance['noisy_cost']:.1f} (+{noisy:.1f} %)",
        finished,
    )


def _display(guide: Mapping[str, Any]) -> list[str]:
    from tandem.lab.zhang2022.runs import alternator

    cell, change = alternator(), guide["change"]
    return [
        (
            f"What the human is shown ({guide['arm']}, factor {guide['factor']:g}, seed"
            f" {guide['seed']}); as data under `display` with --json:"
        ),
        "",
        *[f"    {line}" for line in lines(cell, guide["shown"])],
        "",
        (
            f"And when at {change['at']:g} s {change['happened']}:"
            if change["happened"]
            else "And in an assembly with a change that came to nothing:"
        ),
        "",
        *[f"    {line}" for line in lines(cell, change["shown"])],
    ]


def _noise(row: Mapping[str, Any]) -> str:
    helps, recipe = row["noise_helps"], row["arm"].split(",")[0]
    half = "" if helps["ci95"] is None else f" ± {helps['ci95']:.2f}"
    shows = helps["ci95"] is not None and abs(helps["mean"]) > helps["ci95"]
    return (
        f"- Noise in training, {recipe}, factor {row['factor']:g}: beside a noisy human it saves"
        f" {helps['mean']:.2f}{half} of cost, seed by seed"
        f" ({'a difference' if shows else 'no difference'} at 95 %)."
    )


def _other(row: Mapping[str, Any]) -> str:
    gaps = row["gaps"]
    return (
        f"- On another cell, {row['cell']} ({row['tasks']} tasks), ours without noise:"
        f" {sum(gap == 0 for gap in gaps)} of {len(gaps)} seeds meet the exact point"
        f" {row['matching'][0]:g}/{row['matching'][1]:g}, mean gap {sum(gaps) / len(gaps):.2%},"
        f" largest {max(gaps):.2%}."
    )


def _line(*cells: str) -> str:
    return "| " + " | ".join([*cells, *[""] * (len(HEAD) - len(cells))]) + " |"


def _mean(value: Mapping[str, float | None], times: float = 1.0) -> str:
    if value["mean"] is None:
        return "-"
    half = "" if value["ci95"] is None else f" ± {value['ci95'] * times:.1f}"
    return f"{value['mean'] * times:.1f}{half}"
