(** One float step against the exact step, over a box: Flocq says what rounding is, Gappa finds the proof. *)

From Coq Require Import ZArith Reals.
From Flocq Require Import Core.
From Gappa Require Import Gappa_tactic.
From driftproof Require Import Arithmetic Programs.
Open Scope R_scope.

(** Every operation of a program is rounded to binary64, to nearest and ties to even; nothing overflows here. *)
Definition binary64 : R -> R := round radix2 (FLT_exp (-1074) 53) ZnearestE.
Definition rounded : Arithmetic R :=
  {| plus x y := binary64 (x + y); times x y := binary64 (x * y); over x y := binary64 (x / y);
     negative := Ropp; integer := IZR |}.
Definition units (k : R) : R := k / 9007199254740992.  (* k times 2^-53 *)
Definition program := forall T, Arithmetic T -> T -> T -> T -> T * T.

(** In [0, 2] x [-2, 2]^2 the rounding error of one step is at most k units roundoff, in position or in velocity. *)
Definition errs_at_most (step : program) (component : R * R -> R) (k : R) : Prop :=
  forall h q v, 0 <= h <= 2 -> -2 <= q <= 2 -> -2 <= v <= 2 ->
  Rabs (component (step R rounded h q v) - component (step R real_arithmetic h q v)) <= units k.

Ltac by_gappa :=
  intros h q v H Q V; unfold units, forward_euler_program, symplectic_euler_program, rk4_program;
  cbn [plus times over negative integer rounded real_arithmetic fst snd]; unfold binary64; gappa.

Theorem rounding_of_forward_euler_position : errs_at_most (@forward_euler_program) fst 6.
Proof. by_gappa. Qed.

Theorem rounding_of_forward_euler_velocity : errs_at_most (@forward_euler_program) snd 6.
Proof. by_gappa. Qed.

Theorem rounding_of_symplectic_euler_position : errs_at_most (@symplectic_euler_program) fst 34.
Proof. by_gappa. Qed.

Theorem rounding_of_symplectic_euler_velocity : errs_at_most (@symplectic_euler_program) snd 6.
Proof. by_gappa. Qed.

Theorem rounding_of_rk4_position : errs_at_most (@rk4_program) fst 80.
Proof. by_gappa. Qed.
