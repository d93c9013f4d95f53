"""The lesson's three steps and the energy, written out with Fractions: what answers are held against."""

from fractions import Fraction as Q


def forward_euler(z, h):
    q, v = z
    return q + h * v, v - h * q


def symplectic_euler(z, h):
    q, v = z
    v = v - h * q
    return q + h * v, v


def rk4(z, h):
    def rate(z):
        return z[1], -z[0]

    def moved(by, k):
        return z[0] + by * k[0], z[1] + by * k[1]

    k1 = rate(z)
    k2 = rate(moved(h / 2, k1))
    k3 = rate(moved(h / 2, k2))
    k4 = rate(moved(h, k3))
    return moved(h / 6, (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0], k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1]))


BY_HAND = {"forward_euler": forward_euler, "symplectic_euler": symplectic_euler, "rk4": rk4}


def reached(key, h, n, start=(Q(1), Q(0))):
    z = start
    for _ in range(n):
        z = BY_HAND[key](z, h)
    return z


def energy(z):
    return (z[0] ** 2 + z[1] ** 2) / 2
