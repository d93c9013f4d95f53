(** One-step methods as data, and one step of them, over any scalars: rationals to compute with, reals to prove with. *)

From Coq Require Import QArith Qreals Reals List.
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
