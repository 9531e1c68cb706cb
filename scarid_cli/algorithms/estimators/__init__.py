"""Estimators: each module of this folder is one choice of `scarid identify --estimator`.

A module defines `Estimator`, a frozen dataclass of settings, with

- `init(prior)`: the state before the first row, given initial parameters;
- `step(state, W, y, trace)`: the state after the rows of the regressor W (samples, joints,
  parameters) and the torques y (samples, joints), and the estimates after each sample if wanted;
- `fit(state)`: the estimates and what is known of their errors;
- `RECURSIVE`: whether there is an estimate after every sample.
"""
