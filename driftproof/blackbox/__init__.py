"""Somebody's float stepper, seen from outside: what it is, and whether it is right to roundoff.

`identify` names a stepper by `naming`, `verify` compares it with a method, whose verdict is what `criteria` came to in
`verification`, and `solvers.identify_solver` reads a whole solver. What they ask lies in folders, each of which imports
only from those above it:

    findings, report   what foreign code did, and what is said of it
    stepper            calling it: its convention, its numbers, its state; wrappers for what cannot be called
    isolation          asking it in a process of its own, with limits
    probes             what its answers show: coefficients, estimates, dense outputs, the one-step matrix
    checks             what is expected of any stepper: arguments, step sizes, domain, repeatability
    matching           which method of the catalogue, or variant of one, has what was read
    judging            its steps beside those of a method: rounding bounds, nonlinear problems, the order
    families           steppers that no single tableau describes: multistep, Rosenbrock, IMEX, rotations, damped steps
    solvers            whole solvers: their steps, the law of their step sizes, runs with known solutions
"""
