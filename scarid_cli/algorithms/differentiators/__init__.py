"""Differentiators: each module of this folder is one method of `scarid differentiate`.

A module defines `Differentiator`, a frozen dataclass of settings for one joint, which derives from
`processes.method.Method`. That base class says what a method has to define and what it may declare.
Bases for the usual families leave little to write:

- `filters.sliding.SlidingMode`: a recursion with a nonlinear law;
- `filters.convolution.FirMethod`: two FIR filters and the low-pass they are differences of;
- `filters.observer.ObserverMethod`: an observer of constant gain in the Kalman kernel;
- `filters.kalman_method.KalmanMethod`: a Kalman filter or smoother;
- `processes.records.RecordMethod`: a smoother of the whole record;
- `processes.linearised.LinearisedMethod`: any method that is nearly linear.

The docstring of the module is what `scarid methods NAME` prints. It says what the method
does, its source, its class (causal, fixed lag or whole record), its delay, how it is matched and
how to choose its settings, and describes each setting in a line `name = default [unit]: ...`.
"""
