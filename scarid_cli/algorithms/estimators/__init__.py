"""Estimators: each module of this folder is one choice of `scarid identify --estimator`.

A module defines `Estimator`, a frozen dataclass of settings, with

- `init(prior)`: the state before the first row, given initial parameters;
- `step(state, rows, trace)`: the state after these rows, and the estimates after each sample if
  wanted;
- `fit(state)`: the estimates and what is known of their errors;
- `RECURSIVE`: whether there is an estimate after every sample;
- `HOLDS`: whether the state is all rows so far;
- `for_robot(robot, h)`, where an estimator needs to know the robot and the sampling period.
"""
