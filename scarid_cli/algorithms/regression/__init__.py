"""The regression tau = W theta (paper eq. 25): its rows, their decimation, and its solution."""
