(** Long runs in integers: a step of the oscillator is linear, so n steps are a power of one integer matrix. *)

From Coq Require Import QArith Qreals Qabs Reals List Lra Lia.
From driftproof Require Import Methods.
Import ListNotations.
Open Scope R_scope.

Definition combination (x y : R) (p : state R * state R) : state R :=
  (x * fst (fst p) + y * fst (snd p), x * snd (fst p) + y * snd (snd p)).

Lemma moved_linear x y c z k :
  moved (combination x y z) c (combination x y k)
  = combination x y (moved (fst z) c (fst k), moved (snd z) c (snd k)).
Proof. unfold moved, combination; cbn. f_equal; ring. Qed.

Lemma advanced_linear x y h row : forall z ks,
  advanced h (combination x y z) row (map (combination x y) ks)
  = combination x y (advanced h (fst z) row (map fst ks), advanced h (snd z) row (map snd ks)).
Proof.
  induction row as [|a row IH]; intros z [|k ks]; cbn [advanced map]; try now destruct z.
  destruct (Qeq_bool a 0).
  - apply (IH z).
  - rewrite moved_linear. apply (IH (_, _)).
Qed.

Lemma rate_linear x y z :
  rate oscillator (combination x y z) = combination x y (rate oscillator (fst z), rate oscillator (snd z)).
Proof. unfold rate, combination, oscillator; cbn. f_equal; ring. Qed.

Lemma slopes_linear x y h z rows : forall ks,
  slopes oscillator h (combination x y z) rows (map (combination x y) ks)
  = map (combination x y)
      (combine (slopes oscillator h (fst z) rows (map fst ks)) (slopes oscillator h (snd z) rows (map snd ks))).
Proof.
  induction rows as [|row rows IH]; intros ks; cbn [slopes].
  - f_equal. induction ks as [|[k l] ks IH]; cbn; [reflexivity | now f_equal].
  - rewrite advanced_linear, rate_linear.
    match goal with |- context [[combination x y ?p]] => change [combination x y p] with (map (combination x y) [p]) end.
    rewrite <- map_app, IH, !map_app. reflexivity.
Qed.

Lemma slopes_length h z rows : forall ks, length (slopes (oscillator (T := R)) h z rows ks) = (length rows + length ks)%nat.
Proof.
  induction rows as [|row rows IH]; intros ks; cbn [slopes length]; [reflexivity|].
  rewrite IH, app_length; cbn; lia.
Qed.

Lemma part_linear x y h s z :
  part oscillator h (combination x y z) s
  = combination x y (part oscillator h (fst z) s, part oscillator h (snd z) s).
Proof. destruct s; unfold part, combination, oscillator; cbn; f_equal; ring. Qed.

Theorem step_linear x y m h z :
  step m h (combination x y z) = combination x y (step m h (fst z), step m h (snd z)).
Proof.
  destruct m as [A b|parts]; unfold step, step_with.
  - change (@nil (state R)) with (map (combination x y) []) at 1. rewrite slopes_linear, advanced_linear.
    cbn [map]. f_equal. f_equal; f_equal.
    all: generalize (slopes_length h (fst z) A []), (slopes_length h (snd z) A []).
    all: generalize (slopes oscillator h (fst z) A []), (slopes oscillator h (snd z) A []).
    all: intros l1 l2 <-; revert l2; induction l1; intros [|k l2]; cbn; try easy; injection 1; intros; f_equal; auto.
  - revert z; induction parts as [|s parts IH]; intros z; cbn [fold_left].
    + now destruct z.
    + rewrite part_linear. apply (IH (_, _)).
Qed.

