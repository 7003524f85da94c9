"""The house in numbers: its rooms, how they stand on each other, and how dense the code is.

    python3 dev.py house            this tree
    python3 dev.py house FOLDER     that tree (another checkout) beside this one: before, now

Everything is read from the files under `src/tandem`; nothing of Tandem is imported or run.
"""

from __future__ import annotations

import ast
import io
import sys
import tokenize
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any

import grimp

ROOT = Path(__file__).resolve().parents[1]
WIDTH, MANY, SAME = 100, 10, 6
"""Columns a line may have, branches a function may have, lines in a row that make a duplicate."""
LAYOUT = {
    tokenize.ENCODING,
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}
"""Tokens that carry no code."""
BRANCHES = (ast.If, ast.IfExp, ast.For, ast.While, ast.ExceptHandler, ast.match_case)


@dataclass(frozen=True)
class Source:
    """One file of the package."""

    room: str
    text: str

    @cached_property
    def lines(self) -> list[str]:
        return self.text.splitlines()

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text)

    @cached_property
    def code_lines(self) -> list[int]:
        """The line of each token of code; a docstring is none."""
        words = {
            node.value.lineno
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        }
        found = tokenize.generate_tokens(io.StringIO(self.text).readline)
        return [
            token.start[0]
            for token in found
            if token.type not in LAYOUT
            and not (token.type == tokenize.STRING and token.start[0] in words)
        ]

    def branches(self) -> Iterator[int]:
        """Of each function: decisions in it, those of what is nested included."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield sum(map(_decisions, ast.walk(node)))

    def plain_lines(self) -> list[str]:
        """The code as `ast` writes it, whatever its layout was, without imports and docstrings."""
        written = ast.unparse(self.tree).splitlines()
        return [
            line.strip()
            for line in written
            if line.strip() and not line.strip().startswith(("import ", "from ", '"""', "'"))
        ]


def _decisions(node: ast.AST) -> int:
    if isinstance(node, ast.BoolOp):
        return len(node.values) - 1
    if isinstance(node, ast.comprehension):
        return 1 + len(node.ifs)
    return int(isinstance(node, BRANCHES))


def sources(root: Path) -> list[Source]:
    """Every module under `src/tandem`. The face of the package itself is a room, too."""
    home = root / "src" / "tandem"
    files = sorted(home.rglob("*.py"))
    return [
        Source(path.relative_to(home).parts[0].removesuffix(".py"), path.read_text("utf-8"))
        for path in files
    ]


# --- How the rooms stand on each other ---

Graph = dict[str, set[str]]


def import_graph(root: Path) -> Graph:
    """Module -> the modules of Tandem that it imports, deferred and type-only imports too."""
    sys.path.insert(0, str(root / "src"))
    try:
        graph: Any = grimp.build_graph("tandem", cache_dir=None)
    finally:
        sys.path.pop(0)
    return {name: graph.find_modules_directly_imported_by(name) for name in graph.modules}


def of_rooms(graph: Mapping[str, set[str]]) -> Graph:
    """The same between rooms."""
    found: Graph = defaultdict(set)
    for module, imported in graph.items():
        found[room_of(module)] |= {room_of(name) for name in imported} - {room_of(module)}
    return dict(found)


def room_of(module: str) -> str:
    return [*module.split("."), "__init__"][1]


def circles(graph: Mapping[str, set[str]]) -> list[list[str]]:
    """The groups of more than one in which everybody leads to everybody (Tarjan 1972)."""
    found, index, low, stack = [], dict[str, int](), dict[str, int](), list[str]()

    def visit(name: str) -> None:
        index[name] = low[name] = len(index)
        stack.append(name)
        for other in graph[name]:
            if other not in index:
                visit(other)
            if other in stack:
                low[name] = min(low[name], low[other])
        if low[name] == index[name]:
            place = stack.index(name)
            group = stack[place:]
            del stack[place:]
            found.append(sorted(group))

    for name in sorted(graph):
        if name not in index:
            visit(name)
    return [group for group in found if len(group) > 1]


def floors(graph: Graph) -> int:
    """How many rooms stand on each other at the most; rooms of a circle are on one floor."""
    same = {name: group[0] for group in circles(graph) for name in group}
    merged: Graph = defaultdict(set)
    for name, others in graph.items():
        here = same.get(name, name)
        merged[here] |= {same.get(other, other) for other in others} - {here}
    height: dict[str, int] = {}

    def of(name: str) -> int:
        if name not in height:
            height[name] = 1 + max(map(of, merged[name]), default=0)
        return height[name]

    return max(map(of, list(merged)))


