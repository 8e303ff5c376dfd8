def network(weights, inputs):
    """Returns the output of a network: an affine map of its scaled inputs plus weighted products of their powers."""
    scalings, bias, slopes, units, is_ramp = weights
    total = bias
    logarithms = []
    for (gain, offset, low, high), slope, value in zip(scalings, slopes, inputs):
        x = min(max(value * gain + offset, low), high)
        total += slope * x
        logarithms.append(log(x))
    for exponents, output in units:
        power = 0.0
        for exponent, logarithm in zip(exponents, logarithms):
            power += exponent * logarithm
        total += output * exp(power)
    return min(max(total, 0.0), 1.0) if is_ramp else total
