(** N float steps of symplectic Euler against N exact ones, in the norm that an exact step keeps. *)

From Coq Require Import ZArith Reals Lra Lia.
From Coquelicot Require Import Complex.
From driftproof Require Import Arithmetic Programs Rounding.
Open Scope R_scope.

Definition norm (h : R) (z : R * R) : R := sqrt (fst z ^ 2 + snd z ^ 2 - h * fst z * snd z).
Definition difference (z w : R * R) : R * R := (fst z - fst w, snd z - snd w).
Definition symplectic_step (h : R) (z : R * R) : R * R := symplectic_euler_program (A := real_arithmetic) h (fst z) (snd z).

Lemma norm_modulus h z : 0 < h < 2 -> norm h z = Cmod (fst z - h / 2 * snd z, sqrt (1 - h ^ 2 / 4) * snd z).
Proof.
  intros H. unfold norm, Cmod; cbn [fst snd]. f_equal. assert (0 <= 1 - h ^ 2 / 4) by nra.
  rewrite Rpow_mult_distr, pow2_sqrt by assumption. field.
Qed.
Lemma norm_triangle h z w x : 0 < h < 2 -> norm h (difference z x) <= norm h (difference z w) + norm h (difference w x).
Proof.
  intros H. rewrite !norm_modulus by assumption. unfold difference; cbn [fst snd]. eapply Rle_trans; [|apply Cmod_triangle].
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
  unfold norm, symplectic_step, symplectic_euler_program. cbn [plus times over negative integer real_arithmetic fst snd].
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
