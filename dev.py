#!/usr/bin/env python3
"""Everything a developer does here, on a bare Python 3.11, 3.12 or 3.13 with pip.

    python3 dev.py run              plan the example cell and train on it: front, Gantt, a report
    python3 dev.py run ARGUMENTS    the command itself: run plan my-cell.yaml
    python3 dev.py test             format, lint, types, import rules, docs, tests
    python3 dev.py test --changed   only the tests that what you changed since the last commit can
                                    break, or since COMMIT; nearest first, for two minutes, or
                                    --within SECONDS
    python3 dev.py test --torch     a short look at what needs PyTorch, which is large and installed
                                    for this alone; ends with 3 where it cannot be
    python3 dev.py test ARGUMENTS   pytest alone, with these arguments
    python3 dev.py lint             all of `test` that is not a test
    python3 dev.py fix              mend what ruff can mend: format and simple findings
    python3 dev.py docs             build the documentation into docs/_build/html
    python3 dev.py bench [NAME ...] list the benchmarks, or run one with its arguments
    python3 dev.py house [FOLDER]   rooms, lines, circles and density of the code; beside another
                                    checkout's
    python3 dev.py fuzz [NAME ...]  list the fuzzing programs, or run one: random inputs until
                                    something differs
    python3 dev.py clean [--all]    remove what tools left behind; with --all also .venv

What is needed is installed into .venv the first time, and again when pyproject.toml or
constraints.txt change. Only the standard library is used here.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
BIN = VENV / ("Scripts" if os.name == "nt" else "bin")
PYTHON = BIN / ("python.exe" if os.name == "nt" else "python")
STATE = VENV / "tandem-install.json"
LOG = VENV / "tandem-install.log"
REPORT = ROOT / "tandem-out" / "thesis.html"
LEARNED = ROOT / "tandem-out" / "thesis-run"
LEFTOVERS = (
    ".pytest_cache",
    ".mypy_cache",
    ".ruff_cache",
    ".import_linter_cache",
    ".hypothesis",
    "build",
    "dist",
    "docs/_build",
    "tandem-out",
)
FORMATTED = ("src", "tests", "docs", "examples", "benchmarks", "dev.py")

# ---------------------------------------------------------------- installing


def say(text: str) -> None:
    print(f"dev.py: {text}", file=sys.stderr, flush=True)


def environment() -> dict[str, str]:
    """The caller's environment without what would lead an install or an import elsewhere, or would
    have every process compile our modules anew: that is half a second for each command.
    """
    kept = {
        k: v
        for k, v in os.environ.items()
        if k
        not in (
            "PYTHONHOME",
            "PYTHONPATH",
            "PYTHONDONTWRITEBYTECODE",
            "PIP_USER",
            "PIP_TARGET",
            "PIP_PREFIX",
            "VIRTUAL_ENV",
        )
    }
    return kept | {
        "PIP_DISABLE_PIP_VERSION_CHECK": "1",
        "PATH": f"{BIN}{os.pathsep}{os.environ.get('PATH', os.defpath)}",
    }


def fingerprint() -> str:
    """Changes when something does that makes the environment stale: what is asked for, this Python,
    or where we are.
    """
    facts = [(ROOT / name).read_bytes() for name in ("pyproject.toml", "constraints.txt")]
    return hashlib.sha256(
        b"\0".join([*facts, sys.version.encode(), str(ROOT).encode()])
    ).hexdigest()


def install(*extras: str) -> None:
    """Makes .venv hold Tandem (editable) with at least these extras; does nothing when it already
    does.
    """
    if not (3, 11) <= sys.version_info[:2] <= (3, 13):
        raise SystemExit(
            f"dev.py: this is Python {sys.version.split()[0]}; use 3.11, 3.12 or 3.13 (OR-Tools"
            " 9.14 has no build for others)."
        )
    state = installed()
    known, wanted = set(state.get("extras", ())), set(extras)
    if state.get("done") == fingerprint() and wanted <= known and PYTHON.exists():
        return
    if state and not state.get("done"):
        say("the last installation was interrupted: starting afresh.")
        shutil.rmtree(VENV)
    elif state and (state["python"], state["root"]) != (sys.version, str(ROOT)):
        say("this folder or the Python was another one: starting afresh.")
        shutil.rmtree(VENV)
    begun = time.monotonic()
    if not (
        PYTHON.exists()
        and subprocess.run([str(PYTHON), "-m", "pip", "--version"], capture_output=True).returncode
        == 0
    ):
        create()
    wanted |= known
    note = {"extras": sorted(wanted), "python": sys.version, "root": str(ROOT)}
    write_state(note)  # no "done": whoever comes next knows that this was interrupted
    what = f".[{','.join(sorted(wanted))}]" if wanted else "."
    pip("install", "--progress-bar", "off", "-c", "constraints.txt", "-e", what)
    write_state(note | {"done": fingerprint()})
    say(
        f"installed {what.replace('.', 'tandem', 1)} into .venv in"
        f" {time.monotonic() - begun:.0f} s."
    )


def installed() -> dict:
    """What the last installation noted; empty when there was none."""
    try:
        return json.loads(STATE.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def write_state(note: dict) -> None:
    part = STATE.with_suffix(".part")
    part.write_text(json.dumps(note, indent=1), encoding="utf-8")
    part.replace(STATE)


def create() -> None:
    """A new virtual environment. Some systems split off `ensurepip`; then the pip that is there
    fills it.
    """
    base = getattr(sys, "_base_executable", None) or sys.executable
    say("creating .venv")
    made = subprocess.run(
        [base, "-m", "venv", "--clear", str(VENV)], capture_output=True, text=True
    )
    if made.returncode == 0:
        return
    bare = subprocess.run(
        [base, "-m", "venv", "--clear", "--without-pip", str(VENV)], capture_output=True, text=True
    )
    if bare.returncode == 0:
        bare = subprocess.run(
            [base, "-m", "pip", "--python", str(PYTHON), "install", "-q", "pip"],
            capture_output=True,
            text=True,
        )
    if bare.returncode:
        shutil.rmtree(VENV, ignore_errors=True)
        raise SystemExit(
            f"dev.py: cannot create .venv.\n{made.stdout}{made.stderr}{bare.stderr}Install the"
            " system's package for Python's venv module."
        )


def pip(*arguments: str) -> None:
    """Runs pip in .venv: its log goes to a file, one line that changes to the terminal, and the end
    of the log when it fails.
    """
    live, begun = sys.stderr.isatty(), time.monotonic()
    if not live:
        say("installing; the log is .venv/tandem-install.log")
    with LOG.open("w", encoding="utf-8") as log:
        process = subprocess.Popen(
            [str(PYTHON), "-m", "pip", *arguments],
            cwd=ROOT,
            env=environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert process.stdout
        for line in process.stdout:
            log.write(line)
            if live:
                print(
                    f"\r\033[Kinstalling, {time.monotonic() - begun:.0f} s: {line.strip()[:60]}",
                    end="",
                    file=sys.stderr,
                    flush=True,
                )
    if live:
        print("\r\033[K", end="", file=sys.stderr)
    if process.wait():
        tail = LOG.read_text(encoding="utf-8").splitlines()[-25:]
        raise SystemExit(
            "\n".join(
                [
                    *tail,
                    (
                        f"dev.py: pip ended with {process.returncode}; all it said is in"
                        " .venv/tandem-install.log."
                    ),
                ]
            )
        )


# ---------------------------------------------------------------- verbs


def call(*command: str | Path) -> int:
    return subprocess.run([str(part) for part in command], cwd=ROOT, env=environment()).returncode


def run(arguments: Sequence[str]) -> int:
    """The main job: the proven front of the thesis cell, and beside it what is learned there by
    trial and error.
    """
    install(*(["studio"] if arguments[:1] == ["studio"] else []))
    if arguments:
        return subprocess.run([str(BIN / "tandem"), *arguments], env=environment()).returncode
    REPORT.parent.mkdir(exist_ok=True)
    cell, report, kept = (
        Path("examples", "thesis.yaml"),
        REPORT.relative_to(ROOT),
        LEARNED.relative_to(ROOT),
    )
    if ended := shown("plan", cell, "--report", report):
        return ended
    install("learn")
    shutil.rmtree(LEARNED, ignore_errors=True)
    return shown("train", cell, "--stress-factor", "5", "--run", kept) or shown(
        "evaluate", kept, "--report", report
    )


def shown(*arguments: str | Path) -> int:
    """Runs a command of ours and says which one it is, so that it can be typed again."""
    say(f"{BIN.relative_to(ROOT) / 'tandem'} {' '.join(map(str, arguments))}")
    return call(BIN / "tandem", *arguments)


def checks() -> dict[str, list[str | Path]]:
    """Everything that is looked at without being run."""
    there = [name for name in FORMATTED if (ROOT / name).exists()]
    return {
        "format": [BIN / "ruff", "format", "--check", *there],
        "lint": [BIN / "ruff", "check", *there],
        "types": [BIN / "mypy"],
        "imports": [BIN / "lint-imports", "--no-cache"],
        "docs": [
            PYTHON,
            "-m",
            "sphinx",
            "-W",
            "--keep-going",
            "-q",
            "-b",
            "html",
            "docs",
            "docs/_build/html",
        ],
    }


def look() -> list[str]:
    """Runs the checks side by side and prints what they found. Returns the names of those that
    failed.
    """

    def one(
        item: tuple[str, list[str | Path]],
    ) -> tuple[str, subprocess.CompletedProcess[str], float]:
        begun = time.monotonic()
        done = subprocess.run(
            [str(part) for part in item[1]],
            cwd=ROOT,
            env=environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        return item[0], done, time.monotonic() - begun

    failed = []
    with ThreadPoolExecutor(max_workers=min(4, os.cpu_count() or 1)) as pool:
        for name, done, seconds in pool.map(one, checks().items()):
            print(
                f"{name:8} {'ok' if done.returncode == 0 else 'FAILED':6} {seconds:5.1f} s",
                flush=True,
            )
            if done.returncode:
                failed.append(name)
                print(done.stdout, flush=True)
    return failed


def lint(_: Sequence[str]) -> int:
    install("dev", "learn", "studio")
    return 1 if look() else 0


def fix(_: Sequence[str]) -> int:
    install("dev", "learn", "studio")
    there = [name for name in FORMATTED if (ROOT / name).exists()]
    call(BIN / "ruff", "check", "--fix", "--quiet", *there)
    return call(BIN / "ruff", "format", *there)


def test(arguments: Sequence[str]) -> int:
    install("dev", "learn", "studio")
    side_by_side = ("-q", "-n", "auto", "--dist", "loadfile", "--no-loadscope-reorder")
    if arguments and arguments[0].startswith("--changed"):
        return call(PYTHON, "-m", "pytest", *side_by_side, *arguments)
    if arguments == ["--torch"]:
        return look_at_torch()
    if arguments:
        return call(PYTHON, "-m", "pytest", *arguments)
    failed = look()
    ended = call(PYTHON, "-m", "pytest", *side_by_side, "--durations", "25")
    if failed:
        print(f"failed before the tests: {', '.join(failed)} (see above)", flush=True)
    return ended or (1 if failed else 0)


def look_at_torch() -> int:
    """Foreign learners and their checker on our environments; the long trainings are left out."""
    try:
        install("sb3")
    except SystemExit as failed:
        print(failed, file=sys.stderr)
        say("PyTorch could not be installed here: the tests that need it did not run.")
        return 3
    return call(PYTHON, "-m", "pytest", "-q", "tests/envs", "-k", "sb3", "-m", "not slow")


def docs(_: Sequence[str]) -> int:
    install("docs")
    ended = call(*checks()["docs"])
    if ended == 0:
        say("built docs/_build/html/index.html")
    return ended


def programs(folder: str) -> dict[str, Path]:
    """What can be started in this folder, by name."""
    return {
        path.stem: path
        for path in sorted((ROOT / folder).glob("*.py"))
        if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
    }


def choose(verb: str, folder: str, arguments: Sequence[str]) -> tuple[Path | None, int]:
    """The program named first, or None and how to end: the list was asked for (0), or there is no
    such program (2).
    """
    there = programs(folder)
    if not arguments:
        for name, path in there.items():
            print(
                f"python3 dev.py {verb} {name:14}"
                f" {path.read_text(encoding='utf-8').splitlines()[0].strip(chr(34))}"
            )
        return None, 0
    if arguments[0] not in there:
        say(f"{verb}: nothing is called {arguments[0]!r}; there are {', '.join(there) or 'none'}.")
        return None, 2
    return there[arguments[0]], 0


def bench(arguments: Sequence[str]) -> int:
    program, ended = choose("bench", "benchmarks", arguments)
    if program is None:
        return ended
    install("bench", "learn")
    return call(PYTHON, program.relative_to(ROOT), *arguments[1:])


def fuzz(arguments: Sequence[str]) -> int:
    program, ended = choose("fuzz", "tests/fuzz", arguments)
    if program is None:
        return ended
    install("dev", *(["choco"] if program.stem == "choco" else []))
    return call(PYTHON, "-m", f"tests.fuzz.{program.stem}", *arguments[1:])


def house(arguments: Sequence[str]) -> int:
    install("dev")
    return call(PYTHON, "-m", "tests.house", *arguments)


def clean(arguments: Sequence[str]) -> int:
    if "--all" in arguments and (STATE.exists() or not VENV.exists()):
        shutil.rmtree(VENV, ignore_errors=True)
    elif "--all" in arguments:
        say(".venv was not made here; it stays.")
    for name in LEFTOVERS:
        shutil.rmtree(ROOT / name, ignore_errors=True)
    for folder in ("src", "tests", "docs", "benchmarks"):
        for cache in (ROOT / folder).rglob("__pycache__"):
            shutil.rmtree(cache, ignore_errors=True)
    return 0


VERBS: dict[str, Callable[[Sequence[str]], int]] = {
    "run": run, "test": test, "lint": lint, "fix": fix, "docs": docs, "bench": bench,
    "house": house, "fuzz": fuzz, "clean": clean
}  # fmt: skip


def main(arguments: Sequence[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(__doc__)
        return 0
    if arguments[0] not in VERBS:
        say(f"no verb is called {arguments[0]!r}; there are {', '.join(VERBS)}.")
        return 2
    return VERBS[arguments[0]](arguments[1:])


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
