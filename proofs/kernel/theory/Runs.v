(** Long runs in integers: a step of the oscillator is linear, so n steps are a power of one integer matrix. And how
    such a run is enclosed, so that [interval] can go on. *)

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
    match goal with |- context [[combination x y ?p]] => change [combination x y p]
      with (map (combination x y) [p]) end.
    rewrite <- map_app, IH, !map_app. reflexivity.
Qed.

Lemma slopes_length h z rows : forall ks,
  length (slopes (oscillator (T := R)) h z rows ks) = (length rows + length ks)%nat.
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

From Bignums Require Import BigZ.
From Interval Require Export Tactic.
From driftproof Require Export Readouts.

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

(** The two components and D^n, in integers that the processor multiplies. *)
Section Powers.
  Variables a b c d D : bigZ.
  Fixpoint integer_run (n : nat) : bigZ * bigZ * bigZ :=
    match n with
    | O => (BigZ.one, BigZ.zero, BigZ.one)
    | S n => let '(x, y, p) := integer_run n in
             (BigZ.add (BigZ.mul a x) (BigZ.mul b y), BigZ.add (BigZ.mul c x) (BigZ.mul d y), BigZ.mul D p)
    end.
End Powers.
Definition real (x : bigZ) : R := IZR (BigZ.to_Z x).
Definition integers (m : method) (h : Q) (n : nat) : bigZ * bigZ * bigZ :=
  let '(a, b, c, d) := integer_matrix m h in
  integer_run (BigZ.of_Z a) (BigZ.of_Z b) (BigZ.of_Z c) (BigZ.of_Z d) (BigZ.of_Z (Zpos (common m h))) n.

Lemma integers_hold m h n : is_common m h = true -> let '(x, y, p) := integers m h n in
  (0 < BigZ.to_Z p)%Z /\ to_R (run m h n start) = (real x / real p, real y / real p).
