(** One-step methods as data, and one step of them, over any scalars: rationals to compute with, reals to prove with;
    and programs, over reals and floats. *)

From Coq Require Import QArith Qreals Reals Lra Lia List.
Import ListNotations.

(** What a step needs to know of numbers: where the coefficients go, sums and products. *)
Class Scalars (T : Type) := { lift : Q -> T; add : T -> T -> T; mul : T -> T -> T }.
#[export] Instance rationals : Scalars Q :=
  {| lift := Qred; add x y := Qred (x + y); mul x y := Qred (x * y) |}.
#[export] Instance reals : Scalars R := {| lift := Q2R; add := Rplus; mul := Rmult |}.

Inductive substep := kick (c : Q) | drift (c : Q).
Inductive method :=
| RungeKutta (A : list (list Q)) (b : list Q)  (* explicit: row i has the coefficients of the slopes before stage i *)
| Splitting (parts : list substep).

Section Step.
  Context {T : Type} {S : Scalars T}.
  Definition state : Type := T * T.
  Variable force : T -> T.

  (** The rate F(q, v) = (v, force q). *)
  Definition rate (z : state) : state := (snd z, force (fst z)).
  Definition moved (z : state) (c : T) (k : state) : state :=
    (add (fst z) (mul c (fst k)), add (snd z) (mul c (snd k))).

  (** z + h (a1 k1 + a2 k2 + ...), zero coefficients left out. *)
  Fixpoint advanced (h : T) (z : state) (row : list Q) (slopes : list state) : state :=
    match row, slopes with
    | a :: row, k :: slopes =>
        advanced h (if Qeq_bool a 0 then z else moved z (mul (lift a) h) k) row slopes
    | _, _ => z
    end.

  (** k_i = F(z + h sum_j a_ij k_j), one after the other. *)
  Fixpoint slopes (h : T) (z : state) (rows : list (list Q)) (known : list state) : list state :=
    match rows with
    | [] => known
    | row :: rows => slopes h z rows (known ++ [rate (advanced h z row known)])
    end.

  Definition part (h : T) (z : state) (s : substep) : state :=
    match s with
    | kick c => (fst z, add (snd z) (mul (mul (lift c) h) (force (fst z))))
    | drift c => (add (fst z) (mul (mul (lift c) h) (snd z)), snd z)
    end.

  Definition step_with (m : method) (h : T) (z : state) : state :=
    match m with
    | RungeKutta A b => advanced h z b (slopes h z A [])
    | Splitting parts => fold_left (part h) parts z
    end.
End Step.
Arguments state T : clear implicits.

(** The oscillator q' = v, v' = -q: its force, one step, n steps. *)
Definition oscillator {T} `{Scalars T} (q : T) : T := mul (lift (-1)) q.
Definition step {T} `{Scalars T} : method -> T -> state T -> state T := step_with oscillator.
Fixpoint run {T} `{Scalars T} (m : method) (h : T) (n : nat) (z : state T) : state T :=
  match n with O => z | S n => step m h (run m h n z) end.

(** The rates k_1, ..., k_s of one step; a splitting has none. *)
Definition rates {T} `{Scalars T} (m : method) (h : T) (z : state T) : list (state T) :=
  match m with RungeKutta A _ => slopes oscillator h z A [] | Splitting _ => [] end.

(** How often a step asks for the force: once for each slope, once for each kick. *)
Definition evaluations (m : method) : nat :=
  match m with
  | RungeKutta A _ => length A
  | Splitting parts => length (filter (fun s => match s with kick _ => true | drift _ => false end) parts)
  end.

