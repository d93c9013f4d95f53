(** One float step against the exact step, over a box: Flocq says what rounding is, Gappa finds the proof. And N float
    steps of symplectic Euler against N exact ones, in the norm that an exact step keeps. *)

From Coq Require Import ZArith Reals Lra Lia.
From Coquelicot Require Import Complex.
From Flocq Require Import Core.
From Gappa Require Import Gappa_tactic.
From driftproof Require Import Methods Tables.
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
  - assert (sum : forall x y, binary64 (- x + - y) = - binary64 (x + y)) by (intros; rewrite <- binary64_odd; f_equal;
    ring).
    assert (product : forall x y, binary64 (x * - y) = - binary64 (x * y)) by (intros; rewrite <- binary64_odd;
      f_equal; ring).
    assert (quotient : forall x y, binary64 (- x / y) = - binary64 (x / y))
      by (intros; rewrite <- binary64_odd; f_equal; unfold Rdiv; ring).
    repeat first [rewrite product | rewrite quotient | rewrite sum | rewrite Ropp_involutive]. reflexivity.
  - unfold Rdiv. ring.
Qed.

Theorem rounding_of_rk4_velocity : errs_at_most (@rk4_program) snd 80.
Proof.
  intros h q v H Q V. destruct (rk4_turned h q v) as [-> ->]. apply rounding_of_rk4_position; lra.
Qed.

(** Many steps. *)
Definition norm (h : R) (z : R * R) : R := sqrt (fst z ^ 2 + snd z ^ 2 - h * fst z * snd z).
Definition difference (z w : R * R) : R * R := (fst z - fst w, snd z - snd w).
Definition symplectic_step (h : R) (z : R * R) : R * R := symplectic_euler_program (A := real_arithmetic) h (fst z)
  (snd z).

Lemma norm_modulus h z : 0 < h < 2 -> norm h z = Cmod (fst z - h / 2 * snd z, sqrt (1 - h ^ 2 / 4) * snd z).
Proof.
  intros H. unfold norm, Cmod; cbn [fst snd]. f_equal. assert (0 <= 1 - h ^ 2 / 4) by nra.
  rewrite Rpow_mult_distr, pow2_sqrt by assumption. field.
Qed.
Lemma norm_triangle h z w x : 0 < h < 2 -> norm h (difference z x) <= norm h (difference z w) + norm h (difference w x).
Proof.
  intros H. rewrite !norm_modulus by assumption. unfold difference; cbn [fst snd].
  eapply Rle_trans; [|apply Cmod_triangle].
  apply Req_le. f_equal. unfold Cplus; cbn [fst snd]. f_equal; ring.
Qed.
Lemma norm_kept h z w : norm h (difference (symplectic_step h z) (symplectic_step h w)) = norm h (difference z w).
Proof.
  unfold norm, difference, symplectic_step, symplectic_euler_program.
  cbn [plus times over negative integer real_arithmetic fst snd]. f_equal. ring.
Qed.
Lemma norm_0 h z : norm h (difference z z) = 0.
Proof. unfold norm, difference; cbn [fst snd]. rewrite !Rminus_eq_0. replace (_ - _) with 0 by ring. apply sqrt_0. Qed.
Lemma norm_step h z : norm h (symplectic_step h z) = norm h z.
Proof.
  unfold norm, symplectic_step, symplectic_euler_program.
  cbn [plus times over negative integer real_arithmetic fst snd].
  f_equal. ring.
Qed.

(** Any step that misses the exact one by at most c times the norm of the state: ((1 + c)^N - 1) |z| after N steps. *)
Theorem n_steps_of_symplectic_euler : forall (step : R * R -> R * R) h c z N, 0 < h < 2 -> 0 <= c ->
  (forall w, norm h (difference (step w) (symplectic_step h w)) <= c * norm h w) ->
  norm h (difference (Nat.iter N step z) (Nat.iter N (symplectic_step h) z)) <= ((1 + c) ^ N - 1) * norm h z.
