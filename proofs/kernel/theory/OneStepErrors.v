(** One-step errors on smooth problems: Taylor's formula in the step. *)

From Coq Require Import QArith Qreals Reals Lra Lia List FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
From driftproof Require Import Readouts Tables Problems Jets.
Import ListNotations.
Open Scope R_scope.

Section Problem.
  Context {P : problem}.
  Definition exact_of (n : nat) : R -> R -> vector := fun x h =>
    match n with
    | O => y (x + h)
    | 1%nat => D [] (exact x h)
    | 2%nat => first (exact x h) (D [] (exact x h))
    | _ => second (exact x h) (D [] (exact x h)) (first (exact x h) (D [] (exact x h)))
    end.
  Lemma exact_jet : jet exact_of.
  Proof.
    assert (V : vector_derives exact (fun x h => D [] (exact x h))) by (intros i I; now apply exact_derives).
    assert (N := exact_tame). assert (N1 := field_tame _ N). assert (V1 := field_derives _ _ V).
    assert (N2 := first_tame _ _ N N1). assert (V2 := first_derives _ _ _ V V1).
    assert (N3 := second_tame _ _ _ N N1 N2).
    split; intros [|[|[|[|n]]]] low; try lia; assumption.
  Qed.

  (** What vanishes with its first n - 1 derivatives is O(h^n). *)
  Fixpoint vanishes (n : nat) (e : R -> R -> R) : Prop :=
    match n with
    | O => limited e
    | S n => (forall x, 0 <= x <= T -> e x 0 = 0) /\ exists e', derives e e' /\ vanishes n e'
    end.
  Lemma small_of_vanishes n : forall e, vanishes n e ->
    exists C, 0 <= C /\ forall x h, inside x h -> Rabs (e x h) <= C * h ^ n.
  Proof.
    induction n as [|n IH]; intros e V.
    - destruct V as [C all]. exists (Rabs C). split; [apply Rabs_pos|]. intros x h I. cbn [pow]. rewrite Rmult_1_r.
      eapply Rle_trans; [now apply all | apply Rle_abs].
    - destruct V as (zero & e' & E & V). destruct (IH e' V) as (C & pos & small). exists C. split; [exact pos|].
      intros x h (X & H & XH). replace (e x h) with (e x h - e x 0) by (rewrite zero; lra).
      replace (C * h ^ S n) with (C * h ^ n * (h - 0)) by (cbn [pow]; ring).
      apply (mean_value_bound (e x) (e' x)); [lra | |].
      + intros s S. apply E. unfold inside. lra.
      + intros s S. apply Rle_trans with (C * s ^ n); [apply small; unfold inside; lra|].
        apply Rmult_le_compat_l; [exact pos | apply pow_incr; lra].
  Qed.

  (** How the derivatives depend on multiples of their arguments. *)
  Definition square (c u : vector) (i : nat) : R := total d (fun j => along [j] c u i * u j).
  Definition cube (c u : vector) (i : nat) : R :=
    total d (fun j => total d (fun k => along [k; j] c u i * u k) * u j).
  Definition mixed (c u v : vector) (i : nat) : R :=
    total d (fun j => total d (fun k => D [k; j] c i * v k) * u j + 2 * (along [j] c u i * v j)).
  Definition times (a : R) (u : vector) : vector := fun i => a * u i.
  Definition sum (u v : vector) : vector := fun i => u i + v i.

  Lemma along_times l c a u i : along l c (times a u) i = a * along l c u i.
  Proof. unfold along, times. rewrite <- total_scal. apply total_ext. intros. ring. Qed.
  Lemma along_sum l c u v i : along l c (sum u v) i = along l c u i + along l c v i.
  Proof. unfold along, sum. rewrite <- total_plus. apply total_ext. intros. ring. Qed.
  Lemma second_times c a u b v : second c (times a u) (times b v)
    = sum (times (a ^ 2) (square c u)) (times b (first c v)).
  Proof.
    apply functional_extensionality. intros i.
    change (total d (fun j => along [j] c (times a u) i * times a u j + D [j] c i * times b v j)
      = a ^ 2 * total d (fun j => along [j] c u i * u j) + b * total d (fun j => D [j] c i * v j)).
    rewrite <- !total_scal, <- total_plus. apply total_ext. intros j _. rewrite along_times. unfold times. ring.
  Qed.
  Lemma third_times c a u b v w : third c (times a u) (times b v) w
    = sum (times (a ^ 3) (cube c u)) (sum (times (a * b) (mixed c u v)) (first c w)).
  Proof.
    apply functional_extensionality. intros i.
    change (third c (times a u) (times b v) w i
      = a ^ 3 * cube c u i + (a * b * mixed c u v i + total d (fun j => D [j] c i * w j))).
    unfold third, along', cube, mixed.
    rewrite <- !total_scal, <- !total_plus. apply total_ext. intros j _. rewrite total_plus, !along_times.
    replace (total d (fun k => along [k; j] c (times a u) i * times a u k))
      with (a ^ 2 * total d (fun k => along [k; j] c u i * u k))
      by (rewrite <- total_scal; apply total_ext; intros; rewrite along_times; unfold times; ring).
    replace (total d (fun k => D [k; j] c i * times b v k)) with (b * total d (fun k => D [k; j] c i * v k))
      by (rewrite <- total_scal; apply total_ext; intros; unfold times; ring).
    unfold times. ring.
  Qed.
  Lemma first_times c a u : first c (times a u) = times a (first c u).
  Proof. apply functional_extensionality. intros i. apply along_times. Qed.
  Lemma first_sum c u v : first c (sum u v) = sum (first c u) (first c v).
  Proof. apply functional_extensionality. intros i. apply along_sum. Qed.

  Lemma times_1 u : times 1 u = u.
  Proof. apply functional_extensionality. intros i. unfold times. ring. Qed.
  Lemma second_value c u v : second c u v = sum (square c u) (first c v).
  Proof. generalize (second_times c 1 u 1 v). now rewrite pow1, !times_1. Qed.
  Lemma third_value c u v w : third c u v w = sum (cube c u) (sum (mixed c u v) (first c w)).
  Proof. generalize (third_times c 1 u 1 v w). now rewrite pow1, Rmult_1_l, !times_1. Qed.

  (** The start of a step, constant in h, and its slope. *)
  Lemma start_tame : vector_tame (fun x _ => y x).
  Proof.
    intros n i I. apply (tame_const n (fun x => y x i)). destruct solution_bounded as (B & _ & all). exists B. auto.
  Qed.
  Definition slope_of (n : nat) : R -> R -> vector := fun x _ => match n with O => D [] (y x) | _ => fun _ => 0 end.
  Lemma slope_jet : jet slope_of.
  Proof.
    split; intros n _.
    - intros i I x h H. destruct n; cbn [slope_of];
        [apply (is_derive_const (K := R_AbsRing) (V := R_NormedModule) (D [] (y x) i))
        | apply (is_derive_const (K := R_AbsRing) (V := R_NormedModule) 0)].
    - destruct n as [|n]; [apply (field_tame _ start_tame)|]. intros m i I. apply (tame_number m 0).
  Qed.

  Definition average (a b c e : R -> R -> vector) : R -> R -> vector :=
    fun x h i => (a x h i + 2 * b x h i + 2 * c x h i + e x h i) / 6.
  Lemma average_derives a a' b b' c c' e e' : vector_derives a a' -> vector_derives b b' -> vector_derives c c' ->
    vector_derives e e' -> vector_derives (average a b c e) (average a' b' c' e').
  Proof.
    intros A B C E i I x h H. specialize (A i I x h H). specialize (B i I x h H). specialize (C i I x h H).
    specialize (E i I x h H). unfold average.
    assert (all : forall f1 f2 f3 f4 : R -> R, forall d1 d2 d3 d4, is_derive f1 h d1 -> is_derive f2 h d2 ->
      is_derive f3 h d3 -> is_derive f4 h d4 ->
      is_derive (fun h => (f1 h + 2 * f2 h + 2 * f3 h + f4 h) / 6) h ((d1 + 2 * d2 + 2 * d3 + d4) / 6)).
    { intros f1 f2 f3 f4 d1 d2 d3 d4 D1 D2 D3 D4. auto_derive; [repeat split; eexists; eassumption|].
      replace (Derive (fun h => f1 h) h) with d1 by (symmetry; now apply is_derive_unique).
      replace (Derive (fun h => f2 h) h) with d2 by (symmetry; now apply is_derive_unique).
      replace (Derive (fun h => f3 h) h) with d3 by (symmetry; now apply is_derive_unique).
      replace (Derive (fun h => f4 h) h) with d4 by (symmetry; now apply is_derive_unique). field. }
    apply (all (fun h => a x h i) (fun h => b x h i) (fun h => c x h i) (fun h => e x h i)); assumption.
  Qed.
  Lemma average_tame a b c e : vector_tame a -> vector_tame b -> vector_tame c -> vector_tame e ->
    vector_tame (average a b c e).
  Proof.
    intros A B C E n i I. unfold average, Rdiv. apply (tame_mult n _ (fun _ _ => / 6)); [|apply tame_number].
    repeat apply tame_plus; auto; apply tame_mult; auto using tame_number.
  Qed.

  (** y + h K - X with K = K_0, X = X_0 and their derivatives: it vanishes to the order to which
      n K_(n-1) = X_n at 0. *)
  Lemma error_vanishes p (K X : nat -> R -> R -> R) (start : R -> R) :
    (forall n, (n <= p)%nat -> derives (K n) (K (S n)) /\ derives (X n) (X (S n))) ->
    tame 1 (K p) -> tame 1 (K (S p)) -> tame 1 (X (S p)) ->
    (forall x, 0 <= x <= T -> X 0%nat x 0 = start x) ->
    (forall n x, 0 <= x <= T -> (n <= p)%nat -> INR (S n) * K n x 0 = X (S n) x 0) ->
    vanishes (S (S p)) (fun x h => start x + h * K 0%nat x h - X 0%nat x h).
  Proof.
    intros DKX N N' NX zero equal.
    assert (step : forall (a s : R) (f f1 g : R -> R) (h f' f1' g' : R), is_derive f h f' -> is_derive f1 h f1' ->
      is_derive g h g' -> is_derive (fun h => s + a * f h + h * f1 h - g h) h (a * f' + (f1 h + h * f1') - g')) 
      by (intros a s f f1 g h f' f1' g' F F1 G; auto_derive; [repeat split; eexists; eassumption|];
          replace (Derive (fun h => f h) h) with f' by (symmetry; now apply is_derive_unique);
          replace (Derive (fun h => f1 h) h) with f1' by (symmetry; now apply is_derive_unique);
          replace (Derive (fun h => g h) h) with g' by (symmetry; now apply is_derive_unique); ring).
    assert (all : forall r n, (n + r = p)%nat ->
      vanishes (S r) (fun x h => INR (S n) * K n x h + h * K (S n) x h - X (S n) x h)).
    { induction r as [|r IH]; intros n E; (split; [intros x I; rewrite equal by (trivial; lia); ring|]).
      - replace n with p by lia.
        assert (M : tame 1 (fun x h => INR (S p) * K p x h + h * K (S p) x h + -1 * X (S p) x h)).
        { apply tame_plus; [apply tame_plus|]; apply tame_mult; auto using tame_number, tame_h. }
        destruct M as [_ (e & De & Be & _)]. exists e. split; [|exact Be]. intros x h I.
        apply is_derive_ext with (2 := De x h I). intros t. real_ring.
      - exists (fun x h => INR (S (S n)) * K (S n) x h + h * K (S (S n)) x h - X (S (S n)) x h).
        split; [|apply IH; lia]. intros x h I. destruct (DKX n ltac:(lia)) as [A _].
        destruct (DKX (S n) ltac:(lia)) as [B C].
        evar_last; [apply is_derive_ext with (2 := step (INR (S n)) 0 _ _ _ h _ _ _ (A x h I) (B x h I) (C x h I)) |].
        + intros t. cbn beta. real_ring.
        + rewrite (S_INR (S n)). real_ring. }
    split; [intros x I; rewrite zero by exact I; ring|].
    exists (fun x h => INR 1 * K 0%nat x h + h * K 1%nat x h - X 1%nat x h). split; [|now apply all].
    intros x h I. destruct (DKX 0%nat ltac:(lia)) as [A C].
    evar_last; [apply is_derive_ext with (2 := step 0 (start x) _ _ _ h _ _ _ (A x h I) (A x h I) (C x h I)) |].
    - intros t. cbn beta. real_ring.
    - cbn [INR]. real_ring.
  Qed.

  Lemma rk4_explicit f h z : vector_step f velocity h rk4 z =
    let k1 := f z in let k2 := f (fun i => z i + 1 / 2 * h * k1 i) in let k3 := f (fun i => z i + 1 / 2 * h * k2 i) in
    let k4 := f (fun i => z i + 1 * h * k3 i) in fun i => z i + h * ((k1 i + 2 * k2 i + 2 * k3 i + k4 i) / 6).
  Proof.
    cbn [vector_step rk4 vector_slopes combined app]. cbv zeta. set (k1 := f z).
    replace (fun i => z i + Q2R (1 # 2) * h * k1 i) with (fun i => z i + 1 / 2 * h * k1 i)
      by (apply functional_extensionality; intros i; unfold Q2R; cbn; field).
    set (k2 := f (fun i => z i + 1 / 2 * h * k1 i)).
    replace (fun i => z i + Q2R 0 * h * k1 i + Q2R (1 # 2) * h * k2 i) with (fun i => z i + 1 / 2 * h * k2 i)
      by (apply functional_extensionality; intros i; unfold Q2R; cbn; field).
    set (k3 := f (fun i => z i + 1 / 2 * h * k2 i)).
    replace (fun i => z i + Q2R 0 * h * k1 i + Q2R 0 * h * k2 i + Q2R 1 * h * k3 i) with (fun i => z i + 1 * h * k3 i)
      by (apply functional_extensionality; intros i; unfold Q2R; cbn; field).
    apply functional_extensionality. intros i. unfold Q2R. cbn. field.
  Qed.

  Definition k2_of := field_of (stage_of y (1 / 2) slope_of).
  Definition k3_of := field_of (stage_of y (1 / 2) k2_of).
  Definition k4_of := field_of (stage_of y 1 k3_of).

  (** The derivatives at h = 0, in elementary differentials. *)
  Section AtZero.
    Variable x : R.
    Let F := D [] (y x). Let G := first (y x) F. Let Q := square (y x) F. Let C := cube (y x) F.
    Let M := mixed (y x) F G.
    Ltac by_components :=
      rewrite ?first_sum, ?first_times; apply functional_extensionality; intros i; unfold sum, times; cbn [INR]; field.
    Lemma times_times a b u : times a (times b u) = times (a * b) u.
    Proof. apply functional_extensionality. intros i. unfold times. ring. Qed.
    Lemma stage_at_0 a k : stage_of y a k 0 x 0 = y x.
    Proof. apply functional_extensionality. intros i. unfold stage_of. ring. Qed.
    Lemma stage_next_at_0 a k n : stage_of y a k (S n) x 0 = times (a * INR (S n)) (k n x 0).
    Proof. apply functional_extensionality. intros i. unfold stage_of, times. ring. Qed.
    Lemma slope_next n : slope_of (S n) x 0 = times 0 F.
    Proof. apply functional_extensionality. intros i. unfold slope_of, times. ring. Qed.
    Ltac expand := unfold field_of; rewrite stage_at_0, ?stage_next_at_0, ?slope_next.

    Lemma k2_at_0 : k2_of 0 x 0 = F /\ k2_of 1 x 0 = times (1 / 2) G /\ k2_of 2 x 0 = times (1 / 4) Q
      /\ k2_of 3 x 0 = times (1 / 8) C.
    Proof.
      change (slope_of 0 x 0) with F in *.
      split; [|split; [|split]]; unfold k2_of; expand; change (slope_of 0 x 0) with F; rewrite ?times_times.
      - reflexivity.
      - rewrite first_times. fold G. by_components.
      - rewrite second_times. fold Q. by_components.
      - rewrite third_times. fold C. by_components.
    Qed.
    Lemma k3_at_0 : k3_of 0 x 0 = F /\ k3_of 1 x 0 = times (1 / 2) G
      /\ k3_of 2 x 0 = sum (times (1 / 4) Q) (times (1 / 2) (first (y x) G))
      /\ k3_of 3 x 0 = sum (times (1 / 8) C) (sum (times (1 / 4) M) (times (3 / 8) (first (y x) Q))).
    Proof.
      destruct k2_at_0 as (E0 & E1 & E2 & _).
      split; [|split; [|split]]; unfold k3_of; expand; rewrite ?E0, ?E1, ?E2, ?times_times.
      - reflexivity.
      - rewrite first_times. fold G. by_components.
      - rewrite second_times. fold Q. by_components.
      - rewrite third_times. fold C M. by_components.
    Qed.
    Lemma k4_at_0 : k4_of 0 x 0 = F /\ k4_of 1 x 0 = G /\ k4_of 2 x 0 = sum Q (first (y x) G)
      /\ k4_of 3 x 0 = sum C (sum M (sum (times (3 / 4) (first (y x) Q))
                                (times (3 / 2) (first (y x) (first (y x) G))))).
    Proof.
      destruct k3_at_0 as (E0 & E1 & E2 & _).
      split; [|split; [|split]]; unfold k4_of; expand; rewrite ?E0, ?E1, ?E2, ?times_times.
      - reflexivity.
      - rewrite first_times. fold G. by_components.
      - rewrite second_times. fold Q. by_components.
      - rewrite third_times. fold C M. rewrite first_times, first_sum, !first_times. by_components.
    Qed.
  End AtZero.

  Definition slope_average n := average (slope_of n) (k2_of n) (k3_of n) (k4_of n).
  Lemma slopes_jets : jet k2_of /\ jet k3_of /\ jet k4_of.
  Proof.
    assert (J2 : jet k2_of) by (apply jet_field, jet_stage; [apply start_tame | apply slope_jet]).
    assert (J3 : jet k3_of) by (apply jet_field, jet_stage; [apply start_tame | exact J2]).
    split; [exact J2 | split; [exact J3|]]. apply jet_field, jet_stage; [apply start_tame | exact J3].
  Qed.

  Lemma rk4_vanishes i : (i < d)%nat -> vanishes 5 (fun x h => y x i + h * slope_average 0 x h i - exact x h i).
  Proof.
    intros I. destruct slopes_jets as ([D2 N2] & [D3 N3] & [D4 N4]). destruct slope_jet as [D1 N1].
    destruct exact_jet as [DX NX].
    destruct (average_tame _ _ _ _ (N1 3%nat ltac:(lia)) (N2 3%nat ltac:(lia)) (N3 3%nat ltac:(lia))
                (N4 3%nat ltac:(lia)) 2%nat i I)
      as [_ (last & D_last & N_last)].
    assert (DA : forall n, (n < 3)%nat -> vector_derives (slope_average n) (slope_average (S n)))
      by (intros n low; apply average_derives; auto).
    set (K n x h := match n with 4%nat => last x h | _ => slope_average n x h i end).
    set (X n x h := match n with
      | 4%nat => third (exact_of 0 x h) (exact_of 1 x h) (exact_of 2 x h) (exact_of 3 x h) i
      | _ => exact_of n x h i end).
    apply (error_vanishes 3 K X (fun x => y x i)).
    - intros n low. split.
      + destruct n as [|[|[|[|n]]]]; try lia; [apply (DA 0%nat) | apply (DA 1%nat) | apply (DA 2%nat) | exact D_last];
          trivial; lia.
      + destruct n as [|[|[|[|n]]]]; try lia; [apply (DX 0%nat) | apply (DX 1%nat) | apply (DX 2%nat) |]; trivial;
          try lia.
        apply (second_derives (exact_of 0) (exact_of 1) (exact_of 2) (exact_of 3)); trivial; apply DX; lia.
    - apply (average_tame _ _ _ _ (N1 3%nat ltac:(lia)) (N2 3%nat ltac:(lia)) (N3 3%nat ltac:(lia))
               (N4 3%nat ltac:(lia)) 1%nat i I).
    - exact N_last.
    - apply third_tame; trivial; apply NX; lia.
    - intros x _. unfold X, exact_of. now rewrite Rplus_0_r.
    - intros n x _ low. destruct (k2_at_0 x) as (A0 & A1 & A2 & A3). destruct (k3_at_0 x) as (B0 & B1 & B2 & B3).
      destruct (k4_at_0 x) as (C0 & C1 & C2 & C3). set (F := D [] (y x)) in *.
      destruct n as [|[|[|[|n]]]]; try lia; unfold K, X, slope_average, average, slope_of, exact_of, exact;
        rewrite Rplus_0_r.
      + rewrite A0, B0, C0. fold F. cbn [INR]. field.
      + rewrite A1, B1, C1. fold F. unfold times. cbn [INR]. field.
      + rewrite A2, B2, C2, second_value. fold F. unfold times, sum. cbn [INR]. field.
      + rewrite A3, B3, C3, third_value, second_value, first_sum. fold F. unfold times, sum. cbn [INR]. field.
  Qed.

  Lemma euler_vanishes i : (i < d)%nat -> vanishes 2 (fun x h => y x i + h * D [] (y x) i - exact x h i).
  Proof.
    intros I. destruct slope_jet as [D1 N1]. destruct exact_jet as [DX NX].
    apply (error_vanishes 0 (fun n x h => slope_of n x h i) (fun n x h => exact_of n x h i) (fun x => y x i)).
    - intros n low. split; [apply D1 | apply DX]; trivial; lia.
    - apply N1; trivial; lia.
    - apply N1; trivial; lia.
    - apply NX; trivial; lia.
    - intros x _. unfold exact_of. now rewrite Rplus_0_r.
    - intros [|n] x _ low; [|lia]. unfold exact_of, exact, slope_of. rewrite Rplus_0_r. cbn [INR]. ring.
  Qed.

  (** The positions are moved with the new velocities. *)
  Definition kicked (x h : R) : vector := fun i => if velocity i then y x i + 1 * h * D [] (y x) i else y x i.
  Definition kicked' (x h : R) : vector := fun i => if velocity i then 1 * (1 * D [] (y x) i + h * 0) else 0.
  Lemma symplectic_vanishes i : (i < d)%nat -> vanishes 2 (fun x h =>
    y x i + h * (if velocity i then D [] (y x) i else D [] (kicked x h) i) - exact x h i).
  Proof.
    intros I. destruct (velocity i) eqn:V; [now apply euler_vanishes|].
    destruct (jet_stage y 1 slope_of start_tame slope_jet) as [D1 N1]. destruct exact_jet as [DX NX].
    assert (Dk : vector_derives kicked kicked').
    { intros j J x h H. unfold kicked, kicked'. destruct (velocity j).
      - apply (D1 0%nat ltac:(lia) j J x h H).
      - apply (is_derive_const (K := R_AbsRing) (V := R_NormedModule) (y x j)). }
    assert (Nk : vector_tame kicked).
    { intros n j J. unfold kicked. destruct (velocity j); [now apply (N1 0%nat ltac:(lia)) | now apply start_tame]. }
    assert (Nk' : vector_tame kicked').
    { intros n j J. unfold kicked'. destruct (velocity j).
      - assert (M := N1 1%nat ltac:(lia) n j J). unfold stage_of, slope_of in M. cbn [INR] in M. exact M.
      - apply (tame_number n 0). }
    apply (error_vanishes 0 (fun n x h => match n
      with O => D [] (kicked x h) i | _ => first (kicked x h) (kicked' x h) i end)
      (fun n x h => exact_of n x h i) (fun x => y x i)).
    - intros [|n] low; [|lia]. split; [now apply field_derives | apply DX; trivial; lia].
    - now apply field_tame.
    - now apply first_tame.
    - apply NX; trivial; lia.
    - intros x _. unfold exact_of. now rewrite Rplus_0_r.
    - intros [|n] x _ low; [|lia]. unfold exact_of, exact. rewrite Rplus_0_r. cbn [INR].
      replace (kicked x 0) with (y x); [ring|]. apply functional_extensionality. intros j. unfold kicked.
      destruct (velocity j); ring.
  Qed.
End Problem.