Definition start {T} `{Scalars T} : state T := (lift 1, lift 0).
Definition energy {T} `{Scalars T} (z : state T) : T :=
  mul (lift (1 # 2)) (add (mul (fst z) (fst z)) (mul (snd z) (snd z))).
(** A scene of the lesson: methods, start, step, how often, how long. *)
Record scene := { methods : list method; initial : state Q; size : Q; steps : nat; duration : Q }.

(** (q^2 + v^2 - h q v) / 2, which velocity-first Euler keeps. *)
Definition modified_energy {T} `{Scalars T} (h : T) (z : state T) : T :=
  add (energy z) (mul (lift (-1 # 2)) (mul h (mul (fst z) (snd z)))).

(** What is computed in rationals is true of the reals. *)
Definition to_R (z : state Q) : state R := (Q2R (fst z), Q2R (snd z)).

Lemma Q2R_red x : Q2R (Qred x) = Q2R x.
Proof. apply Qeq_eqR, Qred_correct. Qed.

Lemma Q2R_add x y : Q2R (add x y) = add (Q2R x) (Q2R y).
Proof. cbn [add rationals reals]. now rewrite Q2R_red, Q2R_plus. Qed.

Lemma Q2R_mul x y : Q2R (mul x y) = mul (Q2R x) (Q2R y).
Proof. cbn [mul rationals reals]. now rewrite Q2R_red, Q2R_mult. Qed.

Lemma Q2R_lift x : Q2R (lift x) = lift x.
Proof. apply Q2R_red. Qed.

Lemma Q2R_oscillator x : Q2R (oscillator x) = oscillator (Q2R x).
Proof. unfold oscillator. now rewrite Q2R_mul, Q2R_lift. Qed.

Lemma Q2R_energy z : Q2R (energy z) = energy (to_R z).
Proof. unfold energy, to_R. now rewrite Q2R_mul, Q2R_add, !Q2R_mul, Q2R_lift. Qed.

Lemma to_R_moved z c k : to_R (moved z c k) = moved (to_R z) (Q2R c) (to_R k).
Proof. unfold moved, to_R; cbn [fst snd]. now rewrite !Q2R_add, !Q2R_mul. Qed.

Lemma to_R_advanced h row : forall z ks, to_R (advanced h z row ks) = advanced (Q2R h) (to_R z) row (map to_R ks).
Proof.
  induction row as [|a row IH]; intros z [|k ks]; try reflexivity.
  cbn [advanced map]. rewrite IH. destruct (Qeq_bool a 0); [reflexivity|].
  now rewrite to_R_moved, Q2R_mul, Q2R_lift.
Qed.

Lemma to_R_rate z : to_R (rate oscillator z) = rate oscillator (to_R z).
Proof. unfold rate, to_R; cbn [fst snd]. now rewrite Q2R_oscillator. Qed.

Lemma to_R_slopes h z rows :
  forall ks, map to_R (slopes oscillator h z rows ks) = slopes oscillator (Q2R h) (to_R z) rows (map to_R ks).
Proof.
  induction rows as [|row rows IH]; intros ks; [reflexivity|].
  cbn [slopes]. rewrite IH, map_app. cbn [map]. now rewrite to_R_rate, to_R_advanced.
Qed.

Lemma to_R_step m h z : to_R (step m h z) = step m (Q2R h) (to_R z).
Proof.
  destruct m as [A b|parts]; cbn [step step_with]; unfold step, step_with.
  - rewrite to_R_advanced, to_R_slopes. reflexivity.
  - revert z; induction parts as [|s parts IH]; intros z; [reflexivity|].
    cbn [fold_left]. rewrite IH. f_equal.
    destruct s as [c|c]; unfold part, to_R; cbn [fst snd]; now rewrite Q2R_add, !Q2R_mul, ?Q2R_oscillator, Q2R_lift.
Qed.

Theorem to_R_run m h n z : to_R (run m h n z) = run m (Q2R h) n (to_R z).
Proof. induction n as [|n IH]; cbn [run]; [|rewrite to_R_step, IH]; reflexivity. Qed.

Lemma to_R_start : to_R start = start.
Proof. unfold to_R, start. cbn [fst snd]. now rewrite !Q2R_lift. Qed.

(** The integer part of a quotient. *)
Lemma floor_within n d : (0 < d)%Z -> (IZR (n / d) <= IZR n / IZR d < IZR (n / d) + 1)%R.
Proof.
  intros pos. assert (0 < IZR d)%R by now apply IZR_lt. assert (E := Z.div_mod n d ltac:(lia)).
  assert (B := Z.mod_pos_bound n d pos). apply (f_equal IZR) in E. rewrite plus_IZR, mult_IZR in E.
  destruct B as [B B']. apply IZR_le in B. apply IZR_lt in B'.
  replace (IZR n / IZR d)%R with (IZR (n / d) + IZR (n mod d) / IZR d)%R by (rewrite E; field; lra).
  assert (0 <= IZR (n mod d) / IZR d < 1)%R; [|lra].
  split; [apply Rmult_le_reg_r with (IZR d) | apply Rmult_lt_reg_r with (IZR d)]; trivial;
    unfold Rdiv; rewrite Rmult_assoc, Rinv_l; lra.
Qed.

(** The operations of a program, in the order in which it makes them, over any numbers. *)
Class Arithmetic (T : Type) :=
  { plus : T -> T -> T; times : T -> T -> T; over : T -> T -> T; negative : T -> T; integer : Z -> T }.
#[export] Instance real_arithmetic : Arithmetic R :=
  {| plus := Rplus; times := Rmult; over := Rdiv; negative := Ropp; integer := IZR |}.

(** Programs in binary64: Coq's primitive floats are the processor's. *)
From Coq Require Import Floats Uint63.
Definition float_of_Z (z : Z) : float :=
  if (z <? 0)%Z then PrimFloat.opp (PrimFloat.of_uint63 (of_Z (- z))) else PrimFloat.of_uint63 (of_Z z).
#[export] Instance float_arithmetic : Arithmetic float :=
  {| plus := PrimFloat.add; times := PrimFloat.mul; over := PrimFloat.div; negative := PrimFloat.opp;
     integer := float_of_Z |}.

(** n steps of a program, each from where the last one ended. *)
Fixpoint float_run (program : float -> float -> float -> float * float) (h : float) (n : nat) (z : float * float) :=
  match n with O => z | S n => let (q, v) := float_run program h n z in program h q v end.

(** Binary32, of which the processor's floats are no instance: the operations that Coq specifies, bit for bit. *)
Definition single_of_Z (z : Z) : spec_float := binary_normalize 24 128 z 0 false.
Definition single_arithmetic : Arithmetic spec_float :=
  {| plus := SFadd 24 128; times := SFmul 24 128; over := SFdiv 24 128; negative := SFopp; integer := single_of_Z |}.
Fixpoint single_run (program : spec_float -> spec_float -> spec_float -> spec_float * spec_float) (h : spec_float)
  (n : nat) (z : spec_float * spec_float) :=
  match n with O => z | S n => let (q, v) := single_run program h n z in program h q v end.
(** The rational number that a finite float is. *)
Definition rational_of (x : spec_float) : Q :=
  match x with
  | S754_finite s m e => Qred (inject_Z (if s then Zneg m else Zpos m) * Qpower 2 e)
  | _ => 0
  end.
