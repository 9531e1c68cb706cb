"""`make mutants`: do the tests notice a change of a single operator?

A seeded sample of changes to scarid_cli outside the kernels, as many of each kind: comparisons,
signs, and/or, not, constants by one, calls and raises left out, slices off by one. Each is made in
a copy of the tree in build/mutants, and the tests that reach its line are run, those that reach
least first, until one fails. What passes all of them is an equivalent change, or something that
no test holds.

The first run records which tests reach which line (benchmarks/reached.py), which is one run of
tests/unit, tests/stages and tests/cli. Outcomes are kept: a run that was stopped goes on.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import zip_longest
from pathlib import Path

import reached
from mutations import Mutation, lines_of, mutations
from trials import NOTICED, Outcome, Trials

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "build" / "mutants"

# Changes that once passed all tests: a file, its text, and the changed text.
FORMER = (
    ("scarid_cli/io/reader.py", "table.row(row + at + 1)", "table.row(row + at)"),
    ("scarid_cli/io/reader.py", "row += batch.num_rows", "row -= batch.num_rows"),
    (
        "scarid_cli/cli/actions/filter.py",
        "CUTOFF_PER_NATURAL_FREQUENCY = 10.0",
        "CUTOFF_PER_NATURAL_FREQUENCY = 11.0",
    ),
    ("scarid_cli/io/csvio.py", "if len(names) == 1 and (re.", "if len(names) == 2 and (re."),
    ("scarid_cli/io/csvio.py", 're.search(r"[;\\t]", names[0])', 're.search(r"[\\t]", names[0])'),
    ("scarid_cli/stages/identify.py", "holds or estimator.HOLDS", "holds and estimator.HOLDS"),
    ("scarid_cli/cli/actions/identify.py", "holds or method.HOLDS", "holds and method.HOLDS"),
)


@dataclass(frozen=True)
class Study:
    """The sample of changes, and the tree in which they are made."""

    tree: Path
    reached: reached.Reached
    breadth: dict[str, int]

    def sample(self, count: int, seed: int) -> list[Mutation]:
        """The former changes, and so many others, of each kind in turn."""
        kinds: dict[str, list[Mutation]] = {}
        for path in sorted(self.tree.glob("scarid_cli/**/*.py")):
            if "kernels" not in path.parts:
                name = str(path.relative_to(self.tree))
                for mutation in mutations(name, path.read_text("utf-8")):
                    kinds.setdefault(mutation.kind, []).append(mutation)
        rng = random.Random(seed)
        shuffled = [rng.sample(kinds[kind], len(kinds[kind])) for kind in sorted(kinds)]
        turns = (m for turn in zip_longest(*shuffled) for m in turn if m is not None)
        return [*self._former(), *(m for m, _ in zip(turns, range(count), strict=False))]

    def _former(self) -> Iterator[Mutation]:
        for file, old, new in FORMER:
            text = (self.tree / file).read_text("utf-8")
            assert text.count(old) == 1, (file, old)
            start = text.index(old)
            line = text.count("\n", 0, start) + 1
            yield Mutation(file, line, start, start + len(old), old, new, "former")

    def control(self) -> Mutation:
        """No change at all, which every test must pass."""
        return Mutation("scarid_cli/io/csvio.py", 1, 0, 0, "", "", "none")

    def tests(self, mutation: Mutation) -> list[str]:
        """The tests that reach the change, the likeliest to notice first.

        What is evaluated at import is reached by every test that reaches its module.
        """
        lines = lines_of((self.tree / mutation.file).read_text("utf-8"), mutation.line)
        found = set().union(*(self.reached.by(mutation.file, line) for line in lines or ()))
        if lines is None:
            found = self.reached.module(mutation.file)
        taken, breadth = self.reached.taken, self.breadth
        return sorted(found, key=lambda name: (taken[name] + 0.05) * breadth[name])


def main() -> None:
    parser = argparse.ArgumentParser(description="Do the tests notice a single changed operator?")
    parser.add_argument("--count", type=int, default=200, help="changes, beside former ones")
    parser.add_argument("--seed", type=int, default=16)
    parser.add_argument("--folder", type=Path, default=FOLDER)
    parser.add_argument("--seconds", type=float, default=300.0, help="of tests for a change")
    parser.add_argument("--again", action="store_true", help="try the survivors once more")
    given = parser.parse_args()
    folder = given.folder.resolve()
    study = _prepared(folder)
    trials = Trials(study.tree, study.reached.taken, given.seconds)
    if trials.outcome("", study.control(), list(study.reached.taken)[::500]).result != "survived":
        raise SystemExit(f"tests fail without any change: see {folder / 'log'}")
    results = folder / "outcomes.jsonl"
    known = _known(results, again=given.again)
    for mutation in study.sample(given.count, given.seed):
        if _name(mutation) not in known:
            outcome = trials.outcome(_name(mutation), mutation, study.tests(mutation))
            known[_name(mutation)] = outcome
            with results.open("a") as file:
                file.write(json.dumps(asdict(outcome)) + "\n")
            print(f"{outcome.result:<9} {outcome.seconds:5.0f} s  {_line(outcome)}", flush=True)
    page = _page(list(known.values()))
    (folder / "mutants.md").write_text(page)
    print(page)


def _prepared(folder: Path) -> Study:
    """A copy of the tree, and which tests reach its lines; recorded if that was not done yet."""
    tree, original = folder / "tree", folder / "original"
    if not (folder / "passed.json").exists():
        _copy(tree)
        shutil.rmtree(original, ignore_errors=True)
        shutil.copytree(tree / "scarid_cli", original / "scarid_cli")
        reached.record(folder, tree)
    # A run that was killed may have left a change.
    shutil.copytree(original, tree, dirs_exist_ok=True)
    found = reached.read(folder, tree)
    return Study(tree, found, found.breadth())


def _name(mutation: Mutation) -> str:
    return f"{mutation.file}:{mutation.line}:{mutation.start}:{mutation.new.strip()}"


def _known(results: Path, *, again: bool) -> dict[str, Outcome]:
    """The outcomes so far; the last of a change counts."""
    lines = results.read_text().splitlines() if results.exists() else []
    outcomes = (Outcome(**json.loads(line)) for line in lines)
    known = {outcome.name: outcome for outcome in outcomes}
    return {n: o for n, o in known.items() if o.result in NOTICED or not again}


def _copy(tree: Path) -> None:
    """The files of the project as they are now, with the compiled kernels."""
    shutil.rmtree(tree, ignore_errors=True)
    names = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True,
    ).stdout.split("\0")  # fmt: skip
    kernels = (str(p.relative_to(ROOT)) for p in ROOT.glob("scarid_cli/kernels/*.so"))
    for name in filter(None, [*names, *kernels]):
        if (ROOT / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tree / name)


def _line(outcome: Outcome) -> str:
    file, line, *_ = outcome.name.split(":")
    old, new = (" ".join(x.split()) or "nothing" for x in (outcome.old, outcome.new))
    return f"{file}:{line}  {outcome.kind}: `{old}` becomes `{new}`"


def _page(outcomes: Sequence[Outcome]) -> str:
    """Counts by kind, and each change that no test noticed."""
    lines = ["# Changes that the tests notice", "", "| kind | changes | noticed |", "|---|--:|--:|"]
    kinds = Counter(o.kind for o in outcomes)
    noticed = Counter(o.kind for o in outcomes if o.result in NOTICED)
    lines += [f"| {kind} | {kinds[kind]} | {noticed[kind]} |" for kind in sorted(kinds)]
    lines += [f"| all | {kinds.total()} | {noticed.total()} |", "", "Not noticed:", ""]
    lines += [f"- {_line(o)} ({o.tests} tests)" for o in outcomes if o.result not in NOTICED]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
