(** How an exact order is checked: the weights of all ordered trees, in integers of a number field. *)

From Coq Require Import QArith Qreals Reals Lra Lia List.
From Bignums Require Import BigZ.
From driftproof Require Import Methods Trees.
Import ListNotations.
Open Scope R_scope.

(** Any ring with a map to the reals; only what it calls equal has to be equal there. *)
Record ring := {
  ring_numbers :> numbers;
  same : ring_numbers -> ring_numbers -> bool;
  value : ring_numbers -> R;
  value_plus : forall x y, value (plus _ x y) = value x + value y;
  value_mult : forall x y, value (mult _ x y) = value x * value y;
  value_of_Z : forall z, value (of_Z _ z) = IZR z;
  value_same : forall x y, same x y = true -> value x = value y
}.

Section Exactly.
  Variable K : ring.
  (** The table times a common denominator D. *)
  Variables (A : list (list K)) (b : list K) (D : Z).
  Hypothesis D_pos : (0 < D)%Z.
  Definition over (x : K) : R := value K x / IZR D.
  Definition real_A := map (map over) A.
  Definition real_b := map over b.

  Definition holds (n : Z) (e : entry K) : bool :=
    same K (mult K (dot_K K b (stages_of K e)) (of_Z K (n * branches_of K e))) (of_Z K (D ^ n)).

  Let d := IZR D.
  Let d_pos : 0 < d.
  Proof. apply IZR_lt, D_pos. Qed.

  Lemma power_of_vertices t : d ^ vertices t = d * d ^ (vertices t - 1).
  Proof. destruct (vertices t) as [|n] eqn:E; [generalize (vertices_pos t); lia|]. now rewrite Nat.sub_1_r. Qed.

  Lemma value_dot c x : forall row y, map (value K) y = map (Rmult c) x ->
    value K (dot_K K row y) = d * c * dot (map over row) x.
  Proof.
    revert c. induction x as [|x0 x IH]; intros c [|r row] [|y0 y]; try discriminate; intros E; cbn;
      rewrite ?value_of_Z; try ring.
    injection E; intros E' E0. rewrite value_plus, value_mult, (IH c _ _ E'), E0. unfold over. fold d.
    field. generalize d_pos. lra.
  Qed.

  Lemma value_times c c' x : forall x' y y',
    map (value K) y = map (Rmult c) x -> map (value K) y' = map (Rmult c') x' ->
    map (value K) (times_K K y y') = map (Rmult (c * c')) (times x x').
  Proof.
    induction x as [|x0 x IH]; intros [|x0' x'] [|y0 y] [|y0' y']; try discriminate; intros E E'; cbn; try reflexivity.
    injection E; intros R0 V0. injection E'; intros R1 V1. rewrite value_mult, V0, V1.
    f_equal; [ring | now apply IH].
  Qed.

  Lemma value_sums stages t : map (value K) stages = map (Rmult (d ^ (vertices t - 1))) (Trees.stages real_A real_b
    t) ->
    map (value K) (map (fun row => dot_K K row stages) A)
    = map (Rmult (d ^ vertices t)) (map (fun row => dot row (Trees.stages real_A real_b t)) real_A).
  Proof.
    intros E. unfold real_A at 2. rewrite !map_map. apply map_ext. intros row. rewrite (value_dot _ _ _ _ E).
    now rewrite power_of_vertices.
  Qed.
  Lemma value_stages t : map (value K) (stages_of K (entry_of K A b t))
    = map (Rmult (d ^ (vertices t - 1))) (stages real_A real_b t).
  Proof.
    induction t as [|t IH u IH']; cbn [entry_of single grafted kept snd stages_of stages vertices].
    - unfold real_b. rewrite !map_map. apply map_ext. intros _. rewrite value_of_Z. cbn. ring.
    - unfold sums. rewrite (value_times _ _ _ _ _ _ IH (value_sums _ _ IH')), <- pow_add. do 3 f_equal.
      generalize (vertices_pos t), (vertices_pos u). lia.
  Qed.

  (** The check: all trees with up to p vertices in integers. *)
  Theorem order_at_least p : passes K A b holds p = true ->
    forall t, (vertices t <= p)%nat -> meets real_A real_b t.
  Proof.
    intros H t size. apply (tree_passes K A b holds p t H) in size as E. unfold holds in E. apply value_same in E.
    revert E.
    rewrite value_mult, !value_of_Z, (value_dot _ _ _ _ (value_stages t)), mult_IZR, branches_of_entry, <- INR_IZR_INZ.
    intros E. unfold meets, weight, density. rewrite mult_INR. fold real_b in E.
    apply Rmult_eq_reg_l with (d ^ vertices t); [|apply Rgt_not_eq, pow_lt, d_pos].
    rewrite Rmult_1_r. replace (IZR (D ^ Z.of_nat (vertices t))) with (d ^ vertices t) in E by apply pow_IZR.
    etransitivity; [|exact E]. rewrite power_of_vertices. ring.
  Qed.

  (** What the condition of one tree misses, times D^n. *)
  Definition residual (t : tree) : K :=
    let e := entry_of K A b t in let n := Z.of_nat (vertices t) in
    plus K (mult K (dot_K K b (stages_of K e)) (of_Z K (n * branches_of K e))) (of_Z K (- D ^ n)).

  Theorem residual_not_met t : value K (residual t) <> 0 -> ~ meets real_A real_b t.
  Proof.
    unfold residual. cbv zeta. rewrite value_plus, value_mult, !value_of_Z, (value_dot _ _ _ _ (value_stages t)).
    rewrite mult_IZR, branches_of_entry, <- INR_IZR_INZ, opp_IZR.
    intros H E. apply H. unfold meets, weight, density in E. rewrite mult_INR in E.
    replace (IZR (D ^ Z.of_nat (vertices t))) with (d ^ vertices t) by apply pow_IZR.
    rewrite power_of_vertices. fold real_b. apply Rminus_diag_eq in E.
    transitivity (d * d ^ (vertices t - 1)
      * (dot real_b (stages real_A real_b t) * (INR (vertices t) * INR (branches t)) - 1)); [|rewrite E]; ring.
  Qed.
End Exactly.

(** The integers of a number field: polynomials of degree below n in a root a of X^n = r_0 + r_1 X + ..., by their
    coefficients, constant term first. For the integers themselves take X = 0. *)
Section Field.
  Variables (r : list bigZ) (a : R).
  Definition big_value (x : bigZ) : R := IZR [x]%bigZ.
  Fixpoint at_root (x : list bigZ) : R :=
    match x with [] => 0 | c :: x => big_value c + a * at_root x end.
  Hypothesis a_is_root : a ^ length r = at_root r.

  Fixpoint sum (x y : list bigZ) : list bigZ :=
    match x, y with c :: x, c' :: y => BigZ.add c c' :: sum x y | [], y => y | x, [] => x end.
  Definition scaled (c : bigZ) (x : list bigZ) : list bigZ := map (BigZ.mul c) x.
  (** X times x; where x has as many coefficients as r, its last one becomes a multiple of r. *)
  Definition shifted (x : list bigZ) : list bigZ :=
    if (length x =? length r)%nat then sum (BigZ.zero :: removelast x) (scaled (last x BigZ.zero) r)
    else BigZ.zero :: x.
  Fixpoint product (x y : list bigZ) : list bigZ :=
    match x with [] => [] | c :: x => sum (scaled c y) (shifted (product x y)) end.
  Definition zero (x : list bigZ) : bool := forallb (BigZ.eqb BigZ.zero) x.
  Definition equal (x y : list bigZ) : bool := zero (sum x (scaled (BigZ.opp BigZ.one) y)).

  Lemma at_sum : forall x y, at_root (sum x y) = at_root x + at_root y.
  Proof.
    induction x as [|c x IH]; intros [|c' y]; cbn [sum at_root]; try ring.
    unfold big_value. rewrite IH, BigZ.spec_add, plus_IZR. ring.
  Qed.

  Lemma at_scaled c x : at_root (scaled c x) = big_value c * at_root x.
  Proof.
    induction x as [|c' x IH]; cbn [scaled map at_root]; [ring|]. unfold scaled in IH. rewrite IH.
    unfold big_value. rewrite BigZ.spec_mul, mult_IZR. ring.
  Qed.

  Lemma at_app x y : at_root (x ++ y) = at_root x + a ^ length x * at_root y.
  Proof. induction x as [|c x IH]; cbn [app at_root length pow]; [ring|]. rewrite IH. ring. Qed.

  Lemma zero_value : big_value BigZ.zero = 0.
  Proof. unfold big_value. now rewrite BigZ.spec_0. Qed.

  Lemma at_shifted x : at_root (shifted x) = a * at_root x.
  Proof.
    unfold shifted. destruct (Nat.eqb_spec (length x) (length r)) as [E|]; cbn [at_root]; [|rewrite zero_value; ring].
    destruct x as [|c x _] using rev_ind.
    - rewrite at_sum, at_scaled. cbn [removelast last at_root]. rewrite zero_value. ring.
    - rewrite app_length in E. cbn [length] in E.
      rewrite removelast_last, last_last, at_sum, at_scaled, <- a_is_root, <- E, at_app, Nat.add_1_r.
      cbn [at_root pow]. rewrite zero_value. ring.
  Qed.

  Lemma at_product x y : at_root (product x y) = at_root x * at_root y.
  Proof.
    induction x as [|c x IH]; cbn [product at_root]; [ring|]. rewrite at_sum, at_scaled, at_shifted, IH. ring.
  Qed.

  Lemma at_zero x : zero x = true -> at_root x = 0.
  Proof.
    induction x as [|c x IH]; cbn [zero forallb at_root]; [reflexivity|]. intros E. apply andb_prop in E as [E E'].
    apply BigZ.eqb_eq in E. unfold BigZ.eq in E. unfold big_value. rewrite <- E, BigZ.spec_0, (IH E'). ring.
  Qed.

  Lemma at_equal x y : equal x y = true -> at_root x = at_root y.
  Proof.
    intros E. apply at_zero in E. rewrite at_sum, at_scaled in E. unfold big_value in E.
    rewrite BigZ.spec_opp, BigZ.spec_1, opp_IZR in E. lra.
  Qed.

  Lemma at_integer z : at_root [BigZ.of_Z z] = IZR z.
  Proof. cbn [at_root]. unfold big_value. rewrite BigZ.spec_of_Z. ring. Qed.

  Definition field_integers : ring :=
    {| ring_numbers := {| element := list bigZ; plus := sum; mult := product; of_Z z := [BigZ.of_Z z] |};
       same := equal; value := at_root;
       value_plus := at_sum; value_mult := at_product; value_of_Z := at_integer; value_same := at_equal |}.
End Field.

(** A Runge-Kutta method with coefficients in a number field: integers of it, over a common denominator. The root that
    is meant is the one between two rationals. *)
Record table := {
  written_relation : list Z; low : Q; high : Q;
  denominator : Z; written_matrix : list (list (list Z)); written_weights : list (list Z)
}.
Definition relation (t : table) : list bigZ := map BigZ.of_Z (written_relation t).
Definition matrix (t : table) : list (list (list bigZ)) := map (map (map BigZ.of_Z)) (written_matrix t).
Definition weights (t : table) : list (list bigZ) := map (map BigZ.of_Z) (written_weights t).
Definition is_root (t : table) (a : R) : Prop :=
  Q2R (low t) <= a <= Q2R (high t) /\ a ^ length (relation t) = at_root a (relation t).
Definition coefficient (t : table) (a : R) (x : list bigZ) : R := at_root a x / IZR (denominator t).
Definition has_order (t : table) (p : nat) : Prop :=
  (exists a, is_root t a) /\ forall a, is_root t a ->
    order (map (map (coefficient t a)) (matrix t)) (map (coefficient t a) (weights t)) p.

(** Bounds of a polynomial on an interval of non-negative numbers. *)
Fixpoint bounds (l h : Q) (x : list bigZ) : Q * Q :=
  match x with
  | [] => (0, 0)%Q
  | c :: x => let (m, n) := bounds l h x in
              let c := inject_Z [c]%bigZ in
              (Qred (c + (if Qle_bool 0 m then l else h) * m), Qred (c + (if Qle_bool 0 n then h else l) * n))%Q
  end.

Lemma bounds_hold l h a : 0 <= Q2R l <= a -> a <= Q2R h -> forall x,
  Q2R (fst (bounds l h x)) <= at_root a x <= Q2R (snd (bounds l h x)).
Proof.
  intros low high x. induction x as [|c x IH]; [cbn; unfold Q2R; cbn; lra|].
  cbn [bounds at_root]. destruct (bounds l h x) as [m n]. cbn [fst snd] in *.
  rewrite !(Qeq_eqR _ _ (Qred_correct _)), !Q2R_plus, !Q2R_mult.
  replace (Q2R (inject_Z [c]%bigZ)) with (big_value c) by (unfold big_value, Q2R; cbn; field).
  split.
  - destruct (Qle_bool 0 m) eqn:E.
    + apply Qle_bool_iff, Qle_Rle in E. unfold Q2R at 1 in E. cbn in E. nra.
    + assert (Q2R m <= 0); [|nra]. apply Rnot_lt_le. intros P. apply Rlt_le in P.
      replace 0 with (Q2R 0) in P by (unfold Q2R; cbn; lra). apply Rle_Qle, Qle_bool_iff in P. congruence.
  - destruct (Qle_bool 0 n) eqn:E.
    + apply Qle_bool_iff, Qle_Rle in E. unfold Q2R at 1 in E. cbn in E. nra.
    + assert (Q2R n <= 0); [|nra]. apply Rnot_lt_le. intros P. apply Rlt_le in P.
      replace 0 with (Q2R 0) in P by (unfold Q2R; cbn; lra). apply Rle_Qle, Qle_bool_iff in P. congruence.
Qed.

Definition apart (l h : Q) (x : list bigZ) : bool :=
  let (m, n) := bounds l h x in negb (Qle_bool m 0) || negb (Qle_bool 0 n).

Lemma apart_not_zero l h a x : 0 <= Q2R l <= a -> a <= Q2R h -> apart l h x = true -> at_root a x <> 0.
Proof.
  intros low high E Z. generalize (bounds_hold l h a low high x). unfold apart in E.
  destruct (bounds l h x) as [m n]. cbn [fst snd]. rewrite Z. intros [Lm Ln].
  replace 0 with (Q2R 0) in Lm, Ln by (unfold Q2R; cbn; lra).
  apply Rle_Qle, Qle_bool_iff in Lm, Ln. rewrite Lm, Ln in E. discriminate.
Qed.

Fixpoint power (x : Q) (n : nat) : Q := match n with O => 1 | S n => Qred (x * power x n) end.

Lemma Q2R_power x n : Q2R (power x n) = Q2R x ^ n.
Proof.
  induction n as [|n IH]; cbn [power pow]; [unfold Q2R; cbn; field|].
  now rewrite (Qeq_eqR _ _ (Qred_correct _)), Q2R_mult, IH.
Qed.

(** The relation's two sides change places between the two rationals. *)
Definition crosses (t : table) : bool :=
  let below x := Qle_bool (power x (length (relation t))) (fst (bounds x x (relation t))) in
  let above x := Qle_bool (snd (bounds x x (relation t))) (power x (length (relation t))) in
  Qle_bool 0 (low t) && Qle_bool (low t) (high t)
  && (below (low t) && above (high t) || above (low t) && below (high t)).

Lemma continuous_at_root x : continuity (fun a => at_root a x).
Proof.
  induction x as [|c x IH]; cbn [at_root]; [apply continuity_const; now intros ? ?|].
  apply continuity_plus; [apply continuity_const; now intros ? ?|].
  apply continuity_mult; [apply derivable_continuous, derivable_id | exact IH].
Qed.

Lemma root_exists t : crosses t = true -> exists a, is_root t a.
Proof.
  unfold crosses. intros E. do 2 apply andb_prop in E as [E ?].
  apply Qle_bool_iff, Qle_Rle in E, H0. replace (Q2R 0) with 0 in E by (unfold Q2R; cbn; lra).
  generalize (bounds_hold (low t) (low t) (Q2R (low t)) ltac:(lra) ltac:(lra) (relation t)).
  generalize (bounds_hold (high t) (high t) (Q2R (high t)) ltac:(lra) ltac:(lra) (relation t)). intros Bh Bl.
  set (f := fun a => a ^ length (relation t) - at_root a (relation t)).
  assert (f (Q2R (low t)) * f (Q2R (high t)) <= 0).
  { apply orb_prop in H as [S|S]; apply andb_prop in S as [S S'];
      apply Qle_bool_iff, Qle_Rle in S, S'; rewrite Q2R_power in S, S'.
    - assert (f (Q2R (low t)) <= 0) by (unfold f; lra). assert (0 <= f (Q2R (high t))) by (unfold f; lra). nra.
    - assert (0 <= f (Q2R (low t))) by (unfold f; lra). assert (f (Q2R (high t)) <= 0) by (unfold f; lra). nra. }
  destruct (IVT_cor f (Q2R (low t)) (Q2R (high t))) as (a & inside & root); [| assumption | assumption |].
  - apply continuity_minus; [apply derivable_continuous, derivable_pow | apply continuous_at_root].
  - exists a. split; [assumption | unfold f in root; lra].
Qed.

(** What is computed of a table: its root is there, the trees with up to p vertices meet their conditions, and this one,
    with p + 1, does not. *)
Definition order_is_checked (t : table) (p : nat) (failing : tree) : Prop :=
  (crosses t && (0 <? denominator t)%Z && (vertices failing =? S p)%nat = true)
  /\ forall a root, let K := field_integers (relation t) a root in
     passes K (matrix t) (weights t) (holds K (weights t) (denominator t)) p
     && apart (low t) (high t) (residual K (matrix t) (weights t) (denominator t) failing) = true.

Theorem order_of_check t p failing : order_is_checked t p failing -> has_order t p.
Proof.
  intros [easy hard]. do 2 apply andb_prop in easy as [easy ?].
  apply Z.ltb_lt in H0. apply Nat.eqb_eq in H.
  split; [now apply root_exists|]. intros a [inside root]. specialize (hard a root). cbv zeta in hard.
  apply andb_prop in hard as [all one].
  split; [exact (order_at_least _ _ _ _ H0 _ all)|]. exists failing. split; [exact H|].
  apply (residual_not_met (field_integers (relation t) a root) _ _ _ H0).
  apply (apart_not_zero (low t) (high t)); try apply inside; [|exact one].
  unfold crosses in easy. do 2 apply andb_prop in easy as [easy ?]. apply Qle_bool_iff, Qle_Rle in easy.
  replace (Q2R 0) with 0 in easy by (unfold Q2R; cbn; lra). split; [exact easy | apply inside].
Qed.

(** A check is computed once, where the kernel reads the proof. *)
Ltac by_check := vm_cast_no_check (eq_refl true).
Ltac by_order failing := apply (order_of_check _ _ failing); split; [|intros a root]; by_check.
