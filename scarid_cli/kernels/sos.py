"""Cascade of second-order sections in transposed direct form II."""


def filtered(x, y, state, sections):
    """Write the filtered x to y.

    sections: a row b0, b1, b2, a1, a2 for each section (a0 = 1). state: two numbers for each
    section; changed in place.
    """
    count = len(sections)
    if len(y) != len(x) or len(state) != count or state.shape[1] != 2 or sections.shape[1] != 5:
        raise ValueError("sos: lengths differ")
    for k in range(len(x)):
        u = float(x[k])
        for i in range(count):
            w = float(sections[i, 0]) * u + float(state[i, 0])
            state[i, 0] = float(sections[i, 1]) * u - float(sections[i, 3]) * w + float(state[i, 1])
            state[i, 1] = float(sections[i, 2]) * u - float(sections[i, 4]) * w
            u = w
        y[k] = u
