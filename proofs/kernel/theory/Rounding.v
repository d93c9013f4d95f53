(** One float step against the exact step, over a box: Flocq says what rounding is, Gappa finds the proof. *)

From Coq Require Import ZArith Reals Lra.
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

(** Rounding is odd. So RK4's velocity from (q, v) is its position from (v, -q), operation by operation. *)
Lemma binary64_odd x : binary64 (- x) = - binary64 x.
Proof. apply round_NE_opp. Qed.

Lemma rk4_turned h q v : snd (rk4_program (A := rounded) h q v) = fst (rk4_program (A := rounded) h v (- q))
  /\ snd (rk4_program (A := real_arithmetic) h q v) = fst (rk4_program (A := real_arithmetic) h v (- q)).
Proof.
  unfold rk4_program; cbn [plus times over negative integer rounded real_arithmetic fst snd]. split.
  - assert (sum : forall x y, binary64 (- x + - y) = - binary64 (x + y)) by (intros; rewrite <- binary64_odd; f_equal; ring).
    assert (product : forall x y, binary64 (x * - y) = - binary64 (x * y)) by (intros; rewrite <- binary64_odd; f_equal; ring).
    assert (quotient : forall x y, binary64 (- x / y) = - binary64 (x / y))
      by (intros; rewrite <- binary64_odd; f_equal; unfold Rdiv; ring).
    repeat first [rewrite product | rewrite quotient | rewrite sum | rewrite Ropp_involutive]. reflexivity.
  - unfold Rdiv. ring.
Qed.

Theorem rounding_of_rk4_velocity : errs_at_most (@rk4_program) snd 80.
Proof.
  intros h q v H Q V. destruct (rk4_turned h q v) as [-> ->]. apply rounding_of_rk4_position; lra.
Qed.
