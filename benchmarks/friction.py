"""What `scarid identify --friction auto` chooses: `python benchmarks/friction.py`.

A robot with friction that its description lacks is identified from 20 s, with and without
`--friction auto`, and judged on another motion: the median relative error of the predicted torques,
the largest of all joints, and in how many of the logs anything was chosen beside what `identify`
fits anyway.
"""

from __future__ import annotations

import argparse

import numpy as np

import scarid

CONDITIONS: dict[str, tuple[str, ...]] = {
    "clean": (),
    "asymmetric Coulomb, 20 %": ("friction-asymmetry=0.2",),
    "Stribeck": ("stribeck=0.1,0.05",),
    "load-dependent, 3 %": ("load-friction=0.03",),
    "ripple": ("ripple=0.1,0.02", "ripple-cycles=5"),
    "load-dependent and Stribeck": ("load-friction=0.03", "stribeck=0.1,0.05"),
    "asymmetric and load-dependent": ("friction-asymmetry=0.2", "load-friction=0.03"),
    "asymmetric and ripple": ("friction-asymmetry=0.2", "ripple=0.1,0.02", "ripple-cycles=5"),
    "flexible joints of 25 Hz": ("flexibility=25",),
}


def log(seed: int, imperfections: tuple[str, ...]) -> scarid.Log:
    reference = scarid.trajgen(seed=seed, robot="scara2")
    return scarid.simulate(reference, seed=seed, robot="scara2", with_=imperfections)


def error(known: scarid.Judged, other: scarid.Log) -> float:
    """The relative error [%] of the torques of another log, of the worst joint."""
    metrics = scarid.validate(other, parameters=known, robot="scara2").to_arrow()
    return float(np.max(metrics.column("relative_error").to_numpy()))


def row(name: str, seeds: int) -> str:
    errors, chosen = [], 0
    for seed in range(seeds):
        first, other = (log(s + seed, CONDITIONS[name]) for s in (1000, 2000))
        plain = scarid.identify(first, robot="scara2")
        auto = scarid.identify(first, robot="scara2", friction="auto")
        errors.append((error(plain, other), error(auto, other)))
        chosen += any(x["kept"] for x in auto.meta.extra["friction"])
    before, after = np.median(errors, axis=0)
    return f"| {name} | {before:.2g} % | {after:.2g} % | {chosen} of {seeds} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    given = parser.parse_args()
    print("| friction beside that of the robot | without | with auto | something chosen |")
    print("|---|---|---|---|")
    for name in CONDITIONS:
        print(row(name, given.seeds), flush=True)


if __name__ == "__main__":
    main()
