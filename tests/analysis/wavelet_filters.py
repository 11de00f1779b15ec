#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The wavelet filters of analysis/wavelets/filter_tables.h, derived anew by spectral factorisation.

  wavelet_filters.py          derives every db and sym filter and compares (standard library alone); compares all
                              filters with PyWavelets where python3-pywt is installed
  wavelet_filters.py --write  prints the header from PyWavelets' digits, after the same comparison

P(y) = Σ C(N−1+k, k) yᵏ, k < N, has N − 1 roots; each y = (2 − z − 1/z) / 4 gives a pair z, 1/z, of which a filter of
N vanishing moments takes one: db always the inner one, sym a choice that makes its phase nearly linear, recorded
below as published. Daubechies, Ten Lectures on Wavelets (1992), sections 6.1, 8.1.1. The moments of the coiflets
(8.2.2) determine them; filter_bank_test.cc has those."""
import math
import pathlib
import re
import sys

BITS = 256  # of the fixed-point numbers below
ONE = 1 << BITS
HEADER = pathlib.Path(__file__).resolve().parents[2] / "analysis/wavelets/filter_tables.h"
FAMILIES = {"db": ("kDaubechies", range(1, 21), 2), "sym": ("kSymlets", range(2, 21), 2),
            "coif": ("kCoiflets", range(1, 6), 6)}
# For each order of sym, over the groups of roots (a real one, or a conjugate pair) by rising |z|: 1 takes 1/z.
OUTER = {2: "0", 3: "0", 4: "01", 5: "10", 6: "101", 7: "100", 8: "0101", 9: "0110", 10: "10101", 11: "01100",
         12: "101010", 13: "001110", 14: "0011010", 15: "0011100", 16: "10011010", 17: "01110001",
         18: "101100101", 19: "001011100", 20: "1010011010"}
# Half a unit of the last digit of doubles for db and coif; sym as its digits were published.
TOLERANCE = {"db": 2e-16, "sym": 2e-11, "coif": 2e-16}


class Complex:
    """A complex number of BITS binary places."""

    def __init__(self, real, imag=0):
        self.real, self.imag = real, imag

    def __add__(self, other):
        return Complex(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other):
        return Complex(self.real - other.real, self.imag - other.imag)

    def __mul__(self, other):
        return Complex((self.real * other.real - self.imag * other.imag) >> BITS,
                       (self.real * other.imag + self.imag * other.real) >> BITS)

    def inverse(self):
        norm = self.real * self.real + self.imag * self.imag
        return Complex((self.real << 2 * BITS) // norm, -(self.imag << 2 * BITS) // norm)

    def norm(self):
        return (self.real * self.real + self.imag * self.imag) >> BITS

    def sqrt(self):
        size = math.isqrt(self.norm() << BITS)
        real = math.isqrt(max(0, (size + self.real) << (BITS - 1)))
        imag = math.isqrt(max(0, (size - self.real) << (BITS - 1)))
        return Complex(real, imag if self.imag >= 0 else -imag)


def evaluate(coefficients, at):
    value = Complex(0)
    for coefficient in reversed(coefficients):
        value = value * at + coefficient
    return value


def roots_of(coefficients):
    """Roots of Σ coefficients[k] yᵏ, all at once (Durand–Kerner), the last coefficient 1."""
    degree = len(coefficients) - 1
    start = Complex(ONE * 2 // 5, ONE * 9 // 25)
    roots = [Complex(ONE)]
    for _ in range(degree):
        roots.append(roots[-1] * start)
    roots = roots[1:]
    for _ in range(400):
        largest = 0
        for i in range(degree):
            product = Complex(ONE)
            for j in range(degree):
                if j != i:
                    product = product * (roots[i] - roots[j])
            step = evaluate(coefficients, roots[i]) * product.inverse()
            roots[i] = roots[i] - step
            largest = max(largest, step.norm())
        if largest <= ONE >> (BITS * 9 // 10):
            return roots
    raise ArithmeticError("the roots did not settle")


def root_groups(order):
    """Roots z inside the unit circle, conjugates together, by rising |z|."""
    if order == 1:
        return []
    lead = math.comb(2 * order - 2, order - 1)
    coefficients = [Complex(ONE * math.comb(order - 1 + k, k) // lead) for k in range(order)]
    groups = []
    for y in roots_of(coefficients):
        pair = abs(y.imag) > ONE >> 64
        if pair and y.imag < 0:
            continue
        middle = Complex(ONE) - y - y
        z = middle + (middle * middle - Complex(ONE)).sqrt()
        z = z if z.norm() < ONE else z.inverse()
        groups.append([z, Complex(z.real, -z.imag)] if pair else [Complex(z.real)])
    return sorted(groups, key=lambda group: group[0].norm())


def derive(order, outer):
    """The reconstruction low-pass filter whose roots are −1 (order times) and one of each pair."""
    roots = [Complex(-ONE)] * order
    for group, choice in zip(root_groups(order), outer):
        roots += [z.inverse() if choice == "1" else z for z in group]
    taps = [Complex(ONE)]
    for root in roots:
        taps = [a - b for a, b in zip(taps + [Complex(0)], [Complex(0)] + [root * tap for tap in taps])]
    total = sum(tap.real for tap in taps)
    root_of_two = math.isqrt(2 << 2 * BITS)
    return [tap.real * root_of_two // total / ONE for tap in taps]


def read_header():
    filters = {}
    text = HEADER.read_text()
    for family, (array, orders, step) in FAMILIES.items():
        body = re.search(rf"{array}\[\] = {{(.*?)}};", text, re.S).group(1)
        numbers = [float(number) for number in body.split(",")]
        for order in orders:
            filters[f"{family}{order}"], numbers = numbers[:step * order], numbers[step * order:]
        assert not numbers, f"{array} has {len(numbers)} numbers too many"
    return filters


def read_pywavelets():
    try:
        import pywt
    except ImportError:
        return None
    return {f"{family}{order}": pywt.Wavelet(f"{family}{order}").rec_lo
            for family, (_, orders, _) in FAMILIES.items() for order in orders}


def check_derived(filters):
    for family in ("db", "sym"):
        for order in FAMILIES[family][1]:
            taps = derive(order, OUTER[order] if family == "sym" else "0" * order)
            error = max(abs(a - b) for a, b in zip(taps, filters[f"{family}{order}"], strict=True))
            assert error <= TOLERANCE[family], f"{family}{order} is off by {error:.1e}"


def header_text(filters):
    arrays = []
    for family, (array, orders, _) in FAMILIES.items():
        numbers = [repr(tap) for order in orders for tap in filters[f"{family}{order}"]]
        arrays.append(f"inline constexpr double {array}[] = {{" + ", ".join(numbers) + "};\n")
    return """// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Reconstruction low-pass filters, the orders of a family one after the other. Written by
/// tests/analysis/wavelet_filters.py, which also derives them anew and compares.
namespace strainwave::analysis::wavelets {

""" + "\n".join(arrays) + "\n}  // namespace strainwave::analysis::wavelets\n"


def main():
    published = read_pywavelets()
    if "--write" in sys.argv:
        check_derived(published)
        print(header_text(published), end="")
        return
    filters = read_header()
    check_derived(filters)
    print("every db and sym filter agrees with its spectral factorisation")
    if published is None:
        print("skipped, because /usr/bin/python3 has no pywt: the comparison with PyWavelets")
    else:
        assert filters == published, [name for name in filters if filters[name] != published[name]]
        print("every filter equals that of PyWavelets, bit for bit")


if __name__ == "__main__":
    main()
