(** Global errors on smooth problems: slopes that are Lipschitz on balls, and Gronwall's lemma over the steps. *)

From Coq Require Import QArith Qreals Reals Lra Lia List FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
From driftproof Require Import Readouts Tables Problems Jets OneStepErrors.
Import ListNotations.
Open Scope R_scope.

Section Problem.
  Context {P : problem}.

  (** Slopes of a step of size h from z that are limited, and Lipschitz in z, on each ball. *)
  Definition controlled (k : R -> vector -> vector) : Prop := forall B, exists B' L, 0 <= L /\ forall h z,
    0 <= h <= 1 ->
    in_ball d B z -> in_ball d B' (k h z)
    /\ forall w delta, in_ball d B w -> (forall j, (j < d)%nat -> Rabs (z j - w j) <= delta) ->
         forall i, (i < d)%nat -> Rabs (k h z i - k h w i) <= L * delta.

  Lemma delta_pos (z w : vector) delta i : (i < d)%nat -> (forall j,
    (j < d)%nat -> Rabs (z j - w j) <= delta) -> 0 <= delta.
  Proof. intros I near. generalize (near i I), (Rabs_pos (z i - w i)). lra. Qed.

  Lemma field_lipschitz B : exists B' L, 0 <= L /\ forall z, in_ball d B z -> in_ball d B' (D [] z)
    /\ forall w delta, in_ball d B w -> (forall j, (j < d)%nat -> Rabs (z j - w j) <= delta) ->
         forall i, (i < d)%nat -> Rabs (D [] z i - D [] w i) <= L * delta.
  Proof.
    destruct (bounded_on_balls d D smooth_D [] B) as [B' bound].
    destruct (finite_bound d (fun j M => forall z i,
      (i < d)%nat -> in_ball d B z -> Rabs (D [j] z i) <= M)) as (M & pos & small).
    { intros j ? ? S ? z i I Z. specialize (S z i I Z). lra. }
    { intros j _. destruct (bounded_on_balls d D smooth_D [j] B) as [M small]. now exists M. }
    exists B', (INR d * M). assert (0 <= INR d) by apply pos_INR. split; [nra|]. intros z Z.
    split; [intros i I; now apply bound|]. intros w delta W near i I.
    set (c s j := w j + s * (z j - w j)).
    replace (D [] z i) with (D [] (c 1) i).
    2: { f_equal. f_equal. apply functional_extensionality. intros j. unfold c. ring. }
    replace (D [] w i) with (D [] (c 0) i).
    2: { f_equal. f_equal. apply functional_extensionality. intros j. unfold c. ring. }
    replace (INR d * M * delta) with (INR d * (M * delta) * (1 - 0)) by ring.
    apply (mean_value_bound (fun s => D [] (c s) i) (fun s => total d (fun j => D [j] (c s) i * (z j - w j))));
      [lra | |].
    - intros s S. apply (chain_rule d D smooth_D [] c (fun j => z j - w j)); [exact I|]. intros j J. unfold c.
      auto_derive; trivial. ring.
    - intros s S. apply total_bound. intros j J. rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos.
      apply small; trivial. intros m m_d. specialize (Z m m_d). specialize (W m m_d). unfold c.
      apply Rabs_le_between in Z, W. apply Rabs_le_between. split; nra.
  Qed.

  Lemma controlled_start : controlled (fun _ z => z).
  Proof. intros B. exists B, 1. split; [lra|]. intros h z H Z. split; [exact Z|]. intros. rewrite Rmult_1_l. auto. Qed.
  Lemma controlled_field k : controlled k -> controlled (fun h z => D [] (k h z)).
  Proof.
    intros K B. destruct (K B) as (B1 & L1 & P1 & K1). destruct (field_lipschitz B1) as (B2 & L2 & P2 & F).
    exists B2, (L2 * L1). split; [nra|]. intros h z H Z. destruct (K1 h z H Z) as [Z1 near].
    destruct (F _ Z1) as [Z2 near']. split; [exact Z2|]. intros w delta W close i I.
    rewrite Rmult_assoc. apply near'; auto. now apply (proj1 (K1 h w H W)).
  Qed.
  Lemma controlled_stage a k : controlled k -> controlled (fun h z i => z i + a * h * k h z i).
  Proof.
    intros K B. destruct (K B) as (B1 & L1 & P1 & K1). exists (B + Rabs a * B1), (1 + Rabs a * L1).
    assert (A := Rabs_pos a). split; [nra|].
    intros h z H Z. destruct (K1 h z H Z) as [Z1 near].
    assert (ah : Rabs (a * h) <= Rabs a) by (rewrite Rabs_mult, (Rabs_pos_eq h) by lra; nra). split.
    - intros i I. eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_mult. apply Rplus_le_compat; [now apply Z|].
      apply Rmult_le_compat; auto using Rabs_pos.
    - intros w delta W close i I. assert (pos := delta_pos z w delta i I close).
      replace (_ - _) with ((z i - w i) + a * h * (k h z i - k h w i)) by ring.
      eapply Rle_trans; [apply Rabs_triang|]. rewrite Rmult_plus_distr_r, Rmult_1_l, Rabs_mult, Rmult_assoc.
      apply Rplus_le_compat; [now apply close|]. apply Rmult_le_compat; auto using Rabs_pos.
  Qed.
  Lemma controlled_plus a b k g : controlled k -> controlled g -> controlled (fun h z i => a * k h z i + b * g h z i).
  Proof.
    intros K G B. destruct (K B) as (B1 & L1 & P1 & K1), (G B) as (B2 & L2 & P2 & G1).
    exists (Rabs a * B1 + Rabs b * B2), (Rabs a * L1 + Rabs b * L2).
    assert (A := Rabs_pos a). assert (A' := Rabs_pos b). split; [nra|]. intros h z H Z.
    destruct (K1 h z H Z) as [Z1 near1], (G1 h z H Z) as [Z2 near2]. split.
    - intros i I. eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult.
      apply Rplus_le_compat; apply Rmult_le_compat_l; auto.
    - intros w delta W close i I.
      replace (_ - _) with (a * (k h z i - k h w i) + b * (g h z i - g h w i)) by ring.
      eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult, Rmult_plus_distr_r, !Rmult_assoc.
      apply Rplus_le_compat; apply Rmult_le_compat_l; auto.
  Qed.
  Lemma controlled_where k g : controlled k -> controlled g ->
    controlled (fun h z i => if velocity i then k h z i else g h z i).
  Proof.
    intros K G B. destruct (K B) as (B1 & L1 & P1 & K1), (G B) as (B2 & L2 & P2 & G1).
    exists (Rabs B1 + Rabs B2), (L1 + L2). split; [lra|]. intros h z H Z.
    destruct (K1 h z H Z) as [Z1 near1], (G1 h z H Z) as [Z2 near2]. split.
    - intros i I. generalize (Z1 i I), (Z2 i I), (Rle_abs B1), (Rle_abs B2), (Rabs_pos B1), (Rabs_pos B2).
      destruct (velocity i); lra.
    - intros w delta W close i I. assert (pos := delta_pos z w delta i I close).
      generalize (near1 w delta W close i I), (near2 w delta W close i I). destruct (velocity i); nra.
  Qed.

  (** One-step errors O(h^(p+1)) and controlled slopes: the error after n steps is O(h^p). *)
  Lemma global_error (step : R -> vector -> vector) (k : R -> vector -> vector) p C : (1 <= p)%nat -> 0 <= C ->
    (forall h z i, step h z i = z i + h * k h z i) -> controlled k ->
    (forall x h i, inside x h -> (i < d)%nat -> Rabs (step h (y x) i - y (x + h) i) <= C * h ^ (p + 1)) ->
    exists M h0, 0 < h0 /\ forall h n i, 0 < h <= h0 -> INR n * h <= T -> (i < d)%nat ->
      Rabs (Nat.iter n (step h) (y 0) i - y (INR n * h) i) <= M * h ^ p.
  Proof.
    intros p1 C0 form K local. assert (T0 := T_pos). destruct solution_bounded as (B & B0 & all).
    destruct (K (B + 1)) as (B' & L & L0 & near).
    set (M := T * C * exp (L * T)). assert (M0 : 0 <= M).
    { unfold M. apply Rmult_le_pos; [nra | apply Rlt_le, exp_pos]. }
    exists M, (/ (M + 1)). split; [apply Rinv_0_lt_compat; lra|].
    intros h n i [pos small] within I.
    assert (h1 : h <= 1). { eapply Rle_trans; [exact small|]. rewrite <- Rinv_1. apply Rinv_le_contravar; lra. }
    assert (hp : 0 < h ^ p) by (apply pow_lt; lra).
    assert (tube : M * h ^ p <= 1).
    { destruct p as [|p]; [lia|]. assert (h ^ p <= 1) by (rewrite <- (pow1 p); apply pow_incr; lra).
      assert (0 < h ^ p) by (apply pow_lt; lra). assert ((M + 1) * h <= 1).
      { apply Rmult_le_compat_l with (r := M + 1) in small; [|lra]. rewrite Rinv_r in small; lra. }
      cbn [pow]. nra. }
    assert (final : forall m, INR m * h <= T -> INR m * C * h ^ (p + 1) * (1 + h * L) ^ m <= M * h ^ p).
    { intros m low. assert (E := pow_le_exp (h * L) m ltac:(nra)). unfold M.
      replace (INR m * C * h ^ (p + 1) * (1 + h * L) ^ m) with (INR m * h * (C * h ^ p * (1 + h * L) ^ m))
        by (rewrite pow_add; ring).
      replace (T * C * exp (L * T) * h ^ p) with (T * (C * h ^ p * exp (L * T))) by ring.
      assert (0 <= C * h ^ p) by nra. assert (0 <= INR m) by apply pos_INR.
      assert (exp (INR m * (h * L)) <= exp (L * T)).
      { destruct (Rle_lt_or_eq_dec (INR m * (h * L)) (L * T)) as [less | ->]; [nra | | lra].
        now apply Rlt_le, exp_increasing. }
      assert (0 <= (1 + h * L) ^ m) by (apply pow_le; nra).
      apply Rmult_le_compat; [nra | apply Rmult_le_pos; assumption | exact low | apply Rmult_le_compat_l; lra]. }
    enough (induction : forall m, INR m * h <= T -> forall i, (i < d)%nat ->
      Rabs (Nat.iter m (step h) (y 0) i - y (INR m * h) i) <= INR m * C * h ^ (p + 1) * (1 + h * L) ^ m).
    { eapply Rle_trans; [now apply induction | now apply final]. }
    clear n i within I. induction m as [|m IH]; intros low i I.
    - cbn [Nat.iter nat_rect INR]. rewrite !Rmult_0_l. rewrite Rminus_eq_0, Rabs_R0. lra.
    - rewrite S_INR in low. assert (0 <= INR m) by apply pos_INR. assert (earlier : INR m * h <= T) by nra.
      specialize (IH earlier). specialize (final m earlier).
      set (delta := INR m * C * h ^ (p + 1) * (1 + h * L) ^ m) in *.
      set (z := Nat.iter m (step h) (y 0)) in *. cbn [Nat.iter nat_rect]. fold (Nat.iter m (step h) (y 0)). fold z.
      assert (Y : in_ball d (B + 1) (y (INR m * h))).
      { intros j J. generalize (all (INR m * h) j ltac:(nra) J). lra. }
      assert (Z : in_ball d (B + 1) z).
      { intros j J. generalize (IH j J), (all (INR m * h) j ltac:(nra) J). intros close limited.
        replace (z j) with ((z j - y (INR m * h) j) + y (INR m * h) j) by ring.
        eapply Rle_trans; [apply Rabs_triang | lra]. }
      destruct (near h z ltac:(lra) Z) as [_ lipschitz]. specialize (lipschitz _ _ Y IH i I).
      assert (one : Rabs (step h (y (INR m * h)) i - y (INR m * h + h) i) <= C * h ^ (p + 1)).
      { apply local; trivial. unfold inside. repeat split; nra. }
      rewrite S_INR. replace ((INR m + 1) * h) with (INR m * h + h) by ring.
      replace (step h z i - y (INR m * h + h) i)
        with ((z i - y (INR m * h) i) + h * (k h z i - k h (y (INR m * h)) i)
              + (step h (y (INR m * h)) i - y (INR m * h + h) i)) by (rewrite !form; ring).
      eapply Rle_trans; [apply Rabs_triang|].
      apply Rle_trans with (delta * (1 + h * L) + C * h ^ (p + 1)).
      + apply Rplus_le_compat; [|exact one]. eapply Rle_trans; [apply Rabs_triang|].
        rewrite Rabs_mult, (Rabs_pos_eq h) by lra. specialize (IH i I). nra.
      + unfold delta. assert (1 <= (1 + h * L) ^ S m) by (apply pow_R1_Rle; nra).
        assert (0 <= C * h ^ (p + 1)) by (apply Rmult_le_pos; [lra | apply pow_le; lra]).
        cbn [pow] in *. nra.
  Qed.

  Definition euler_slope (h : R) (z : vector) : vector := D [] z.
  Definition symplectic_slope (h : R) (z : vector) : vector := fun i =>
    if velocity i then D [] z i else D [] (fun j => if velocity j then z j + 1 * h * D [] z j else z j) i.
  Definition rk4_slope (h : R) (z : vector) : vector :=
    let k1 := D [] z in let k2 := D [] (fun i => z i + 1 / 2 * h * k1 i) in
    let k3 := D [] (fun i => z i + 1 / 2 * h * k2 i) in let k4 := D [] (fun i => z i + 1 * h * k3 i) in
    fun i => (k1 i + 2 * k2 i + 2 * k3 i + k4 i) / 6.

  Lemma forward_euler_form h z i : vector_step (D []) velocity h forward_euler z i = z i + h * euler_slope h z i.
  Proof. cbn [vector_step forward_euler vector_slopes combined app]. unfold Q2R, euler_slope. cbn. field. Qed.
  Lemma symplectic_euler_form h z i :
    vector_step (D []) velocity h symplectic_euler z i = z i + h * symplectic_slope h z i.
  Proof.
    cbn [vector_step symplectic_euler fold_left vector_part]. unfold symplectic_slope.
    replace (Q2R 1) with 1 by (unfold Q2R; cbn; field). destruct (velocity i); ring.
  Qed.
  Lemma rk4_form h z i : vector_step (D []) velocity h rk4 z i = z i + h * rk4_slope h z i.
  Proof. now rewrite rk4_explicit. Qed.

  (** The slope of any step: a Runge-Kutta method's is a sum of fields at such states, a splitting's one of parts. *)
  Lemma controlled_ext k g : (forall h z i, k h z i = g h z i) -> controlled g -> controlled k.
  Proof.
    intros E G B. destruct (G B) as (B' & L & pos & near). exists B', L. split; [exact pos|]. intros h z H Z.
    destruct (near h z H Z) as [Z' close]. split; [intros i I; rewrite E; now apply Z'|]. intros. rewrite !E. auto.
  Qed.
  Fixpoint row_slope (row : list Q) (ks : list (R -> vector -> vector)) (h : R) (z : vector) : vector :=
    match row, ks with
    | a :: row, k :: ks => fun i => Q2R a * k h z i + 1 * row_slope row ks h z i
    | _, _ => fun _ => 0
    end.
  Lemma controlled_row row : forall ks, List.Forall controlled ks -> controlled (row_slope row ks).
  Proof.
    assert (none : controlled (fun _ _ _ => 0)).
    { apply controlled_ext with (g := fun h z i => 0 * z i + 0 * z i); [intros; ring|].
      apply (controlled_plus 0 0 (fun _ z => z) (fun _ z => z)); apply controlled_start. }
    induction row as [|a row IH]; intros ks all; [exact none|]. destruct all as [|k ks K all]; [exact none|].
    apply (controlled_plus (Q2R a) 1 k (row_slope row ks)); auto.
  Qed.
  Lemma combined_slope h z row : forall ks (y : vector) i,
    combined h y row (map (fun k => k h z) ks) i = y i + h * row_slope row ks h z i.
  Proof.
    induction row as [|a row IH]; intros [|k ks] y i; cbn [combined map row_slope]; try ring. rewrite IH. ring.
  Qed.
  Lemma slopes_of_rows rows : forall ks, List.Forall controlled ks -> exists ks', List.Forall controlled ks' /\
    forall h z, vector_slopes (D []) h z rows (map (fun k => k h z) ks) = map (fun k => k h z) ks'.
  Proof.
    induction rows as [|row rows IH]; intros ks all; [now exists ks|].
    set (k := fun h z => D [] (fun i => z i + 1 * h * row_slope row ks h z i)).
    destruct (IH (ks ++ [k])) as (ks' & all' & E).
    - apply List.Forall_app. split; [exact all|]. constructor; [|constructor].
      apply (controlled_field (fun h z i => z i + 1 * h * row_slope row ks h z i)), controlled_stage, controlled_row,
        all.
    - exists ks'. split; [exact all'|]. intros h z. rewrite <- E, map_app. cbn [vector_slopes map]. do 2 f_equal.
      unfold k. do 2 f_equal. apply functional_extensionality. intros i. rewrite combined_slope. ring.
  Qed.
  Lemma slope_of_parts parts : forall k, controlled k -> exists k', controlled k' /\ forall h z i,
    fold_left (vector_part (D []) velocity h) parts (fun i => z i + h * k h z i) i = z i + h * k' h z i.
  Proof.
    induction parts as [|part parts IH]; intros k K; [now exists k|].
    set (field := fun h z => D [] (fun i => z i + 1 * h * k h z i)).
    assert (F : controlled field) by (apply (controlled_field (fun h z i => z i + 1 * h * k h z i)), controlled_stage,
      K).
    assert (same : forall h z, D [] (fun i => z i + h * k h z i) = field h z).
    { intros h z. unfold field. f_equal. apply functional_extensionality. intros i. ring. }
    set (more c := fun h z i => 1 * k h z i + Q2R c * field h z i).
    assert (M : forall c, controlled (more c)) by (intros; now apply controlled_plus).
    destruct part as [c|c];
      [destruct (IH _ (controlled_where _ _ (M c) K)) as (k' & K' & E)
      |destruct (IH _ (controlled_where _ _ K (M c))) as (k' & K' & E)].
    all: exists k'; split; [exact K'|]; intros h z i; rewrite <- E; cbn [fold_left vector_part]; rewrite same;
      apply (f_equal (fun y => fold_left _ parts y i)); apply functional_extensionality; intros j; unfold more;
      destruct (velocity j); ring.
  Qed.
  Lemma slope_of_step m : exists slope, controlled slope
    /\ forall h z i, vector_step (D []) velocity h m z i = z i + h * slope h z i.
  Proof.
    destruct m as [A b|parts]; cbn [vector_step].
    - destruct (slopes_of_rows A [] (List.Forall_nil _)) as (ks & all & E). exists (row_slope b ks).
      split; [now apply controlled_row|]. intros h z i. rewrite <- combined_slope. now rewrite <- E.
    - destruct (slope_of_parts parts (row_slope [] []) (controlled_row [] [] (List.Forall_nil _))) as (k & K & E).
      exists k. split; [exact K|]. intros h z i. rewrite <- E.
      apply (f_equal (fun y => fold_left _ parts y i)). apply functional_extensionality. intros j. cbn. ring.
  Qed.

  (** Where x and h are inside, one step from y (x) misses y (x + h) by O(h^p). *)
  Definition local_bound (m : method) (p : nat) : Prop := exists C, 0 <= C /\ forall x h i, inside x h -> (i < d)%nat ->
    Rabs (vector_step (D []) velocity h m (y x) i - y (x + h) i) <= C * h ^ p.

  Lemma local_of_vanishing m p e :
    (forall x h i, vector_step (D []) velocity h m (y x) i - y (x + h) i = e x h i) ->
    (forall i, (i < d)%nat -> vanishes p (fun x h => e x h i)) -> local_bound m p.
  Proof.
    intros E V. destruct (finite_bound d (fun i C => forall x h, inside x h ->
      Rabs (vector_step (D []) velocity h m (y x) i - y (x + h) i) <= C * h ^ p)) as (C & pos & all).
    - intros i C C' small le x h I. specialize (small x h I). assert (0 <= h ^ p) by (apply pow_le, I). nra.
    - intros i I. destruct (small_of_vanishes p _ (V i I)) as (C & _ & small). exists C. intros. rewrite E. auto.
    - exists C. split; [exact pos|]. intros x h i H I. now apply all.
  Qed.
  Lemma local_bounds : local_bound forward_euler 2 /\ local_bound symplectic_euler 2 /\ local_bound rk4 5.
  Proof.
    split; [|split].
    - apply (local_of_vanishing _ 2) with (2 := euler_vanishes). intros x h i. now rewrite forward_euler_form.
    - apply (local_of_vanishing _ 2) with (2 := symplectic_vanishes). intros x h i. now rewrite symplectic_euler_form.
    - apply (local_of_vanishing _ 5) with (2 := rk4_vanishes). intros x h i. now rewrite rk4_form.
  Qed.

  Lemma run_iterates f h m n z : vector_run f velocity h m n z = Nat.iter n (vector_step f velocity h m) z.
  Proof. induction n as [|n IH]; [reflexivity|]. cbn [vector_run]. now rewrite IH. Qed.

  Lemma global_bound m p : (1 <= p)%nat -> local_bound m (p + 1) ->
    exists M h0, 0 < h0 /\ forall h n i, 0 < h <= h0 -> INR n * h <= T -> (i < d)%nat ->
      Rabs (vector_run (D []) velocity h m n (y 0) i - y (INR n * h) i) <= M * h ^ p.
  Proof.
    intros p1 (C & pos & small). destruct (slope_of_step m) as (slope & K & form).
    destruct (global_error (fun h => vector_step (D []) velocity h m) slope p C) as (M & h0 & h0_pos & all); auto.
    exists M, h0. split; [exact h0_pos|]. intros. rewrite run_iterates. now apply all.
  Qed.
End Problem.

Theorem one_step_errors : one_step_error forward_euler 2 /\ one_step_error symplectic_euler 2 /\ one_step_error rk4 5.
Proof.
  split; [|split]; intros d velocity D T y S T_pos Y; set (P := Build_problem d velocity D T y S T_pos Y).
  all: destruct (@local_bounds P) as ((C1 & _ & E1) & (C2 & _ & E2) & (C3 & _ & E3)).
  1: exists C1. 2: exists C2. 3: exists C3.
  all: intros t h i t_pos H low I.
  1: apply E1. 3: apply E2. 5: apply E3.
  all: trivial; unfold inside; cbn; lra.
Qed.

(** On smooth problems over a fixed interval one order is lost from one step to all, whatever the method. *)
Theorem converges_of_one_step m p : (1 <= p)%nat -> one_step_error m (p + 1) -> converges m p.
Proof.
  intros p1 one d velocity D T y S T_pos Y. set (P := Build_problem d velocity D T y S T_pos Y).
  destruct (one d velocity D T y S T_pos Y) as [C small]. apply (@global_bound P m p p1).
  exists (Rabs C). split; [apply Rabs_pos|]. intros x h i (x_pos & H & low) I.
  eapply Rle_trans; [now apply small|]. apply Rmult_le_compat_r; [apply pow_le, H | apply Rle_abs].
Qed.

Theorem methods_converge : converges forward_euler 1 /\ converges symplectic_euler 1 /\ converges rk4 4.
Proof.
  destruct one_step_errors as (E1 & E2 & E3).
  split; [|split]; apply converges_of_one_step; trivial; lia.
Qed.

(** y' = g(t), with t as component 0: RK4 asks at t, t + h/2, t + h/2 and t + h, which are the sums of its rows. *)
Theorem L061 : exists A b, rk4 = RungeKutta A b
  /\ map (fold_right Qplus 0%Q) A = [0; (1 # 2); (1 # 2); 1]%Q
  /\ forall (g : R -> R) h (y : vector), let t := y 0%nat in
       map (fun k : vector => k 1%nat) (vector_slopes (fun y i => match i
         with O => 1 | S _ => g (y 0%nat) end) h y A [])
       = [g t; g (t + h / 2); g (t + h / 2); g (t + h)].
Proof.
  repeat eexists. intros g h y t. cbn [vector_slopes combined app map]. unfold Q2R; cbn [Qnum Qden].
  repeat (apply f_equal2; [f_equal; unfold t; field|]). reflexivity.
Qed.