Proof.
  intros step h c z N H c_pos one.
  assert (kept : norm h (Nat.iter N (symplectic_step h) z) = norm h z).
  { induction N as [|N IH]; [reflexivity|]. cbn [Nat.iter nat_rect]. now rewrite norm_step. }
  induction N as [|N IH]; [cbn [Nat.iter nat_rect pow]; rewrite norm_0; lra|].
  assert (kept' : norm h (Nat.iter N (symplectic_step h) z) = norm h z) by (rewrite <- kept; symmetry; apply norm_step).
  specialize (IH kept'). cbn [Nat.iter nat_rect]. fold (Nat.iter N step z) (Nat.iter N (symplectic_step h) z).
  set (x := Nat.iter N step z) in *. set (y := Nat.iter N (symplectic_step h) z) in *.
  eapply Rle_trans; [apply (norm_triangle h _ (symplectic_step h x)); exact H|]. rewrite norm_kept.
  assert (large : norm h x <= norm h (difference x y) + norm h y).
  { assert (Z : forall w, norm h w = norm h (difference w (0, 0)))
      by (intros [a b]; unfold difference; cbn [fst snd]; now rewrite !Rminus_0_r).
    rewrite (Z x), (Z y). now apply norm_triangle. }
  specialize (one x). rewrite kept' in large. cbn [pow]. assert (0 <= norm h z) by apply sqrt_pos. nra.
Qed.

(** In the box of Rounding.v a float step misses by 40 units roundoff at most; N of them, N times that. *)
Definition float_step (h : R) (z : R * R) : R * R := symplectic_euler_program (A := rounded) h (fst z) (snd z).
Definition in_box (z : R * R) : Prop := -2 <= fst z <= 2 /\ -2 <= snd z <= 2.

Lemma float_step_misses h z : 0 < h < 2 -> in_box z ->
  norm h (difference (float_step h z) (symplectic_step h z)) <= units 40.
Proof.
  intros H [Q V]. assert (E := rounding_of_symplectic_euler_position h (fst z) (snd z) ltac:(lra) Q V).
  assert (E' := rounding_of_symplectic_euler_velocity h (fst z) (snd z) ltac:(lra) Q V).
  unfold norm, difference, float_step, symplectic_step in *. cbn [fst snd].
  set (a := fst _ - fst _) in *. set (b := snd _ - snd _) in *.
  assert (0 <= units 40) by (unfold units; lra). rewrite <- (sqrt_square (units 40)) by assumption.
  apply sqrt_le_1_alt. assert (S : units 40 = units 34 + units 6) by (unfold units; lra). rewrite S.
  apply Rcomplements.Rabs_le_between in E, E'. assert (0 <= units 34) by (unfold units; lra).
  assert (0 <= units 6) by (unfold units; lra). clear S H0 Q V.
  generalize dependent (units 34). generalize dependent (units 6). clearbody a b. intros y E' Y x E X.
  assert (a * a <= x * x) by nra. assert (b * b <= y * y) by nra. assert (- (x * y) <= a * b <= x * y) by (split; nra).
  assert (- (h * (a * b)) <= 2 * (x * y)) by (destruct (Rle_dec 0 (a * b)); nra). cbn [pow]. nra.
Qed.

Theorem many_float_steps : forall h z N, 0 < h < 2 -> (forall n, (n < N)%nat -> in_box (Nat.iter n (float_step h) z)) ->
  norm h (difference (Nat.iter N (float_step h) z) (Nat.iter N (symplectic_step h) z)) <= INR N * units 40.
Proof.
  intros h z N H. induction N as [|N IH]; intros inside; [cbn [Nat.iter nat_rect INR]; rewrite norm_0; lra|].
  specialize (IH ltac:(intros n less; apply inside; lia)). specialize (inside N ltac:(lia)). rewrite S_INR.
  cbn [Nat.iter nat_rect]. fold (Nat.iter N (float_step h) z) (Nat.iter N (symplectic_step h) z).
  eapply Rle_trans; [apply (norm_triangle h _ (symplectic_step h (Nat.iter N (float_step h) z))); exact H|].
  rewrite norm_kept. generalize (float_step_misses h _ H inside). lra.
Qed.
