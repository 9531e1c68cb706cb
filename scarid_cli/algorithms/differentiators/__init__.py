"""Differentiators: each module of this folder is one method of `scarid differentiate`.

A module defines `Differentiator`, a frozen dataclass of settings for one joint, with

- `lag(h)`: by how many samples the output of a row has to wait, sampled every h [s]; inf for the
  whole record;
- `init(x, h)`: the state before the first position x [rad or m];
- `step(state, x)`: the state after the positions x, and the velocities [1/s] and accelerations
  [1/s2] of the samples that are settled by then;
- `finish(state)`: those of the last `lag` samples, once there are no more;
- `matched()`: the phase-matched form (see `process.Matched`);
- `fitted(x, h)`, if it tunes itself: the method for a whole record x of positions;
- `PRESETS`: named settings (`table1`: as printed in the paper);
- `TUNED`: where `scarid tune` looks for which settings.
"""