Proof.
  unfold is_common, integers. destruct (integer_matrix m h) as [[[a b] c] d] eqn:E.
  intros ok. apply andb_prop in ok as [ok d_ok]. apply andb_prop in ok as [ok c_ok].
  apply andb_prop in ok as [a_ok b_ok].
  apply Qeq_bool_eq, Qeq_eqR in a_ok, b_ok, c_ok, d_ok.
  assert (over : forall x D, Q2R (x # D) = IZR x / IZR (Zpos D)) by reflexivity.
  rewrite over in a_ok, b_ok, c_ok, d_ok. set (D := common m h) in *.
  assert (D0 : IZR (Zpos D) <> 0) by (apply not_0_IZR; discriminate).
  rewrite to_R_run, to_R_start. induction n as [|n IH].
  - cbn [run integer_run]. unfold real. rewrite BigZ.spec_1, BigZ.spec_0. split; [reflexivity|].
    unfold start; cbn [lift reals].
    rewrite RMicromega.Q2R_0, RMicromega.Q2R_1. f_equal; field.
  - cbn [run integer_run]. destruct (integer_run _ _ _ _ _ n) as [[x y] p]. destruct IH as [pos ->].
    assert (p0 : real p <> 0) by (apply not_0_IZR; lia).
    unfold real in *. rewrite !BigZ.spec_add, !BigZ.spec_mul, !BigZ.spec_of_Z, !plus_IZR, !mult_IZR. split; [nia|].
    set (X := IZR (BigZ.to_Z x) / _). set (Y := IZR (BigZ.to_Z y) / _).
    replace (X, Y) with (combination X Y (to_R (1, 0)%Q, to_R (0, 1)%Q))
      by (unfold combination, to_R; cbn [fst snd]; rewrite RMicromega.Q2R_0, RMicromega.Q2R_1; f_equal; ring).
    rewrite step_linear. cbn [fst snd]. rewrite <- !to_R_step. unfold combination, to_R; cbn [fst snd].
    rewrite a_ok, b_ok, c_ok, d_ok. unfold X, Y. f_equal; field; split; assumption.
Qed.

Definition computed_run (m : method) (h : Q) (n : nat) : state Q :=
  let '(x, y, p) := integers m h n in (BigZ.to_Z x # Z.to_pos (BigZ.to_Z p), BigZ.to_Z y # Z.to_pos (BigZ.to_Z p)).
Theorem run_computed m h n : is_common m h = true -> to_R (run m h n start) = to_R (computed_run m h n).
Proof.
  intros ok. assert (H := integers_hold m h n ok). unfold computed_run. destruct (integers m h n) as [[x y] p].
  destruct H as [pos ->]. unfold to_R, Q2R; cbn [fst snd Qnum Qden]. now rewrite Z2Pos.id.
Qed.

(** A readout of the exact run has the digits of the same readout of the run computed in integers. *)
Section Computed.
  Variables (m : method) (h : Q) (n : nat) (d : Q).
  Hypothesis common_is_common : is_common m h = true.
  Let z := run m h n start.
  Let w := computed_run m h n.
  Let same : to_R z = to_R w := run_computed m h n common_is_common.

  Lemma fst_computed : rounds_to (fst w) d -> rounds_to (fst z) d.
  Proof. apply rounds_to_of_reals. exact (f_equal fst same). Qed.
  Lemma snd_computed : rounds_to (snd w) d -> rounds_to (snd z) d.
  Proof. apply rounds_to_of_reals. exact (f_equal snd same). Qed.
  Lemma energy_computed : rounds_to (energy w) d -> rounds_to (energy z) d.
  Proof. apply rounds_to_of_reals. now rewrite !Q2R_energy, same. Qed.
  Lemma energy_change_computed e : rounds_to (energy w - e) d -> rounds_to (energy z - e) d.
  Proof. apply rounds_to_of_reals. now rewrite !Q2R_minus, !Q2R_energy, same. Qed.
End Computed.

(** A fact that holds for all states of a box holds for a run that ends in it: this one is 10^-40 wide. *)
Definition corner (m : method) (h : Q) (n : nat) : Z * Z :=
  let '(x, y, p) := integers m h n in
  let down z := BigZ.to_Z (BigZ.div (BigZ.mul z (BigZ.of_Z (10 ^ 40))) p) in (down x, down y).
Definition ends_at (m : method) (h : Q) (n : nat) (k l : Z) : bool :=
  is_common m h && let (i, j) := corner m h n in (i =? k)%Z && (j =? l)%Z.

Lemma of_run_in_box (P : state R -> Prop) m h n k l : ends_at m h n k l = true ->
  (forall q v, IZR k / 10 ^ 40 <= q <= IZR (k + 1) / 10 ^ 40 -> IZR l / 10 ^ 40 <= v <= IZR (l + 1) / 10 ^ 40 -> P (q,
    v)) ->
  P (to_R (run m h n start)).
Proof.
  unfold ends_at, corner. intros ok of_box. apply andb_prop in ok as [ok corner]. assert (H := integers_hold m h n ok).
  destruct (integers m h n) as [[x y] p]. destruct H as [pos ->]. apply andb_prop in corner as [E F].
  apply Z.eqb_eq in E, F. subst k l.
  assert (down : forall z, real (BigZ.div (BigZ.mul z (BigZ.of_Z (10 ^ 40))) p) / 10 ^ 40 <= real z / real p
    <= IZR (BigZ.to_Z (BigZ.div (BigZ.mul z (BigZ.of_Z (10 ^ 40))) p) + 1) / 10 ^ 40).
  { intros z. unfold real. rewrite BigZ.spec_div, BigZ.spec_mul, BigZ.spec_of_Z.
    assert (B := floor_within (BigZ.to_Z z * 10 ^ 40) (BigZ.to_Z p) pos). rewrite plus_IZR. rewrite mult_IZR in B.
    assert (IZR (BigZ.to_Z p) <> 0) by (apply not_0_IZR; lia).
    assert (T0 : 0 < IZR (10 ^ 40)) by now apply IZR_lt.
    replace (10 ^ 40) with (IZR (10 ^ 40)) by exact (eq_sym (pow_IZR 10 40)).
    set (T := IZR (10 ^ 40)) in *. clearbody T.
    replace (IZR (BigZ.to_Z z) / IZR (BigZ.to_Z p)) with (IZR (BigZ.to_Z z) * T / IZR (BigZ.to_Z p) / T) by (field;
      lra).
    split; (apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat; assumption | lra]). }
  apply of_box; apply down.
Qed.

(** Tactics, one for each way to be right. *)
Ltac by_vm := repeat match goal with |- _ /\ _ => split end; vm_compute; reflexivity.
Ltac by_run :=
  match goal with
  | |- rounds_to (fst (run _ _ _ _)) _ => apply fst_computed
  | |- rounds_to (snd (run _ _ _ _)) _ => apply snd_computed
  | |- rounds_to (energy (run _ _ _ _)) _ => apply energy_computed
  | |- rounds_to (energy (run _ _ _ _) - _) _ => apply energy_change_computed
  end; by_vm.
Ltac box_runs :=
  repeat match goal with
  | |- context [to_R (run ?m ?h ?n start)] =>
      let c := eval vm_compute in (corner m h n) in
      match c with (?k, ?l) =>
        let k' := eval vm_compute in (k + 1)%Z in let l' := eval vm_compute in (l + 1)%Z in
        pattern (to_R (run m h n start)); apply (of_run_in_box _ m h n k l); [vm_cast_no_check (eq_refl true)|];
        let q := fresh "q" in let v := fresh "v" in intros q v; change (k + 1)%Z with k'; change (l + 1)%Z with l';
          intros
      end
  end.
Ltac by_interval :=
  repeat match goal with |- _ /\ _ => split end;
  box_runs; unfold real_rounds_to, distance, flow, energy, start;
  cbn [fst snd add mul lift reals]; unfold Q2R; cbn [Qnum Qden];
  first [interval with (i_prec 120) | apply Rminus_gt_0_lt; interval with (i_prec 120)].
(** The angle of a state to the right of the axis is an arctangent. *)
Ltac by_angle :=
  box_runs; unfold phase_error, flow, angle; cbn [fst snd];
  match goal with |- context [Rlt_dec 0 ?x] =>
    destruct (Rlt_dec 0 x) as [_ | wrong]; [ | exfalso; apply wrong; interval with (i_prec 120) ] end;
  by_interval.
(** What depends on cos^2 + sin^2 alone. *)
Ltac by_circle := intros t; generalize (sin2_cos2 t); unfold Rsqr, flow; expose; lra.
