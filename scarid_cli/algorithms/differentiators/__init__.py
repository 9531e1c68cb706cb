"""Differentiators: each module of this folder is one method of `scarid differentiate`.

A module defines `Differentiator`, a frozen dataclass of settings for one joint, with

- `init(q, h)`: the state before the first position q [rad or m], sampled every h [s];
- `step(state, q)`: the state after the positions q, and the velocities [1/s] and accelerations
  [1/s2] of the samples that are settled by then;
- `finish(state)`: those of the last `LAG` samples, once there are no more;
- `LAG`: by how many samples the output of a row has to wait;
- `matched()`, if it has one: the phase-matched form (see `recursion.Matched`);
- `PRESETS`: named settings (`table1`: as printed in the paper).
"""
