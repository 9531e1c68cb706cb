"""One column through a process: the interface, phase matching, measured delays, resampling."""
