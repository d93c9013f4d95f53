(** How errors fall with the step, and where a smaller step does not help. *)

From Coq Require Import QArith Qabs Qreals Reals Lra Lia Psatz List.
From driftproof Require Import Runs Tables OneStep Energy Stability ExactFlow Phase Trees Orders OrdersOfTables.
Open Scope R_scope.

(** A rational table as the method whose steps are taken: the coefficients below the diagonal. *)
Definition as_method (t : table) : method :=
  let q x := Qred (hd 0%Z x # Z.to_pos (denominator t)) in
  let rows := map (map q) (written_matrix t) in
  RungeKutta (map (fun p => firstn (fst p) (snd p)) (combine (seq 0 (length rows)) rows)) (map q (written_weights t)).

Definition error (m : method) (h : Q) (n : nat) (t : R) : R := distance (to_R (run m h n start)) (flow t).

(** Two drawings of one rooted tree: branches in another order. Those with up to four vertices are of eight trees. *)
Inductive alike : tree -> tree -> Prop :=
| the_same t : alike t t
| branches_change_places t u v : alike (graft (graft t u) v) (graft (graft t v) u)
| in_their_parts t t' u u' : alike t t' -> alike u u' -> alike (graft t u) (graft t' u')
| by_way_of t u v : alike t u -> alike u v -> alike t v.
Lemma alike_density t u : alike t u -> density t = density u.
Proof.
  intros A. enough (vertices t = vertices u /\ branches t = branches u) as [V B] by (unfold density; lia).
  induction A; cbn [vertices branches]; intuition nia.
Qed.
Definition eight : list tree :=
  let line := graft vertex vertex in let fork := graft line vertex in let path := graft vertex line in
  (vertex :: line :: fork :: path :: graft fork vertex :: graft line line :: graft vertex fork :: graft vertex path
    :: nil)%list.
Ltac one_of_eight := unfold eight; cbn; repeat first [left; reflexivity | right].
Lemma eight_trees : length eight = 8%nat /\ (forall t, (vertices t <= 4)%nat -> exists u, List.In u eight /\ alike t u)
  /\ forall t u, List.In t eight -> List.In u eight -> alike t u -> t = u.
Proof.
  split; [reflexivity | split].
  - assert (one : forall t, vertices t = 1%nat -> t = vertex).
    { intros [|a b] E; [reflexivity|]. cbn in E. generalize (vertices_pos a), (vertices_pos b). lia. }
    assert (two : forall t, vertices t = 2%nat -> t = graft vertex vertex).
    { intros [|a b] E; [discriminate|]. cbn in E. generalize (vertices_pos a), (vertices_pos b). intros.
      f_equal; apply one; lia. }
    assert (three : forall t, vertices t = 3%nat ->
      t = graft (graft vertex vertex) vertex \/ t = graft vertex (graft vertex vertex)).
    { intros [|a b] E; [discriminate|]. cbn in E. generalize (vertices_pos a), (vertices_pos b). intros.
      assert (vertices a = 2 \/ vertices a = 1)%nat as [A|A] by lia; [left | right]; f_equal;
        (apply one + apply two); lia. }
    intros t small. assert (vertices t = 1 \/ vertices t = 2 \/ vertices t = 3 \/ vertices t = 4)%nat as [E|[E|[E|E]]]
      by (generalize (vertices_pos t); lia).
    1: apply one in E; subst t. 2: apply two in E; subst t. 3: apply three in E as [-> | ->].
    1-4: eexists; split; [|apply the_same]; one_of_eight.
    destruct t as [|a b]; [discriminate|]. cbn in E. generalize (vertices_pos a), (vertices_pos b). intros.
    assert (vertices a = 3 \/ vertices a = 2 \/ vertices a = 1)%nat as [A|[A|A]] by lia.
    + rewrite (one b) by lia. apply three in A as [-> | ->]; eexists; split.
      2: apply the_same. 3: apply branches_change_places. all: one_of_eight.
    + rewrite (two a), (two b) by lia. eexists; split; [|apply the_same]. one_of_eight.
    + rewrite (one a) by lia. assert (B : vertices b = 3%nat) by lia.
      apply three in B as [-> | ->]; eexists; (split; [|apply the_same]); one_of_eight.
  - intros t u T U A. apply alike_density in A. cbn in T, U.
    repeat (destruct T as [<- | T]; [repeat (destruct U as [<- | U]; [reflexivity || discriminate|]); destruct U|]).
    destruct T.
Qed.

Theorem L058 : Tables.rk4 = as_method rk4 /\ evaluations Tables.rk4 = 4%nat /\ has_order rk4 4
  /\ length eight = 8%nat /\ (forall t, (vertices t <= 4)%nat -> exists u, List.In u eight /\ alike t u)
  /\ forall t u, List.In t eight -> List.In u eight -> alike t u -> t = u.
Proof. split; [reflexivity | split; [reflexivity | split; [exact order_of_rk4 | exact eight_trees]]]. Qed.

Theorem L143 :
  let energy_error m h n := Rabs (energy (to_R (run m h n start)) - 1 / 2) in
  error Tables.forward_euler (1#10) 100 10 < error Tables.forward_euler (1#4) 40 10
  /\ error symplectic_euler (1#10) 100 10 < error symplectic_euler (1#4) 40 10
  /\ error Tables.rk4 (1#10) 100 10 < error Tables.rk4 (1#4) 40 10
  /\ energy_error Tables.forward_euler (1#10)%Q 100%nat < energy_error Tables.forward_euler (1#4)%Q 40%nat
  /\ energy_error symplectic_euler (1#10)%Q 100%nat < energy_error symplectic_euler (1#4)%Q 40%nat
  /\ energy_error Tables.rk4 (1#10)%Q 100%nat < energy_error Tables.rk4 (1#4)%Q 40%nat
  /\ error Tables.forward_euler (5#2) 4 10 < error Tables.forward_euler 2 5 10.
Proof. cbv zeta. unfold error. by_interval. Qed.

Theorem L147 : (error symplectic_euler (1#2) 20 10 ≈ 0.250082)%R /\ 1 / 4 < error symplectic_euler (1#2) 20 10.
Proof. unfold error. by_interval. Qed.

Theorem L148 : 48 * error Tables.rk4 (1#2) 20 10 < error symplectic_euler (1#2) 20 10.
Proof. unfold error. by_interval. Qed.

Theorem L151 : 143 < degrees (5 / 2) < 144.
Proof. unfold degrees. by_interval. Qed.

Theorem L193 : 2.785 * error symplectic_euler (1#4) 40 10 < error symplectic_euler (1#2) 20 10
  /\ error symplectic_euler (1#2) 20 10 < 2.79 * error symplectic_euler (1#4) 40 10.
Proof. unfold error. by_interval. Qed.

Theorem L244 : (100 * evaluations Tables.forward_euler = 25 * evaluations Tables.rk4)%nat
  /\ 290 * error Tables.rk4 (2#5) 25 10 < error Tables.forward_euler (1#10) 100 10
  /\ error Tables.rk4 (2#5) 25 10 < 0.0022 /\ 0.64 < error Tables.forward_euler (1#10) 100 10.
Proof. split; [reflexivity|]. unfold error. by_interval. Qed.

(** As h -> 0 at a fixed T the energy of n steps of T/n goes to that of the start, so that E(T)/E0 goes to 1; at a fixed
    step it exceeds every bound. *)
Theorem L041 :
  (forall T z, is_lim_seq (fun n => energy (run Tables.forward_euler (T / INR (S n)) (S n) z)) (energy z))
  /\ forall h B, 0 < h -> exists n, B < energy (run Tables.forward_euler h n (1, 0)).
Proof.
  split; [|intros h B positive; apply (proj1 (L040 h 1 0 positive)); injection; lra]. intros T z.
  apply is_lim_seq_ext with (fun n => (1 + (T / INR (S n)) ^ 2) ^ S n * energy z); [intros n; now rewrite L038|].
  assert (vanishes : is_lim_seq (fun n => T ^ 2 * / INR (S n)) (T ^ 2 * 0)).
  { apply is_lim_seq_scal_l with (lu := Finite 0). apply is_lim_seq_inv with (l := p_infty); [|easy].
    apply -> is_lim_seq_incr_1. apply is_lim_seq_INR. }
  replace (Finite (energy z)) with (Finite (1 * energy z)) by (f_equal; ring).
  apply is_lim_seq_mult'; [|apply is_lim_seq_const].
  apply is_lim_seq_le_le with (u := fun _ => 1) (w := fun n => exp (T ^ 2 * / INR (S n))).
  - intros n. assert (P : 0 < INR (S n)) by (apply lt_0_INR; lia). assert (Sq := pow2_ge_0 (T / INR (S n))).
    generalize (pow_R1_Rle (1 + (T / INR (S n)) ^ 2) (S n)), (pow_le_exp _ (S n) Sq).
    replace (INR (S n) * (T / INR (S n)) ^ 2) with (T ^ 2 * / INR (S n)) by (field; lra). lra.
  - apply is_lim_seq_const.
  - replace (Finite 1) with (Finite (exp (T ^ 2 * 0))) by (rewrite Rmult_0_r, exp_0; reflexivity).
    apply (is_lim_seq_continuous exp); [apply derivable_continuous_pt, derivable_pt_exp | exact vanishes].
Qed.

Lemma mean_value f f' a b : a < b -> (forall x, a <= x <= b -> is_derive f x (f' x)) ->
  exists c, a <= c <= b /\ f b - f a = f' c * (b - a).
Proof.
  intros less D. destruct (MVT_gen f a b f') as (c & inside & E); rewrite ?Rmin_left, ?Rmax_right in * by lra.
  - intros x inside. apply D. lra.
  - intros x inside. apply derivable_continuous_pt. exists (f' x). apply is_derive_Reals, D, inside.
  - now exists c.
Qed.

(** The exponent T log (1 + h^2)/h of the growth over a fixed time T rises with h up to 1.98029... and falls after. *)
Definition growth (h : R) : R := ln (1 + h ^ 2) / h.
Theorem L039 :
  (forall h, 0 < h <= 1.98029 -> exists slope, 0 < slope /\ is_derive growth h slope)
  /\ (forall h, 1.98030 <= h -> exists slope, slope < 0 /\ is_derive growth h slope)
  /\ energy (run Tables.forward_euler 2 5 (1, 0)) / (1 / 2) = 3125
  /\ energy (run Tables.forward_euler (5 / 2) 4 (1, 0)) / (1 / 2) = (29 / 4) ^ 4 /\ (29 / 4) ^ 4 < 3125.
Proof.
  set (s := fun x => 2 * x / (1 + x) - ln (1 + x)).
  assert (Ds : forall x, 0 <= x -> is_derive s x ((1 - x) / (1 + x) ^ 2)).
  { intros x positive. unfold s. auto_derive; [repeat split; lra|]. real_field. lra. }
  assert (Dg : forall h, 0 < h -> is_derive growth h (s (h ^ 2) / h ^ 2)).
  { intros h positive. assert (0 < h ^ 2) by nra. unfold growth, s. auto_derive; [repeat split; nra|].
    replace (1 + h * (h * 1)) with (1 + h ^ 2) by ring. generalize (ln (1 + h ^ 2)). intros l. real_field. split; nra. }
  assert (rises : forall x, 0 < x <= 1 -> 0 < s x).
  { intros x inside. destruct (mean_value s (fun x => (1 - x) / (1 + x) ^ 2) 0 x) as (c & C & E);
      [lra | intros; apply Ds; lra |].
    assert (zero : s 0 = 0) by (unfold s; rewrite Rplus_0_r, ln_1; field).
    destruct (Req_dec c 1) as [->|]; [replace x with 1 by lra; unfold s; interval|].
    assert (0 < (1 - c) / (1 + c) ^ 2) by (apply Rdiv_lt_0_compat; nra). nra. }
  assert (falls : forall x y, 1 <= x -> x < y -> s y <= s x).
  { intros x y one less. destruct (mean_value s (fun x => (1 - x) / (1 + x) ^ 2) x y) as (c & C & E);
      [lra | intros; apply Ds; lra |].
    assert (0 <= (c - 1) / (1 + c) ^ 2) by (apply Rmult_le_pos; [lra | apply Rlt_le, Rinv_0_lt_compat; nra]).
    replace ((1 - c) / (1 + c) ^ 2) with (- ((c - 1) / (1 + c) ^ 2)) in E by (field; lra). nra. }
  assert (0 < s (1.98029 ^ 2)) by (unfold s; interval with (i_prec 80)).
  assert (s (1.98030 ^ 2) < 0) by (unfold s; interval with (i_prec 80)).
  split; [|split; [|split; [|split]]].
  - intros h inside. exists (s (h ^ 2) / h ^ 2). split; [|apply Dg; lra].
    apply Rdiv_lt_0_compat; [|nra]. destruct (Rle_dec (h ^ 2) 1); [apply rises; nra|].
    destruct (Req_dec h 1.98029) as [->|]; [assumption|].
    generalize (falls (h ^ 2) (1.98029 ^ 2) ltac:(lra) ltac:(nra)). lra.
  - intros h large. exists (s (h ^ 2) / h ^ 2). split; [|apply Dg; lra].
    assert (s (h ^ 2) < 0).
    { destruct (Req_dec h 1.98030) as [->|]; [assumption|].
      generalize (falls (1.98030 ^ 2) (h ^ 2) ltac:(lra) ltac:(nra)). lra. }
    apply Ropp_lt_cancel. rewrite Ropp_0.
    replace (- (s (h ^ 2) / h ^ 2)) with (- s (h ^ 2) / h ^ 2) by (field; nra). apply Rdiv_lt_0_compat; nra.
  - rewrite L038. replace (energy (1, 0)) with (1 / 2) by by_ring. field.
  - rewrite L038. replace (energy (1, 0)) with (1 / 2) by by_ring. field.
  - lra.
Qed.

Lemma symplectic_at_2 : ~ bounded symplectic_euler 2.
Proof.
  intros all. destruct (all (1, 0)) as [B within].
  assert (exists n, Rabs B < INR n) as [n above].
  { exists (Z.to_nat (up (Rabs B))). rewrite INR_IZR_INZ, Z2Nat.id; [apply archimed|].
    apply le_IZR. generalize (Rabs_pos B), (proj1 (archimed (Rabs B))). lra. }
  specialize (within n). rewrite (proj1 (L165 n)) in within.
  assert (One : ((-1) ^ n) * ((-1) ^ n) = 1)
    by (rewrite <- Rpow_mult_distr; replace (-1 * -1) with 1 by ring; apply pow1).
  assert (E : energy ((-1) ^ n * (2 * INR n + 1), (-1) ^ n * (2 * INR n))
              = (-1) ^ n * (-1) ^ n * (4 * INR n * INR n + 2 * INR n + 1 / 2))
    by (generalize ((-1) ^ n), (INR n); by_ring).
  rewrite E, One in within. generalize (Rle_abs B), (pos_INR n). nra.
Qed.

(** Every step that is not negative: M = I at h = 0, too; forward Euler for comparison. *)
Theorem T04 : (forall h, 0 <= h -> (bounded symplectic_euler h <-> h < 2))
  /\ forall h, 0 < h -> ~ bounded Tables.forward_euler h.
Proof.
  split; intros h positive.
  - split; [intros all; apply Rnot_le_lt; intros [large | <-]|].
    + now apply (symplectic_unbounded h).
    + now apply symplectic_at_2.
    + intros small. destruct positive as [positive | <-]; [now apply symplectic_bounded|].
    intros [q v]. exists (energy (q, v)). intros n. apply Req_le.
      induction n as [|n IH]; cbn [run]; [reflexivity|]. rewrite <- IH.
      destruct (run symplectic_euler 0 n (q, v)) as [x y]. by_ring.
  - intros all. destruct (all (1, 0)) as [B within].
    destruct (proj1 (L040 h 1 0 positive) ltac:(injection; lra) B) as [n above]. specialize (within n). lra.
Qed.

(** Two runs that are back at their start after t = 12, one of a bounded step and one of a step that is not; two methods
    of one cost; and two bounded steps that differ in energy, phase and cost. *)
Theorem L003 :
  (fst (run symplectic_euler 1 12 (1, 1)) == 1 /\ snd (run symplectic_euler 1 12 (1, 1)) == 1
   /\ fst (run symplectic_euler 2 6 (1, 1)) == 1 /\ snd (run symplectic_euler 2 6 (1, 1)) == 1)%Q
  /\ bounded symplectic_euler 1 /\ ~ bounded symplectic_euler 2
  /\ evaluations Tables.forward_euler = evaluations symplectic_euler
  /\ ~ bounded Tables.forward_euler (1 / 2) /\ bounded symplectic_euler (1 / 2) /\ bounded Tables.rk4 (1 / 2)
  /\ energy (to_R (run symplectic_euler (1#2) 20 start)) < energy (to_R (run Tables.rk4 (1#2) 20 start))
  /\ phase_error (to_R (run Tables.rk4 (1#2) 20 start)) (flow 10) < 0
  /\ 0 < phase_error (to_R (run symplectic_euler (1#2) 20 start)) (flow 10)
  /\ evaluations Tables.rk4 <> evaluations symplectic_euler.
Proof.
  split; [by_vm|]. parts.
  - apply symplectic_bounded; lra.
  - apply symplectic_at_2.
  - reflexivity.
  - apply (proj2 T04); lra.
  - apply symplectic_bounded; lra.
  - apply L175; [lra|]. assert (1 <= sqrt 2) by (rewrite <- sqrt_1; apply sqrt_le_1; lra). lra.
  - by_interval.
  - by_angle.
  - by_angle.
  - discriminate.
Qed.

(** What the series of the cosine and the sine leave, for h >= 0: each by the sign of the one before. *)
Lemma nonneg_of_derivative f f' : f 0 = 0 -> (forall x, 0 <= x -> is_derive f x (f' x)) ->
  (forall x, 0 <= x -> 0 <= f' x) -> forall x, 0 <= x -> 0 <= f x.
Proof.
  intros zero D sign x [positive | <-]; [|lra].
  destruct (mean_value f f' 0 x positive) as (c & C & E); [intros; apply D; lra|].
  generalize (sign c ltac:(lra)). nra.
Qed.

Ltac by_series f f' previous :=
  intros x positive; cut (0 <= f x); [lra|];
  apply (nonneg_of_derivative f f'); [rewrite ?cos_0, ?sin_0; field | | | assumption];
  intros y Y; [auto_derive; trivial; real_field | generalize (previous y Y); lra].

Lemma sin_1 : forall x, 0 <= x -> sin x <= x.
Proof.
  by_series (fun x => x - sin x) (fun x => 1 - cos x) (fun y (_ : 0 <= y) => COS_bound y).
Qed.
Lemma cos_2 : forall x, 0 <= x -> 1 - x ^ 2 / 2 <= cos x.
Proof. by_series (fun x => cos x - (1 - x ^ 2 / 2)) (fun x => x - sin x) sin_1. Qed.
Lemma sin_3 : forall x, 0 <= x -> x - x ^ 3 / 6 <= sin x.
Proof. by_series (fun x => sin x - (x - x ^ 3 / 6)) (fun x => cos x - (1 - x ^ 2 / 2)) cos_2. Qed.
Lemma cos_4 : forall x, 0 <= x -> cos x <= 1 - x ^ 2 / 2 + x ^ 4 / 24.
Proof. by_series (fun x => 1 - x ^ 2 / 2 + x ^ 4 / 24 - cos x) (fun x => sin x - (x - x ^ 3 / 6)) sin_3. Qed.
Lemma sin_5 : forall x, 0 <= x -> sin x <= x - x ^ 3 / 6 + x ^ 5 / 120.
Proof.
  by_series (fun x => x - x ^ 3 / 6 + x ^ 5 / 120 - sin x) (fun x => 1 - x ^ 2 / 2 + x ^ 4 / 24 - cos x) cos_4.
Qed.
Lemma cos_6 : forall x, 0 <= x -> 1 - x ^ 2 / 2 + x ^ 4 / 24 - x ^ 6 / 720 <= cos x.
Proof.
  by_series (fun x => cos x - (1 - x ^ 2 / 2 + x ^ 4 / 24 - x ^ 6 / 720))
    (fun x => x - x ^ 3 / 6 + x ^ 5 / 120 - sin x) sin_5.
Qed.
Lemma sin_7 : forall x, 0 <= x -> x - x ^ 3 / 6 + x ^ 5 / 120 - x ^ 7 / 5040 <= sin x.
Proof.
  by_series (fun x => sin x - (x - x ^ 3 / 6 + x ^ 5 / 120 - x ^ 7 / 5040))
    (fun x => cos x - (1 - x ^ 2 / 2 + x ^ 4 / 24 - x ^ 6 / 720)) cos_6.
Qed.

Lemma cos_8 : forall x, 0 <= x -> cos x <= 1 - x ^ 2 / 2 + x ^ 4 / 24 - x ^ 6 / 720 + x ^ 8 / 40320.
Proof.
  by_series (fun x => 1 - x ^ 2 / 2 + x ^ 4 / 24 - x ^ 6 / 720 + x ^ 8 / 40320 - cos x)
    (fun x => sin x - (x - x ^ 3 / 6 + x ^ 5 / 120 - x ^ 7 / 5040)) sin_7.
Qed.

(** RK4's position from (1, 0) is above the cosine, at every step. *)
Theorem L065 : (forall h, 0 < h -> fst (step Tables.rk4 h (1, 0)) <> cos h)
  /\ forall h, 2 * sqrt 2 < h -> ~ bounded Tables.rk4 h.
Proof.
  split; intros h large.
  - replace (fst (step Tables.rk4 h (1, 0))) with (1 - h ^ 2 / 2 + h ^ 4 / 24) by by_ring.
    apply Rgt_not_eq. destruct (Rle_dec h (7 / 2)).
    + assert (C := cos_8 h (Rlt_le _ _ large)). assert (0 < h ^ 6) by (apply pow_lt; lra).
      assert (h ^ 8 <= 13 * h ^ 6); [|lra].
      replace (h ^ 8) with (h ^ 2 * h ^ 6) by ring. apply Rmult_le_compat_r; nra.
    + assert (C := COS_bound h). assert (12 < h ^ 2) by nra.
      assert (0 < h ^ 2 * (h ^ 2 - 12)) by (apply Rmult_lt_0_compat; lra).
      replace (h ^ 4) with (h ^ 2 * h ^ 2) by ring. lra.
  - intros all. assert (0 < sqrt 2) by (apply sqrt_lt_R0; lra). apply L175 in all; lra.
Qed.

(** The exact state after h, and how far z + (a, b) is from another state. *)
Definition after (h : R) (z : state R) : state R :=
  (fst z * cos h + snd z * sin h, snd z * cos h - fst z * sin h).
Definition within (z a w : state R) (bound : R) : Prop :=
  Rabs (fst z + fst a - fst w) <= bound /\ Rabs (snd z + snd a - snd w) <= bound.

Lemma combination_small x y q v d : Rabs x <= d -> Rabs y <= d -> Rabs (x * q + y * v) <= d * (Rabs q + Rabs v).
Proof.
  intros X Y. eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult, Rmult_plus_distr_l.
  apply Rplus_le_compat; apply Rmult_le_compat_r; trivial; apply Rabs_pos.
Qed.

Theorem L048 : forall h q v, 0 <= h <= 1 ->
  within (after h (q, v)) (h ^ 2 * (- (1 / 2) * q), h ^ 2 * (1 / 2 * v)) (step symplectic_euler h (q, v))
    (h ^ 3 * (Rabs q + Rabs v)).
Proof.
  intros h q v [low high]. assert (C4 := cos_4 h low). assert (C2 := cos_2 h low). assert (S1 := sin_1 h low).
  assert (S3 := sin_3 h low). assert (0 <= h ^ 3) by (apply pow_le; lra). assert (h ^ 4 <= h ^ 3) by nra.
  split; unfold after; cbn [fst snd].
  - replace (_ - _) with ((cos h - (1 - h ^ 2 / 2)) * q + (sin h - h) * v) by by_ring.
    apply combination_small; apply Rabs_le; lra.
  - replace (_ - _) with ((h - sin h) * q + (cos h - (1 - h ^ 2 / 2)) * v) by by_ring.
    apply combination_small; apply Rabs_le; lra.
Qed.

(** The conditions of the trees; and on the oscillator the leading terms of the one-step errors, and what they leave. *)
Theorem local_errors : has_order forward_euler 1 /\ has_order rk4 4 /\ forall h q v, 0 <= h <= 1 ->
  within (after h (q, v)) (h ^ 2 * (q / 2), h ^ 2 * (v / 2)) (step Tables.forward_euler h (q, v))
    (h ^ 3 * (Rabs q + Rabs v))
  /\ within (after h (q, v)) (h ^ 2 * (- (q / 2)), h ^ 2 * (v / 2)) (step symplectic_euler h (q, v))
       (h ^ 3 * (Rabs q + Rabs v))
  /\ within (after h (q, v)) (h ^ 5 * (- (v / 120)), h ^ 5 * (q / 120)) (step Tables.rk4 h (q, v))
       (h ^ 6 * (Rabs q + Rabs v)).
Proof.
  split; [exact order_of_forward_euler | split; [exact order_of_rk4|]]. intros h q v inside.
  split; [|split].
  2: { generalize (L048 h q v inside). unfold within; cbn [fst snd].
       replace (- (1 / 2) * q) with (- (q / 2)) by field. now replace (1 / 2 * v) with (v / 2) by field. }
  all: destruct inside as [low high]; assert (C4 := cos_4 h low); assert (C2 := cos_2 h low).
  all: assert (S1 := sin_1 h low); assert (S3 := sin_3 h low); assert (S5 := sin_5 h low).
  all: assert (C6 := cos_6 h low); assert (S7 := sin_7 h low).
  all: assert (0 <= h ^ 3) by (apply pow_le; lra); assert (0 <= h ^ 6) by (apply pow_le; lra).
  all: assert (h ^ 4 <= h ^ 3) by nra; assert (h ^ 7 <= h ^ 6) by (replace (h ^ 7) with (h * h ^ 6) by ring; nra).
  - split; unfold after; cbn [fst snd].
    + replace (_ - _) with ((cos h - (1 - h ^ 2 / 2)) * q + (sin h - h) * v) by by_ring.
      apply combination_small; apply Rabs_le; lra.
    + replace (_ - _) with ((h - sin h) * q + (cos h - (1 - h ^ 2 / 2)) * v) by by_ring.
      apply combination_small; apply Rabs_le; lra.
  - split; unfold after; cbn [fst snd].
    + replace (_ - _) with ((cos h - (1 - h ^ 2 / 2 + h ^ 4 / 24)) * q
                            + (sin h - (h - h ^ 3 / 6 + h ^ 5 / 120)) * v) by by_ring.
      apply combination_small; apply Rabs_le; lra.
    + replace (_ - _) with (((h - h ^ 3 / 6 + h ^ 5 / 120) - sin h) * q
                            + (cos h - (1 - h ^ 2 / 2 + h ^ 4 / 24)) * v) by by_ring.
      apply combination_small; apply Rabs_le; lra.
Qed.

(** How far one step misses the flow of a unit state: |1 + ih - e^(ih)|^2 and |R(ih) - e^(ih)|^2. *)
Definition euler_miss (h : R) : R := (1 - cos h) ^ 2 + (h - sin h) ^ 2.
Definition rk4_miss (h : R) : R := (1 - h ^ 2 / 2 + h ^ 4 / 24 - cos h) ^ 2 + (h - h ^ 3 / 6 - sin h) ^ 2.

Theorem L012 :
  (forall h q v : R,
     distance (step Tables.forward_euler h (q, v)) (after h (q, v)) ^ 2 = euler_miss h * (q ^ 2 + v ^ 2)
     /\ distance (step Tables.rk4 h (q, v)) (after h (q, v)) ^ 2 = rk4_miss h * (q ^ 2 + v ^ 2))
  /\ (forall h, 0 < h <= 7 / 2 -> rk4_miss h < euler_miss h) /\ euler_miss 4 < rk4_miss 4
  /\ (evaluations Tables.rk4 = 4 /\ evaluations Tables.forward_euler = 1)%nat.
Proof.
  split; [|split; [|split; [unfold rk4_miss, euler_miss; by_interval | split; reflexivity]]].
  - intros h q v. rewrite !(proj2 (L134 _ _)). unfold after, euler_miss, rk4_miss; cbn [fst snd].
    generalize (cos h), (sin h). intros c s. split; by_ring.
  - intros h [low high]. unfold rk4_miss, euler_miss. destruct (Rle_dec h 1).
    + assert (P : 0 <= h) by lra. assert (C4 := cos_4 h P). assert (C6 := cos_6 h P).
      assert (S5 := sin_5 h P). assert (S3 := sin_3 h P).
      assert (B2 : 0 < h ^ 2 <= 1) by (split; nra).
      assert (B4 : 0 < h ^ 4 <= h ^ 2) by (replace (h ^ 4) with (h ^ 2 * h ^ 2) by ring; split; nra).
      assert (B5 : 0 < h ^ 5 <= h ^ 4) by (replace (h ^ 5) with (h * h ^ 4) by ring; split; nra).
      assert (B6 : 0 < h ^ 6 <= h ^ 4) by (replace (h ^ 6) with (h ^ 2 * h ^ 4) by ring; split; nra).
      set (x := 1 - h ^ 2 / 2 + h ^ 4 / 24 - cos h). set (y := sin h - (h - h ^ 3 / 6)).
      assert (0 <= x <= h ^ 4 / 120) by (unfold x; lra). assert (0 <= y <= h ^ 4 / 120) by (unfold y; lra).
      replace (h - h ^ 3 / 6 - sin h) with (- y) by (unfold y; ring).
      assert (11 / 24 * h ^ 2 <= 1 - cos h) by lra. generalize (pow2_ge_0 (h - sin h)).
      assert (0 < h ^ 2) by nra. nra.
    + assert (1 <= h <= 7 / 2) by lra. apply Rminus_gt_0_lt. interval with (i_bisect h, i_prec 40, i_depth 20).
Qed.
