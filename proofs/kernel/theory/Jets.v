(** Functions of a step h with bounded derivatives of all orders, on any smooth problem; curves with the first three. *)

From Coq Require Import QArith Qreals Reals Lra Lia List FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
From driftproof Require Import Readouts Problems.
Import ListNotations.
Open Scope R_scope.

Lemma finite_choice {A : Type} (a : A) (d : nat) (P : nat -> A -> Prop) :
  (forall i, (i < d)%nat -> exists x, P i x) -> exists x, forall i, (i < d)%nat -> P i (x i).
Proof.
  induction d as [|d IH]; intros all; [exists (fun _ => a); lia|].
  destruct IH as [x X]; [intros; apply all; lia|]. destruct (all d ltac:(lia)) as [z Z].
  exists (fun i => if Nat.eq_dec i d then z else x i). intros i below.
  destruct (Nat.eq_dec i d) as [->|]; [exact Z | apply X; lia].
Qed.

Lemma le_total d x : forall i, (i < d)%nat -> (forall j, (j < d)%nat -> 0 <= x j) -> x i <= total d x.
Proof.
  induction d as [|d IH]; intros i below positive; [lia|]. cbn [total]. assert (0 <= total d x).
  { clear IH below. assert (all : forall j, (j < d)%nat -> 0 <= x j) by (intros; apply positive; lia).
    clear positive. induction d; cbn [total]; [lra|]. generalize (all d ltac:(lia)).
    assert (0 <= total d x) by (apply IHd; intros; apply all; lia). lra. }
  destruct (Nat.eq_dec i d) as [->|]; [lra|].
  generalize (IH i ltac:(lia) ltac:(intros; apply positive; lia)), (positive d ltac:(lia)). lra.
Qed.

