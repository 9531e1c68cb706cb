"""Running sums for the quality of a prediction, one sample at a time (Welford 1962)."""


def accumulate(measured, predicted, state):
    """Add the samples of one joint to the sums.

    state: the count, the mean of measured, the sum of its squares about the mean, the sum of
    squared errors, and the sum of squares of measured; changed in place.
    """
    if len(predicted) != len(measured) or len(state) != 5:
        raise ValueError("moments: lengths differ")
    count, mean, about = float(state[0]), float(state[1]), float(state[2])
    errors, squares = float(state[3]), float(state[4])
    for k in range(len(measured)):
        x = float(measured[k])
        error = x - float(predicted[k])
        count += 1.0
        delta = x - mean
        mean += delta / count
        about += delta * (x - mean)
        errors += error * error
        squares += x * x
    state[0], state[1], state[2], state[3], state[4] = count, mean, about, errors, squares