# --- What stands twice ---


def duplicates(files: Sequence[Source]) -> int:
    """Pairs of places that share so many lines of code or more, to the letter."""
    texts = [file.plain_lines() for file in files]
    places: dict[tuple[str, ...], list[tuple[int, int]]] = defaultdict(list)
    for number, lines in enumerate(texts):
        for start in range(len(lines) - SAME + 1):
            places[tuple(lines[start : start + SAME])].append((number, start))
    pairs = {
        pair
        for found in places.values()
        for pair in combinations(found, 2)
        if pair[0][0] != pair[1][0] or abs(pair[0][1] - pair[1][1]) >= SAME
    }
    # A longer run is one pair: it counts where it begins.
    return sum(
        ((first[0], first[1] - 1), (second[0], second[1] - 1)) not in pairs
        for first, second in pairs
    )


# --- The tables ---


def measures(root: Path) -> dict[str, str]:
    """What is measured -> the figure, in words."""
    files, graph = sources(root), import_graph(root)
    lines = [line for file in files for line in file.lines]
    tokens = [(number, line) for number, file in enumerate(files) for line in file.code_lines]
    branches = [count for file in files for count in file.branches()]
    wide = sum(len(line) > WIDTH for line in lines)
    many = sum(count > MANY for count in branches)
    ring = circles(graph)
    return {
        "modules": f"{len(files):,}",
        "lines": f"{len(lines):,}",
        "tokens of code": f"{len(tokens):,}",
        "tokens a line of code": f"{len(tokens) / len(set(tokens)):.1f}",
        f"lines over {WIDTH} columns": f"{wide:,} ({wide / len(lines):.1%})",
        "functions": f"{len(branches):,}",
        f"functions over {MANY} branches": f"{many} ({many / len(branches):.1%})",
        f"pairs of places with the same {SAME} lines or more": f"{duplicates(files)}",
        "rooms": f"{len(of_rooms(graph))}",
        "floors of rooms": f"{floors(of_rooms(graph))}",
        "circles of modules": f"{len(ring)}",
        "modules in circles": f"{sum(map(len, ring))}",
    }


def rooms(root: Path) -> dict[str, list[int]]:
    """Room -> its modules, lines and tokens of code."""
    found: dict[str, list[int]] = {}
    for file in sources(root):
        counts = (1, len(file.lines), len(file.code_lines))
        found[file.room] = [
            old + new for old, new in zip(found.get(file.room, [0] * 3), counts, strict=True)
        ]
    return found


def room_table(trees: Mapping[str, Path]) -> str:
    """The rooms of all trees, those with the most lines first."""
    found = [rooms(root) for root in trees.values()]
    none = [0, 0, 0]
    names = sorted(
        {room for tree in found for room in tree},
        key=lambda room: max(tree.get(room, none)[1] for tree in found),
        reverse=True,
    )
    head = [f"{what}, {when}" for when in trees for what in ("modules", "lines", "tokens")]
    rows = [
        [
            room,
            *(f"{count:,}" if count else "-" for tree in found for count in tree.get(room, none)),
        ]
        for room in names
    ]
    return table(["room", *head], rows)


def measure_table(trees: Mapping[str, Path]) -> str:
    """What is measured, each tree a column."""
    figures = [measures(root) for root in trees.values()]
    rows = [[what, *(tree[what] for tree in figures)] for what in figures[-1]]
    return table(["measure", *trees], rows)


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown: columns as wide as they must be, figures to the right."""
    widths = [max(len(row[place]) for row in (head, *rows)) for place in range(len(head))]

    def line(cells: Sequence[str]) -> str:
        first, *others = cells
        padded = [text.rjust(wide) for text, wide in zip(others, widths[1:], strict=True)]
        return f"| {' | '.join([first.ljust(widths[0]), *padded])} |"

    ruler = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
    return "\n".join(map(line, (head, ruler, *rows)))


def main(arguments: Sequence[str]) -> int:
    trees = {"before": Path(arguments[0])} if arguments else {}
    trees["now"] = ROOT
    if lost := [root for root in trees.values() if not (root / "src" / "tandem").is_dir()]:
        print(f"house: {lost[0]} has no src/tandem; name a checkout's folder.", file=sys.stderr)
        return 2
    print(room_table(trees), measure_table(trees), sep="\n\n")
    for when, root in trees.items():
        for group in circles(import_graph(root)):
            print(f"\ncircle, {when}: {', '.join(group)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
