"""Estimators: each module of this folder is one choice of `scarid identify --estimator`.

A module defines `Estimator`, a frozen dataclass of settings below `BaseEstimator`, or below
`HoldingEstimator` if it needs all rows at once (see `regression/estimation.py` for what each has to
declare and to do). The module's docstring is what `scarid identify --help` prints: what the
estimator does, its source, and a line for each setting with its default.
"""