(** The matrix of one step times its common denominator D, and n steps from (1, 0) as integers over D^n. *)
Section Integers.
  Variables (m : method) (h : Q).
  Let column (z : state Q) := step m h z.
  Let qq := fst (column (1, 0)%Q). Let vq := snd (column (1, 0)%Q).
  Let qv := fst (column (0, 1)%Q). Let vv := snd (column (0, 1)%Q).
  Definition common : positive :=
    let lcm a b := Pos.mul a (Z.to_pos (Zpos b / Zpos (Pos.gcd a b))) in
    lcm (lcm (Qden qq) (Qden vq)) (lcm (Qden qv) (Qden vv)).
  Let whole (x : Q) : Z := Qnum x * (Zpos common / Zpos (Qden x)).
  Definition integer_matrix : Z * Z * Z * Z := (whole qq, whole qv, whole vq, whole vv).
  Definition is_common : bool :=
    let ok x w := Qeq_bool x (w # common) in
    match integer_matrix with (a, b, c, d) => ok qq a && ok qv b && ok vq c && ok vv d end.
End Integers.

Fixpoint integer_run (a b c d : Z) (n : nat) : Z * Z :=
  match n with
  | O => (1, 0)%Z
  | S n => let (x, y) := integer_run a b c d n in (a * x + b * y, c * x + d * y)%Z
  end.

Definition computed_run (m : method) (h : Q) (n : nat) : state Q :=
  match integer_matrix m h with
  | (a, b, c, d) =>
      let (x, y) := integer_run a b c d n in
      let D := Z.to_pos (Zpos (common m h) ^ Z.of_nat n) in (x # D, y # D)
  end.

Lemma Q2R_over x D : Q2R (x # D) = IZR x / IZR (Zpos D).
Proof. reflexivity. Qed.

Theorem run_computed m h n : is_common m h = true -> to_R (run m h n start) = to_R (computed_run m h n).
Proof.
  unfold is_common, computed_run. destruct (integer_matrix m h) as [[[a b] c] d] eqn:E.
  intros ok. apply andb_prop in ok as [ok d_ok]. apply andb_prop in ok as [ok c_ok].
  apply andb_prop in ok as [a_ok b_ok].
  apply Qeq_bool_eq, Qeq_eqR in a_ok, b_ok, c_ok, d_ok.
  set (D := common m h) in *.
  assert (Dn : forall k, Zpos (Z.to_pos (Zpos D ^ Z.of_nat k)) = (Zpos D ^ Z.of_nat k)%Z)
    by (intros; apply Z2Pos.id, Z.pow_pos_nonneg; lia).
  assert (D0 : IZR (Zpos D) <> 0) by (apply not_0_IZR; discriminate).
  rewrite to_R_run, to_R_start.
  induction n as [|n IH].
  - cbn [run integer_run]. unfold to_R, start; cbn [fst snd lift reals].
    change (Z.to_pos _) with 1%positive. reflexivity.
  - cbn [run integer_run]. rewrite IH. clear IH.
    destruct (integer_run a b c d n) as [x y].
    unfold to_R at 1; cbn [fst snd].
    replace (Q2R (x # _), Q2R (y # _)) with
      (combination (Q2R (x # Z.to_pos (Zpos D ^ Z.of_nat n))) (Q2R (y # Z.to_pos (Zpos D ^ Z.of_nat n)))
        (to_R (1, 0)%Q, to_R (0, 1)%Q))
      by (unfold combination, to_R; cbn [fst snd]; rewrite RMicromega.Q2R_0, RMicromega.Q2R_1; f_equal; ring).
    rewrite step_linear. cbn [fst snd]. rewrite <- !to_R_step.
    unfold combination, to_R; cbn [fst snd].
    rewrite a_ok, b_ok, c_ok, d_ok, !Q2R_over, !Dn, Nat2Z.inj_succ, Z.pow_succ_r by lia.
    rewrite !mult_IZR, !plus_IZR, !mult_IZR.
    assert (IZR (Zpos D ^ Z.of_nat n) <> 0) by (rewrite <- pow_IZR; now apply pow_nonzero).
    f_equal; field; split; assumption.
Qed.