(** One bound for finitely many. *)
Lemma finite_bound d (P : nat -> R -> Prop) :
  (forall i C C', P i C -> C <= C' -> P i C') -> (forall i, (i < d)%nat -> exists C, P i C) ->
  exists C, 0 <= C /\ forall i, (i < d)%nat -> P i C.
Proof.
  intros up all. destruct (finite_choice 0 d P all) as [C bound]. exists (total d (fun i => Rabs (C i))).
  split; [clear; induction d; cbn [total]; [lra | generalize (Rabs_pos (C d)); lra]|].
  intros i below. apply up with (C i); [now apply bound|]. apply Rle_trans with (Rabs (C i)); [apply Rle_abs|].
  apply (le_total d (fun i => Rabs (C i))); [assumption | intros; apply Rabs_pos].
Qed.

Lemma total_ext d x z : (forall j, (j < d)%nat -> x j = z j) -> total d x = total d z.
Proof. induction d as [|d IH]; intros E; cbn [total]; [reflexivity|]. rewrite IH, E; auto. Qed.
Lemma total_plus d x z : total d (fun j => x j + z j) = total d x + total d z.
Proof. induction d as [|d IH]; cbn [total]; [ring|]. rewrite IH. ring. Qed.
Lemma total_scal d a x : total d (fun j => a * x j) = a * total d x.
Proof. induction d as [|d IH]; cbn [total]; [ring|]. rewrite IH. ring. Qed.
Lemma total_bound d x M : (forall j, (j < d)%nat -> Rabs (x j) <= M) -> Rabs (total d x) <= INR d * M.
Proof.
  induction d as [|d IH]; intros small; cbn [total]; [rewrite Rabs_R0; cbn; lra|]. rewrite S_INR.
  eapply Rle_trans; [apply Rabs_triang|]. generalize (IH ltac:(intros; apply small; lia)), (small d ltac:(lia)). lra.
Qed.
Lemma derive_total d (x : nat -> R -> R) x' t : (forall j, (j < d)%nat -> is_derive (x j) t (x' j)) ->
  is_derive (fun s => total d (fun j => x j s)) t (total d x').
Proof.
  induction d as [|d IH]; intros E; cbn [total]; [apply (is_derive_const (K := R_AbsRing) (V := R_NormedModule) 0)|].
  apply (is_derive_plus (fun s => total d (fun j => x j s)) (x d)); [apply IH; intros; apply E; lia | apply E; lia].
Qed.
Lemma derive_product (x z : R -> R) x' z' t : is_derive x t x' -> is_derive z t z' ->
  is_derive (fun s => x s * z s) t (x' * z t + x t * z').
Proof. intros X Z. apply (is_derive_mult x z); trivial. intros; apply Rmult_comm. Qed.

Lemma mean_value_bound (f f' : R -> R) a b M : a <= b -> (forall x, a <= x <= b -> is_derive f x (f' x)) ->
  (forall x, a <= x <= b -> Rabs (f' x) <= M) -> Rabs (f b - f a) <= M * (b - a).
Proof.
  intros [less | <-] D small; [|rewrite !Rminus_eq_0, Rabs_R0; lra].
  destruct (MVT_gen f a b f') as (c & inside & ->); rewrite ?Rmin_left, ?Rmax_right in * by lra.
  - intros x inside. apply D. lra.
  - intros x inside. apply derivable_continuous_pt. exists (f' x). apply is_derive_Reals, D, inside.
  - rewrite Rabs_mult, (Rabs_pos_eq (b - a)) by lra. apply Rmult_le_compat_r; [lra | apply small; lra].
Qed.

(** A smooth problem, and its solution on [0, T]. *)
Class problem := {
  d : nat; velocity : nat -> bool; D : list nat -> vector -> vector; T : R; y : R -> vector;
  smooth_D : smooth d D; T_pos : 0 <= T; y_solves : solution d (D []) T y }.

Section Problem.
  Context {P : problem}.

  (** Functions of a time x and of a step h from there, with derivatives in h that are limited. *)
  Definition inside (x h : R) : Prop := 0 <= x /\ 0 <= h <= 1 /\ x + h <= T.
  Definition limited (g : R -> R -> R) : Prop := exists C, forall x h, inside x h -> Rabs (g x h) <= C.
  Definition derives (g g' : R -> R -> R) : Prop := forall x h, inside x h -> is_derive (g x) h (g' x h).
  Fixpoint tame (n : nat) (g : R -> R -> R) : Prop :=
    limited g /\ match n with O => True | S n => exists g', derives g g' /\ tame n g' end.

  Lemma tame_bounded n g : tame n g -> limited g.
  Proof. now destruct n; intros []. Qed.
  Lemma tame_less n : forall g, tame (S n) g -> tame n g.
  Proof. induction n as [|n IH]; intros g [B (g' & G & N)]; split; trivial. exists g'. auto. Qed.
  Lemma tame_const n : forall c : R -> R, (exists C, forall x,
    0 <= x <= T -> Rabs (c x) <= C) -> tame n (fun x _ => c x).
  Proof.
    induction n as [|n IH]; intros c [C B]; (split; [exists C; intros x h (? & ? & ?); apply B; lra|]); trivial.
    exists (fun _ _ => 0). split; [intros x h _; apply (is_derive_const (K := R_AbsRing) (V := R_NormedModule))|].
    apply (IH (fun _ => 0)). exists 0. intros. rewrite Rabs_R0. lra.
  Qed.
  Lemma tame_number n c : tame n (fun _ _ => c).
  Proof. apply (tame_const n (fun _ => c)). exists (Rabs c). intros. lra. Qed.
  Lemma tame_h n : tame n (fun _ h => h).
  Proof.
    assert (limited (fun _ h => h)) by (exists 1; intros x h (? & ? & ?); rewrite Rabs_pos_eq; lra).
    destruct n; split; trivial. exists (fun _ _ => 1). split; [|apply tame_number].
    intros x h _. apply (is_derive_id (K := R_AbsRing)).
  Qed.
  Lemma tame_plus n : forall g k, tame n g -> tame n k -> tame n (fun x h => g x h + k x h).
  Proof.
    assert (B : forall g k, limited g -> limited k -> limited (fun x h => g x h + k x h)).
    { intros g k [C G] [C' K]. exists (C + C'). intros x h I. specialize (G x h I). specialize (K x h I).
      eapply Rle_trans; [apply Rabs_triang | lra]. }
    induction n as [|n IH]; intros g k [G G'] [K K']; (split; [now apply B|]); trivial.
    destruct G' as (g' & ? & ?), K' as (k' & ? & ?). exists (fun x h => g' x h + k' x h). split; [|now apply IH].
    intros x h I. apply (is_derive_plus (g x) (k x)); auto.
  Qed.
  Lemma tame_mult n : forall g k, tame n g -> tame n k -> tame n (fun x h => g x h * k x h).
  Proof.
    assert (B : forall g k, limited g -> limited k -> limited (fun x h => g x h * k x h)).
    { intros g k [C G] [C' K]. exists (C * C'). intros x h I. rewrite Rabs_mult.
      apply Rmult_le_compat; auto using Rabs_pos. }
    induction n as [|n IH]; intros g k G K; (split; [apply B; eapply tame_bounded; eassumption|]); trivial.
    destruct G as [BG (g' & ? & ?)] eqn:EG, K as [BK (k' & ? & ?)] eqn:EK.
    exists (fun x h => g' x h * k x h + g x h * k' x h). split.
    - intros x h I. apply derive_product; auto.
    - apply tame_plus; apply IH; trivial; apply tame_less; split; eauto.
  Qed.
  Lemma tame_total n m (g : nat -> R -> R -> R) : (forall j, (j < m)%nat -> tame n (g j)) ->
    tame n (fun x h => total m (fun j => g j x h)).
  Proof.
    induction m as [|m IH]; intros all; cbn [total]; [apply tame_number|].
    apply tame_plus; [apply IH; intros; apply all; lia | apply all; lia].
  Qed.
  Lemma tame_D n : forall l (c : R -> R -> vector) i, (i < d)%nat -> (forall j,
    (j < d)%nat -> tame n (fun x h => c x h j)) ->
    tame n (fun x h => D l (c x h) i).
  Proof.
    induction n as [|n IH]; intros l c i below C.
    all: assert (limited (fun x h => D l (c x h) i)) by
      (destruct (finite_bound d (fun j B => forall x h, inside x h -> Rabs (c x h j) <= B)) as (B & _ & all);
        [intros j ? ? S ? x h I; specialize (S x h I); lra | intros j J; apply (tame_bounded _ _ (C j J)) |];
       destruct (bounded_on_balls d D smooth_D l B) as [M bound]; exists M; intros x h I; apply bound; trivial;
       intros j J; now apply all).
    1: split; trivial.
    split; trivial.
    destruct (finite_choice (fun _ _ => 0) d (fun j g => derives (fun x h => c x h j) g /\ tame n g)) as [c' C'].
    { intros j J. destruct (C j J) as [_ (g & ? & ?)]. now exists g. }
    exists (fun x h => total d (fun j => D (j :: l)%list (c x h) i * c' j x h)). split.
    - intros x h I. apply (chain_rule d D smooth_D l (c x) (fun j => c' j x h)); trivial. intros j J. now apply C'.
    - apply tame_total. intros j J. apply tame_mult; [|now apply C'].
      apply IH; trivial. intros k K. now apply tame_less, C.
  Qed.

  (** D l (c) along u, where c moves with c': and the first three derivatives of f (c). *)
  Definition along (l : list nat) (c u : vector) (i : nat) : R := total d (fun j => D (j :: l)%list c i * u j).
  Definition along' (l : list nat) (c c' u u' : vector) (i : nat) : R :=
    total d (fun j => along (j :: l)%list c c' i * u j + D (j :: l)%list c i * u' j).
  Definition first (c u : vector) : vector := along [] c u.
  Definition second (c u v : vector) : vector := along' [] c u u v.
  Definition third (c u v w : vector) : vector := fun i =>
    total d (fun j => along' [j] c u u v i * u j + along [j] c u i * v j + (along [j] c u i * v j + D [j] c i * w j)).

  (** A curve with its first three derivatives; others follow. *)
  Definition vector_derives (c c' : R -> R -> vector) : Prop :=
    forall i, (i < d)%nat -> derives (fun x h => c x h i) (fun x h => c' x h i).
  Definition vector_tame (c : R -> R -> vector) : Prop := forall n i, (i < d)%nat -> tame n (fun x h => c x h i).
  Definition jet (c : nat -> R -> R -> vector) : Prop :=
    (forall n, (n < 3)%nat -> vector_derives (c n) (c (S n))) /\ forall n, (n <= 3)%nat -> vector_tame (c n).

  Lemma derives_along l c c' u u' : vector_derives c c' -> vector_derives u u' ->
    forall i, (i < d)%nat -> derives (fun x h => along l (c x h) (u x h) i)
      (fun x h => along' l (c x h) (c' x h) (u x h) (u' x h) i).
  Proof.
    intros C U i I x h H. apply derive_total. intros j J. apply derive_product; [|now apply U].
    apply (chain_rule d D smooth_D _ (c x) (c' x h)); trivial. intros k K. now apply C.
  Qed.

  Lemma field_derives c c1 : vector_derives c c1 ->
    vector_derives (fun x h => D [] (c x h)) (fun x h => first (c x h) (c1 x h)).
  Proof. intros C i I x h H. apply (chain_rule d D smooth_D [] (c x) (c1 x h)); trivial. intros j J. now apply C. Qed.
  Lemma first_derives c c1 c2 : vector_derives c c1 -> vector_derives c1 c2 ->
    vector_derives (fun x h => first (c x h) (c1 x h)) (fun x h => second (c x h) (c1 x h) (c2 x h)).
  Proof. intros C C1 i I. now apply derives_along. Qed.
  Lemma second_derives c c1 c2 c3 : vector_derives c c1 -> vector_derives c1 c2 -> vector_derives c2 c3 ->
    vector_derives (fun x h => second (c x h) (c1 x h) (c2 x h)) (fun x h => third (c x h) (c1 x h) (c2 x h) (c3 x h)).
  Proof.
    intros C C1 C2 i I x h H. apply derive_total. intros j J.
    apply (is_derive_plus (fun h => along [j] (c x h) (c1 x h) i * c1 x h j) (fun h => D [j] (c x h) i * c2 x h j)).
    - apply derive_product; [now apply derives_along | now apply C1].
    - apply derive_product; [|now apply C2].
      apply (chain_rule d D smooth_D [j] (c x) (c1 x h)); trivial. intros k K. now apply C.
  Qed.
  Lemma field_tame c : vector_tame c -> vector_tame (fun x h => D [] (c x h)).
  Proof. intros N n i I. apply tame_D; auto. Qed.
  Lemma first_tame c u : vector_tame c -> vector_tame u -> vector_tame (fun x h => first (c x h) (u x h)).
  Proof.
    intros N N1 n i I. unfold first, along. apply tame_total. intros j J. apply tame_mult; [apply tame_D |]; auto.
  Qed.
  Lemma second_tame c u v : vector_tame c -> vector_tame u -> vector_tame v ->
    vector_tame (fun x h => second (c x h) (u x h) (v x h)).
  Proof.
    intros N N1 N2 n i I. unfold second, along', along. apply tame_total. intros j J.
    apply tame_plus; apply tame_mult; auto; [|apply tame_D; auto].
    apply tame_total. intros k K. apply tame_mult; [apply tame_D|]; auto.
  Qed.
  Lemma third_tame c u v w : vector_tame c -> vector_tame u -> vector_tame v -> vector_tame w ->
    vector_tame (fun x h => third (c x h) (u x h) (v x h) (w x h)).
  Proof.
    intros N N1 N2 N3 n i I. unfold third, along', along. apply tame_total. intros j J.
    repeat apply tame_plus; apply tame_mult; auto; try (apply tame_D; auto).
    all: apply tame_total; intros k K; repeat apply tame_plus; apply tame_mult; auto; try (apply tame_D; auto).
    apply tame_total; intros m M; apply tame_mult; auto. apply tame_D; auto.
  Qed.
  Definition field_of (c : nat -> R -> R -> vector) (n : nat) : R -> R -> vector := fun x h =>
    match n with
    | O => D [] (c 0%nat x h)
    | 1%nat => first (c 0%nat x h) (c 1%nat x h)
    | 2%nat => second (c 0%nat x h) (c 1%nat x h) (c 2%nat x h)
    | _ => third (c 0%nat x h) (c 1%nat x h) (c 2%nat x h) (c 3%nat x h)
    end.
  Lemma jet_field c : jet c -> jet (field_of c).
  Proof.
    intros [C N]. assert (N0 := N 0%nat ltac:(lia)). assert (N1 := N 1%nat ltac:(lia)).
    assert (N2 := N 2%nat ltac:(lia)). assert (N3 := N 3%nat ltac:(lia)). split; intros [|[|[|[|n]]]] low; try lia.
    - apply field_derives, C. lia.
    - apply first_derives; apply C; lia.
    - apply second_derives; apply C; lia.
    - now apply field_tame.
    - now apply first_tame.
    - now apply second_tame.
    - now apply third_tame.
  Qed.

  Lemma derive_stage (k k1 : R -> R) s a h : is_derive k h (k1 h) ->
    is_derive (fun h => s + a * h * k h) h (a * (1 * k h + h * k1 h)).
  Proof.
    intros K. auto_derive; [now exists (k1 h)|]. replace (Derive (fun h => k h) h) with (k1 h); [ring|].
    symmetry. now apply is_derive_unique.
  Qed.
  Lemma derive_next m (k k1 k2 : R -> R) a n h : is_derive k h (k1 h) -> is_derive k1 h (k2 h) -> n = m + 1 ->
    is_derive (fun h => a * (m * k h + h * k1 h)) h (a * (n * k1 h + h * k2 h)).
  Proof.
    intros K K1 ->. auto_derive; [repeat split; eexists; eassumption|].
    replace (Derive (fun h => k h) h) with (k1 h) by (symmetry; now apply is_derive_unique).
    replace (Derive (fun h => k1 h) h) with (k2 h) by (symmetry; now apply is_derive_unique). ring.
  Qed.

  (** y + a h k. *)
  Definition stage_of (start : R -> vector) (a : R) (k : nat -> R -> R -> vector) (n : nat) : R -> R -> vector :=
    fun x h i => match n with
    | O => start x i + a * h * k 0%nat x h i
    | S m => a * (INR n * k m x h i + h * k n x h i)
    end.
  Lemma jet_stage start a k : vector_tame (fun x _ => start x) -> jet k -> jet (stage_of start a k).
  Proof.
    intros S [K N]. split; intros n low m.
    - intros I x h H. destruct n as [|n].
      + apply (derive_stage (fun h => k 0%nat x h m) (fun h => k 1%nat x h m)). now apply K.
      + apply (derive_next (INR (Datatypes.S n)) (fun h => k n x h m) (fun h => k (Datatypes.S n) x h m)
                 (fun h => k (Datatypes.S (Datatypes.S n)) x h m)).
        1-2: apply K; trivial; lia.
        apply S_INR.
    - intros i I. destruct n as [|n].
      + apply (tame_plus m (fun x _ => start x i)); [now apply S|].
        repeat apply tame_mult; auto using tame_number, tame_h. now apply N.
      + apply (tame_mult m (fun _ _ => a)); [apply tame_number|].
        apply tame_plus; apply tame_mult; auto using tame_number, tame_h; apply N; trivial; lia.
  Qed.

  Lemma solution_bounded : exists B, 0 <= B /\ forall t i, 0 <= t <= T -> (i < d)%nat -> Rabs (y t i) <= B.
  Proof.
    destruct (finite_bound d (fun i B => forall t, 0 <= t <= T -> Rabs (y t i) <= B)) as (B & pos & all).
    - intros i ? ? S ? t H. specialize (S t H). lra.
    - intros i I. assert (continuous : forall t, 0 <= t <= T -> continuity_pt (fun s => y s i) t).
      { intros t H. apply derivable_continuous_pt. exists (D [] (y t) i). now apply is_derive_Reals, y_solves. }
      destruct (continuity_ab_maj (fun s => y s i) 0 T T_pos continuous) as (b & high & _).
      destruct (continuity_ab_min (fun s => y s i) 0 T T_pos continuous) as (a & low & _).
      exists (Rabs (y a i) + Rabs (y b i)). intros t H. specialize (high t H). specialize (low t H). cbn beta in *.
      revert high low. unfold Rabs; repeat destruct Rcase_abs; lra.
    - exists B. split; [exact pos | intros; now apply all].
  Qed.

  Definition exact (x h : R) : vector := y (x + h).
  Lemma exact_derives i : (i < d)%nat -> derives (fun x h => exact x h i) (fun x h => D [] (exact x h) i).
  Proof.
    intros I x h (X & H & XH). unfold exact.
    evar_last; [apply (is_derive_comp (fun t => y t i) (fun h => x + h));
                [apply y_solves; [lra | exact I] | auto_derive; trivial] |].
    unfold scal; cbn. unfold mult; cbn. ring.
  Qed.
  Lemma exact_tame : vector_tame exact.
  Proof.
    intros n. induction n as [|n IH]; intros i I.
    all: assert (limited (fun x h => exact x h i))
      by (destruct solution_bounded as (B & _ & all); exists B; intros x h (? & ? & ?); apply all; [lra | exact I]).
    - now split.
    - split; trivial. exists (fun x h => D [] (exact x h) i). split; [now apply exact_derives|].
      now apply tame_D.
  Qed.
End Problem.
