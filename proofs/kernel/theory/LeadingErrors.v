(** The oscillator as a smooth problem, and the leading terms of its errors: none of the orders is higher. *)

From Coq Require Import QArith Qreals Reals Lra Lia Psatz List FunctionalExtensionality.
From driftproof Require Import Runs Tables OneStep Energy Stability
  ExactFlow Phase Convergence Problems Jets GlobalErrors.
Import ListNotations.
Open Scope R_scope.

(** y' = f(y) with y = (q, v) and f(y) = (v, -q); of its partial derivatives only the first are not 0. *)
Definition oscillating (l : list nat) (y : vector) : vector := fun i =>
  match l, i with
  | [], O => y 1%nat | [], _ => - y 0%nat
  | [1%nat], O => 1 | [0%nat], S _ => -1
  | _, _ => 0
  end.
Definition pair_vector (z : state R) : vector := fun i => match i with O => fst z | _ => snd z end.

Theorem oscillator_is_smooth : smooth 2 oscillating
  /\ (forall T, solution 2 (oscillating []) T (fun t => pair_vector (flow t)))
  /\ forall m h z n, In m [forward_euler; symplectic_euler; rk4] ->
       vector_run (oscillating []) (Nat.ltb 0) h m n (pair_vector z) = pair_vector (run m h n z).
Proof.
  split; [|split].
  - split.
    + intros l c c' t i I C. assert (C0 := C 0%nat ltac:(lia)). assert (C1 := C 1%nat ltac:(lia)).
      cbn [total]. assert (zero : forall a, is_derive (fun _ : R => a) t 0)
        by (intros a; apply (is_derive_const (K := R_AbsRing) (V := R_NormedModule))).
      destruct l as [|j l].
      * destruct i as [|[|i]]; try lia; cbn [oscillating].
        -- evar_last; [exact C1 | real_ring].
        -- evar_last; [apply (is_derive_opp (fun s => c s 0%nat)), C0 | unfold opp; cbn; ring].
      * assert (E : forall k y, oscillating (k :: j :: l) y i = 0) by (intros [|[|k]] z; destruct i; reflexivity).
        rewrite !E. evar_last; [|instantiate (1 := 0); real_ring].
        apply is_derive_ext with (f := fun _ => oscillating (j :: l) (fun _ => 0) i); [|apply zero].
        intros s. destruct j as [|[|j]], l, i; reflexivity.
    + intros l B. exists (1 + Rabs B). intros z i I Z. assert (A := Rle_abs B). assert (A' := Rabs_pos B).
      assert (Z0 := Z 0%nat ltac:(lia)). assert (Z1 := Z 1%nat ltac:(lia)).
      destruct l as [|[|[|j]] [|k l]], i; cbn [oscillating]; rewrite ?Rabs_Ropp, ?Rabs_R0, ?Rabs_R1; try lra.
      rewrite Rabs_m1 || (unfold Rabs; destruct Rcase_abs); lra.
  - intros T t i _ I. destruct i as [|[|i]]; try lia; cbn [pair_vector flow fst snd oscillating]; apply L019.
  - intros m h z n M. induction n as [|n IH]; [reflexivity|]. cbn [vector_run run]. rewrite IH.
    generalize (run m h n z). clear - M. intros [q v]. apply functional_extensionality. intros i.
    destruct M as [<- | [<- | [<- | []]]]; destruct i as [|i]; unfold pair_vector; expose; field.
Qed.

(** How far two states are apart, by components. *)
Definition near (z w : state R) (e : R) : Prop := Rabs (fst z - fst w) <= e /\ Rabs (snd z - snd w) <= e.

(** Steps that stretch by at most 1 + 2h, and u that misses a step by at most K h^(p+2): runs stay O(h^(p+1)) from u. *)
Lemma follows (step : state R -> state R) (u : R -> state R) h p K T : 0 < h -> 0 <= K ->
  (forall z w e, near z w e -> near (step z) (step w) ((1 + 2 * h) * e)) ->
  (forall t, 0 <= t <= T -> near (step (u t)) (u (t + h)) (K * h ^ (p + 2))) ->
  forall n, INR n * h <= T -> near (Nat.iter n step (u 0)) (u (INR n * h)) (T * K * exp (2 * T) * h ^ (p + 1)).
Proof.
  intros pos K_pos stretch misses n low.
  assert (induction : near (Nat.iter n step (u 0)) (u (INR n * h)) (INR n * (K * h ^ (p + 2)) * (1 + 2 * h) ^ n)).
  { induction n as [|n IH].
    - cbn [Nat.iter nat_rect INR]. rewrite Rmult_0_l. unfold near. rewrite !Rminus_eq_0, Rabs_R0. lra.
    - rewrite S_INR in low. assert (0 <= INR n) by apply pos_INR. specialize (IH ltac:(nra)).
      apply stretch in IH. destruct IH as [Q V]. destruct (misses (INR n * h) ltac:(nra)) as [Q' V'].
      cbn [Nat.iter nat_rect]. fold (Nat.iter n step (u 0)). rewrite S_INR.
      replace ((INR n + 1) * h) with (INR n * h + h) by ring.
      assert (0 <= K * h ^ (p + 2)) by (apply Rmult_le_pos; [lra | apply pow_le; lra]).
      assert (1 <= (1 + 2 * h) ^ S n) by (apply pow_R1_Rle; lra).
      assert (E : (1 + 2 * h) * (INR n * (K * h ^ (p + 2)) * (1 + 2 * h) ^ n) + K * h ^ (p + 2)
                  <= (INR n + 1) * (K * h ^ (p + 2)) * (1 + 2 * h) ^ S n) by (cbn [pow] in *; nra).
      split; (eapply Rle_trans; [|exact E]).
      + replace (_ - _) with ((fst (step (Nat.iter n step (u 0))) - fst (step (u (INR n * h))))
          + (fst (step (u (INR n * h))) - fst (u (INR n * h + h)))) by ring.
        eapply Rle_trans; [apply Rabs_triang | now apply Rplus_le_compat].
      + replace (_ - _) with ((snd (step (Nat.iter n step (u 0))) - snd (step (u (INR n * h))))
          + (snd (step (u (INR n * h))) - snd (u (INR n * h + h)))) by ring.
        eapply Rle_trans; [apply Rabs_triang | now apply Rplus_le_compat]. }
  assert (grown : INR n * (K * h ^ (p + 2)) * (1 + 2 * h) ^ n <= T * K * exp (2 * T) * h ^ (p + 1)).
  { assert (0 <= INR n) by apply pos_INR. assert (E := pow_le_exp (2 * h) n ltac:(lra)).
    assert (exp (INR n * (2 * h)) <= exp (2 * T)).
    { destruct (Rle_lt_or_eq_dec (INR n * (2 * h)) (2 * T)) as [less | ->]; [nra | | lra].
      now apply Rlt_le, exp_increasing. }
    assert (0 <= K * h ^ (p + 1)) by (apply Rmult_le_pos; [lra | apply pow_le; lra]).
    replace (INR n * (K * h ^ (p + 2)) * (1 + 2 * h) ^ n) with (INR n * h * (K * h ^ (p + 1) * (1 + 2 * h) ^ n))
      by (replace (p + 2)%nat with (S (p + 1)) by lia; cbn [pow]; ring).
    replace (T * K * exp (2 * T) * h ^ (p + 1)) with (T * (K * h ^ (p + 1) * exp (2 * T))) by ring.
    assert (0 <= (1 + 2 * h) ^ n) by (apply pow_le; lra).
    apply Rmult_le_compat; [nra | apply Rmult_le_pos; assumption | exact low | apply Rmult_le_compat_l; lra]. }
  destruct induction. split; lra.
Qed.

Lemma steps_stretch m h : In m [forward_euler; symplectic_euler; rk4] -> 0 < h <= 1 ->
  forall z w e, near z w e -> near (step m h z) (step m h w) ((1 + 2 * h) * e).
Proof.
  intros M H [q v] [x y] e [Q V]. cbn [fst snd] in Q, V. assert (0 <= e) by (generalize (Rabs_pos (q - x)); lra).
  assert (combine : forall a b, Rabs a + Rabs b <= 1 + 2 * h -> Rabs (a * (q - x) + b * (v - y)) <= (1 + 2 * h) * e).
  { intros a b small. eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult.
    generalize (Rabs_pos a), (Rabs_pos b). nra. }
  assert (0 < h ^ 2 <= h) by (split; nra). assert (0 < h ^ 3 <= h ^ 2) by (split; cbn [pow] in *; nra).
  assert (0 < h ^ 4 <= h ^ 3) by (split; cbn [pow] in *; nra).
  destruct M as [<- | [<- | [<- | []]]].
  - split.
    + replace (_ - _) with (1 * (q - x) + h * (v - y)) by by_ring. apply combine. rewrite !Rabs_pos_eq; lra.
    + replace (_ - _) with (- h * (q - x) + 1 * (v - y)) by by_ring. apply combine.
      rewrite Rabs_Ropp, !Rabs_pos_eq; lra.
  - split.
    + replace (_ - _) with ((1 - h ^ 2) * (q - x) + h * (v - y)) by by_ring. apply combine. rewrite !Rabs_pos_eq; lra.
    + replace (_ - _) with (- h * (q - x) + 1 * (v - y)) by by_ring. apply combine.
      rewrite Rabs_Ropp, !Rabs_pos_eq; lra.
  - split.
    + replace (_ - _) with ((1 - h ^ 2 / 2 + h ^ 4 / 24) * (q - x) + (h - h ^ 3 / 6) * (v - y)) by by_ring.
      apply combine. rewrite !Rabs_pos_eq; lra.
    + replace (_ - _) with (- (h - h ^ 3 / 6) * (q - x) + (1 - h ^ 2 / 2 + h ^ 4 / 24) * (v - y)) by by_ring.
      apply combine. rewrite Rabs_Ropp, !Rabs_pos_eq; lra.
Qed.

Lemma of_cos_sin t a b e : Rabs a + Rabs b <= e -> Rabs (a * cos t + b * sin t) <= e.
Proof.
  intros small. generalize (COS_bound t), (SIN_bound t). intros C S. eapply Rle_trans; [apply Rabs_triang|].
  rewrite !Rabs_mult. assert (Rabs (cos t) <= 1) by (apply Rabs_le; lra).
  assert (Rabs (sin t) <= 1) by (apply Rabs_le; lra).
  generalize (Rabs_pos a), (Rabs_pos b), (Rabs_pos (cos t)), (Rabs_pos (sin t)). nra.
Qed.

(** The flow, and the first term of the error. *)
Definition with_error (p : nat) (w : R -> state R) (h t : R) : state R :=
  (fst (flow t) + h ^ p * fst (w t), snd (flow t) + h ^ p * snd (w t)).
Definition misses (m : method) (p : nat) (w : R -> state R) : Prop := exists K, 0 <= K /\ forall h t,
  0 < h <= 1 -> 0 <= t <= 10 ->
  near (step m h (with_error p w h t)) (with_error p w h (t + h)) (K * h ^ (p + 2)).

Ltac series h :=
  assert (C2 := cos_2 h ltac:(lra)); assert (C4 := cos_4 h ltac:(lra)); assert (C6 := cos_6 h ltac:(lra));
  assert (S1 := sin_1 h ltac:(lra)); assert (S3 := sin_3 h ltac:(lra)); assert (S5 := sin_5 h ltac:(lra));
  assert (S7 := sin_7 h ltac:(lra)).

Lemma forward_euler_misses : misses forward_euler 1 (fun t => (t / 2 * cos t, - (t / 2 * sin t))).
Proof.
  exists 10. split; [lra|]. intros h t H I. series h. unfold with_error, flow; cbn [fst snd].
  rewrite cos_plus, sin_plus. generalize dependent (cos h). intros C. generalize dependent (sin h). intros S. intros.
  assert (0 < h ^ 2 <= h) by (split; nra). assert (0 < h ^ 3 <= h ^ 2) by (split; cbn [pow] in *; nra).
  assert (0 < h ^ 4 <= h ^ 3) by (split; cbn [pow] in *; nra).
  assert (0 <= h * t * (1 - C) <= h * 10 * (h ^ 2 / 2)) by (split; [|apply Rmult_le_compat]; repeat apply Rmult_le_pos;
    nra).
  assert (0 <= h ^ 2 * (1 - C) <= h ^ 2 * (h ^ 2 / 2)) by (split; nra).
  assert (X : Rabs ((1 + h * t / 2) * (1 - C) - h ^ 2 / 2 * C) <= 4 * h ^ 3) by (apply Rabs_le; split; lra).
  assert (0 <= h * t * (h - S) <= h * 10 * (h ^ 3 / 6)) by (split; [|apply Rmult_le_compat]; repeat apply Rmult_le_pos;
    nra).
  assert (0 <= h ^ 2 * S <= h ^ 2 * h) by (split; nra).
  assert (Y : Rabs ((1 + h * t / 2) * (h - S) - h ^ 2 / 2 * S) <= 4 * h ^ 3) by (apply Rabs_le; split; lra).
  split.
  - replace (_ - _) with (((1 + h * t / 2) * (1 - C) - h ^ 2 / 2 * C) * cos t
      + - ((1 + h * t / 2) * (h - S) - h ^ 2 / 2 * S) * sin t) by by_ring.
    apply of_cos_sin. rewrite Rabs_Ropp. change (1 + 2)%nat with 3%nat. lra.
  - replace (_ - _) with (- ((1 + h * t / 2) * (h - S) - h ^ 2 / 2 * S) * cos t
      + - ((1 + h * t / 2) * (1 - C) - h ^ 2 / 2 * C) * sin t) by by_ring.
    apply of_cos_sin. rewrite !Rabs_Ropp. change (1 + 2)%nat with 3%nat. lra.
Qed.

Lemma symplectic_euler_misses : misses symplectic_euler 1 (fun t => (- (sin t / 2), 0)).
Proof.
  exists 10. split; [lra|]. intros h t H I. series h. unfold with_error, flow; cbn [fst snd].
  rewrite cos_plus, sin_plus. generalize dependent (cos h). intros C. generalize dependent (sin h). intros S. intros.
  assert (0 < h ^ 2 <= h) by (split; nra). assert (0 < h ^ 3 <= h ^ 2) by (split; cbn [pow] in *; nra).
  assert (0 < h ^ 4 <= h ^ 3) by (split; cbn [pow] in *; nra).
  split.
  - replace (_ - _) with ((1 - h ^ 2 - C + h / 2 * S) * cos t + (h ^ 3 / 2 - 3 / 2 * h + S + h / 2 * C) * sin t)
      by by_ring.
    apply of_cos_sin. change (1 + 2)%nat with 3%nat.
    assert (Rabs (1 - h ^ 2 - C + h / 2 * S) <= 3 * h ^ 3) by (apply Rabs_le; split; nra).
    assert (Rabs (h ^ 3 / 2 - 3 / 2 * h + S + h / 2 * C) <= 3 * h ^ 3) by (apply Rabs_le; split; nra). lra.
  - replace (_ - _) with ((S - h) * cos t + (C - 1 + h ^ 2 / 2) * sin t) by by_ring.
    apply of_cos_sin. change (1 + 2)%nat with 3%nat.
    assert (Rabs (S - h) <= h ^ 3) by (apply Rabs_le; split; nra).
    assert (Rabs (C - 1 + h ^ 2 / 2) <= h ^ 3) by (apply Rabs_le; split; nra). lra.
Qed.

Lemma rk4_misses : misses rk4 4 (fun t => (t / 120 * sin t, t / 120 * cos t)).
Proof.
  exists 10. split; [lra|]. intros h t H I. series h. unfold with_error, flow; cbn [fst snd].
  rewrite cos_plus, sin_plus. generalize dependent (cos h). intros C. generalize dependent (sin h). intros S. intros.
  set (a := 1 - h ^ 2 / 2 + h ^ 4 / 24). set (b := h - h ^ 3 / 6).
  assert (B2 : 0 < h ^ 2 <= h) by (split; nra). assert (B3 : 0 < h ^ 3 <= h ^ 2) by (split; cbn [pow] in *; nra).
  assert (B4 : 0 < h ^ 4 <= h ^ 3) by (split; cbn [pow] in *; nra).
  assert (B5 : 0 < h ^ 5 <= h ^ 4) by (split; cbn [pow] in *; nra).
  assert (B6 : 0 < h ^ 6 <= h ^ 5) by (split; cbn [pow] in *; nra).
  assert (B7 : 0 < h ^ 7 <= h ^ 6) by (split; cbn [pow] in *; nra).
  assert (A : 0 <= a - C <= h ^ 6 / 720) by (unfold a; lra).
  assert (B : 0 <= S - b <= h ^ 5 / 120) by (unfold b; lra).
  assert (F4 : 0 < h ^ 4 / 120 <= 1) by lra.
  assert (P : 0 <= t * (S - b) <= 10 * (h ^ 5 / 120)) by (split; [apply Rmult_le_pos | apply Rmult_le_compat]; lra).
  assert (P' : 0 <= t * (a - C) <= 10 * (h ^ 6 / 720)) by (split; [apply Rmult_le_pos | apply Rmult_le_compat]; lra).
  assert (S0 : 0 <= h * S <= h * h) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
  assert (X : Rabs (a - C + h ^ 4 / 120 * (t * b - (t + h) * S)) <= 2 * h ^ 6).
  { replace (h ^ 4 / 120 * (t * b - (t + h) * S)) with (- (h ^ 4 / 120 * (t * (S - b) + h * S))) by ring.
    assert (0 <= h ^ 4 / 120 * (t * (S - b) + h * S) <= h ^ 4 / 120 * (h ^ 2 + h ^ 2))
      by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
    replace (h ^ 4 / 120 * (h ^ 2 + h ^ 2)) with (h ^ 6 / 60) in * by field. apply Rabs_le. lra. }
  assert (Y : Rabs (S - b + h ^ 4 / 120 * (t * a - (t + h) * C)) <= 2 * h ^ 6).
  { replace (S - b + h ^ 4 / 120 * (t * a - (t + h) * C))
      with (S - b - h ^ 5 / 120 + h ^ 4 / 120 * (t * (a - C)) + h ^ 5 / 120 * (1 - C)) by field.
    assert (0 <= h ^ 4 / 120 * (t * (a - C)) <= 1 * (10 * (h ^ 6 / 720))) by (split;
      [apply Rmult_le_pos | apply Rmult_le_compat]; lra).
    assert (0 <= h ^ 5 / 120 * (1 - C) <= h ^ 5 / 120 * (h ^ 2 / 2)) by (split;
      [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
    replace (h ^ 5 / 120 * (h ^ 2 / 2)) with (h ^ 7 / 240) in * by field.
    assert (- (h ^ 7 / 5040) <= S - b - h ^ 5 / 120) by (unfold b; lra). apply Rabs_le. lra. }
  split.
  - replace (_ - _) with ((a - C + h ^ 4 / 120 * (t * b - (t + h) * S)) * cos t
      + (S - b + h ^ 4 / 120 * (t * a - (t + h) * C)) * sin t) by (unfold a, b; by_ring).
    apply of_cos_sin. change (4 + 2)%nat with 6%nat. lra.
  - replace (_ - _) with ((S - b + h ^ 4 / 120 * (t * a - (t + h) * C)) * cos t
      + - (a - C + h ^ 4 / 120 * (t * b - (t + h) * S)) * sin t) by (unfold a, b; by_ring).
    apply of_cos_sin. rewrite Rabs_Ropp. change (4 + 2)%nat with 6%nat. lra.
Qed.

(** The error at t = 10 after n steps, n h = 10, and its leading term c h^p. *)
Definition final_error (m : method) (h : R) (n : nat) : R := distance (run m h n (1, 0)) (flow 10).
Definition leading (m : method) (p : nat) (c : R) : Prop := exists K, forall h n, 0 < h <= 1 -> INR n * h = 10 ->
  Rabs (final_error m h n - c * h ^ p) <= K * h ^ (p + 1).

Lemma Cmod_small a b e : Rabs a <= e -> Rabs b <= e -> Cmod (a, b) <= 2 * e.
Proof.
  intros A B. unfold Cmod; cbn [fst snd]. rewrite <- (sqrt_square (2 * e)) by (generalize (Rabs_pos a); lra).
  apply sqrt_le_1_alt. rewrite <- (pow2_abs a), <- (pow2_abs b). generalize (Rabs_pos a), (Rabs_pos b). nra.
Qed.

Lemma leading_of_misses m p w : In m [forward_euler; symplectic_euler; rk4] -> misses m p w -> w 0 = (0, 0) ->
  leading m p (Cmod (w 10)).
Proof.
  intros M (K & K_pos & miss) zero. exists (2 * (10 * K * exp (2 * 10))). intros h n H E.
  assert (close : near (run m h n (1, 0)) (with_error p w h 10) (10 * K * exp (2 * 10) * h ^ (p + 1))).
  { replace (run m h n (1, 0)) with (Nat.iter n (step m h) (with_error p w h 0)).
    - replace (with_error p w h 10) with (with_error p w h (INR n * h)) by now rewrite E.
      apply follows; try lra; [now apply steps_stretch|]. intros t I. now apply miss.
    - unfold with_error, flow. rewrite zero, cos_0, sin_0. cbn [fst snd].
      replace (1 + h ^ p * 0, - 0 + h ^ p * 0) with (1, 0) by (f_equal; ring).
      clear. induction n as [|n IH]; [reflexivity|]. cbn [Nat.iter nat_rect run]. unfold Nat.iter in IH.
      now rewrite IH. }
  destruct close as [Q V]. unfold with_error in Q, V. cbn [fst snd] in Q, V.
  unfold final_error. destruct (run m h n (1, 0)) as [q v], (flow 10) as [x y]. cbn [fst snd] in Q, V.
  change (distance (q, v) (x, y)) with (Cmod (q - x, v - y)).
  assert (0 <= h ^ p) by (apply pow_le; lra).
  replace (Cmod (w 10) * h ^ p) with (Cmod (h ^ p * fst (w 10), h ^ p * snd (w 10))).
  - assert (small : Cmod (q - x - h ^ p * fst (w 10), v - y - h ^ p * snd (w 10))
                    <= 2 * (10 * K * exp (2 * 10) * h ^ (p + 1))).
    { apply Cmod_small; eapply Rle_trans; [| exact Q | | exact V]; apply Req_le; f_equal; ring. }
    assert (T := Cmod_triangle (h ^ p * fst (w 10), h ^ p * snd (w 10))
                   (q - x - h ^ p * fst (w 10), v - y - h ^ p * snd (w 10))).
    assert (T' := Cmod_triangle (q - x, v - y) (- (q - x - h ^ p * fst (w 10)), - (v - y - h ^ p * snd (w 10)))).
    assert (O := Cmod_opp (q - x - h ^ p * fst (w 10), v - y - h ^ p * snd (w 10))).
    unfold Copp in O; cbn [fst snd] in O.
    unfold Cplus in T, T'; cbn [fst snd] in T, T'.
    replace (h ^ p * fst (w 10) + (q - x - h ^ p * fst (w 10)), h ^ p * snd (w 10) + (v - y - h ^ p * snd (w 10)))
      with (q - x, v - y) in T by (f_equal; ring).
    replace (q - x + - (q - x - h ^ p * fst (w 10)), v - y + - (v - y - h ^ p * snd (w 10)))
      with (h ^ p * fst (w 10), h ^ p * snd (w 10)) in T' by (f_equal; ring).
    apply Rabs_le. lra.
  - replace (h ^ p * fst (w 10), h ^ p * snd (w 10)) with (RtoC (h ^ p) * w 10)%C.
    + rewrite Cmod_mult, Cmod_R, Rabs_pos_eq by assumption. ring.
    + destruct (w 10) as [a b]. unfold Cmult, RtoC; cbn [fst snd]. f_equal; ring.
Qed.

(** A leading term that is not 0: no higher order. *)
Definition errs_by (m : method) (p : nat) : Prop := exists C h0, 0 < h0 /\ forall h n, 0 < h <= h0 -> INR n * h = 10 ->
  final_error m h n <= C * h ^ p.
Lemma large_n e : 0 < e -> exists n, 0 < 10 / INR (S n) <= e /\ INR (S n) * (10 / INR (S n)) = 10.
Proof.
  intros pos. destruct (archimed_cor1 (e / 10) ltac:(lra)) as (N & small & N0).
  exists (pred N). replace (S (pred N)) with N by lia. assert (0 < INR N) by now apply lt_0_INR.
  split; [|field; lra]. split; [apply Rdiv_lt_0_compat; lra|]. unfold Rdiv. lra.
Qed.
Lemma not_higher m p c : 0 < c -> leading m p c -> ~ errs_by m (p + 1).
Proof.
  intros pos [K lead] (C & h0 & h0_pos & all). set (B := Rabs K + Rabs C + 1).
  assert (B0 : 0 < B) by (unfold B; generalize (Rabs_pos K), (Rabs_pos C); lra).
  destruct (large_n (Rmin (Rmin h0 1) (c / (2 * B)))) as (n & [h_pos small] & E).
  { repeat apply Rmin_glb_lt; try lra. apply Rdiv_lt_0_compat; lra. }
  set (h := 10 / INR (S n)) in *.
  assert (h <= h0) by (eapply Rle_trans; [exact small|]; eapply Rle_trans; [apply Rmin_l | apply Rmin_l]).
  assert (h <= 1) by (eapply Rle_trans; [exact small|]; eapply Rle_trans; [apply Rmin_l | apply Rmin_r]).
  assert (hB : h <= c / (2 * B)) by (eapply Rle_trans; [exact small | apply Rmin_r]).
  specialize (lead h (S n) ltac:(lra) E). specialize (all h (S n) ltac:(lra) E).
  apply Rabs_le_between in lead. destruct lead as [lead _]. rewrite Nat.add_1_r in *. cbn [pow] in *.
  assert (0 < h ^ p) by (apply pow_lt; lra).
  assert (h * B <= c / 2). { apply Rmult_le_compat_r with (r := B) in hB;
    [|lra]. replace (c / (2 * B) * B) with (c / 2) in hB by (field; lra). lra. }
  assert (K <= Rabs K) by apply Rle_abs. assert (C <= Rabs C) by apply Rle_abs.
  assert (c * h ^ p <= (C + K) * (h * h ^ p)) by lra.
  assert ((C + K) * (h * h ^ p) <= B * (h * h ^ p)) by (apply Rmult_le_compat_r; [nra | unfold B; lra]).
  nra.
Qed.

Theorem leading_errors : leading forward_euler 1 5 /\ leading symplectic_euler 1 (- sin 10 / 2)
  /\ leading rk4 4 (1 / 12)
  /\ 0 < - sin 10 / 2.
Proof.
  assert (s : sin 10 < 0) by (interval).
  assert (unit : cos 10 ^ 2 + sin 10 ^ 2 = 1) by (generalize (sin2_cos2 10); unfold Rsqr; lra).
  split; [|split; [|split; [|lra]]].
  - replace 5 with (Cmod (10 / 2 * cos 10, - (10 / 2 * sin 10))).
    + apply (leading_of_misses _ _ (fun t => (t / 2 * cos t, - (t / 2 * sin t)))); [cbn;
        auto | apply forward_euler_misses | f_equal; field].
    + unfold Cmod; cbn [fst snd]. replace (_ + _) with (5 * 5) by nra. apply sqrt_square; lra.
  - replace (- sin 10 / 2) with (Cmod (- (sin 10 / 2), 0)).
    + apply (leading_of_misses _ _ (fun t => (- (sin t / 2), 0))); [cbn;
        auto | apply symplectic_euler_misses | rewrite sin_0; f_equal; field].
    + unfold Cmod; cbn [fst snd]. replace (_ + _) with ((- sin 10 / 2) * (- sin 10 / 2)) by field.
      apply sqrt_square; lra.
  - replace (1 / 12) with (Cmod (10 / 120 * sin 10, 10 / 120 * cos 10)).
    + apply (leading_of_misses _ _ (fun t => (t / 120 * sin t, t / 120 * cos t))); [cbn;
        auto | apply rk4_misses | f_equal; field].
    + unfold Cmod; cbn [fst snd]. replace (_ + _) with (1 / 12 * (1 / 12)) by nra. apply sqrt_square; lra.
Qed.

Theorem L186 : converges forward_euler 1 /\ converges symplectic_euler 1
  /\ ~ errs_by forward_euler 2 /\ ~ errs_by symplectic_euler 2.
Proof.
  destruct methods_converge as (A & B & _), leading_errors as (E & S & _ & pos).
  split; [exact A | split; [exact B|]].
  split; [apply (not_higher _ 1 5) | apply (not_higher _ 1 (- sin 10 / 2))]; trivial; lra.
Qed.

Theorem L187 : converges rk4 4 /\ ~ errs_by rk4 5.
Proof. split; [apply methods_converge | apply (not_higher _ 4 (1 / 12)); [lra | apply leading_errors]]. Qed.

Theorem L188 : one_step_error forward_euler 2 /\ one_step_error symplectic_euler 2 /\ one_step_error rk4 5.
Proof. exact one_step_errors. Qed.

Theorem L008 :
  (leading forward_euler 1 5 /\ leading symplectic_euler 1 (- sin 10 / 2) /\ leading rk4 4 (1 / 12) /\ 0 < - sin 10 / 2)
  /\ (forall m h n, 0 < h -> INR n * h = 10 ->
        INR n = 10 / h /\ INR (n * evaluations m) = INR (evaluations m) * (10 / h))
  /\ (evaluations forward_euler = 1 /\ evaluations symplectic_euler = 1 /\ evaluations rk4 = 4)%nat
  /\ (forall h, 0 < h < 2 -> bounded symplectic_euler h) /\ (forall h, 2 <= h -> ~ bounded symplectic_euler h)
  /\ (forall h, 0 <= h -> (bounded rk4 h <-> h <= 2 * sqrt 2))
  /\ forall h, 0 < h -> ~ bounded forward_euler h.
Proof.
  split; [apply leading_errors | split; [|split; [repeat split | split; [apply symplectic_bounded | split; [|split;
    [apply L175|]]]]]].
  - intros m h n pos E. assert (N : INR n = 10 / h) by (rewrite <- E; field; lra).
    split; [exact N | rewrite mult_INR, N; ring].
  - intros h [large | <-]; [now apply symplectic_unbounded | apply symplectic_at_2].
  - intros h pos all. destruct (all (1, 0)) as [B within].
    destruct (proj1 (L040 h 1 0 pos) ltac:(injection; lra) B) as [n above]. specialize (within n). lra.
Qed.

(** With y' = 1 a step adds h times the sum of the weights. *)
Lemma constant_slopes h y : forall rows known,
  vector_slopes (fun _ _ => 1) h y rows known = known ++ repeat (fun _ => 1) (length rows).
Proof.
  induction rows as [|row rows IH]; intros known; cbn [vector_slopes length repeat]; [now rewrite app_nil_r|].
  rewrite IH, <- app_assoc. reflexivity.
Qed.
Lemma constant_combined h b : forall (y : vector) i,
  combined h y b (repeat (fun _ => 1) (length b)) i = y i + Q2R (fold_right Qplus 0%Q b) * h.
Proof.
  induction b as [|c b IH]; intros y i; cbn [combined length repeat fold_right].
  - unfold Q2R; cbn; field.
  - rewrite IH, Q2R_plus. ring.
Qed.

Theorem L064 :
  (converges forward_euler 1 /\ converges symplectic_euler 1 /\ converges rk4 4)
  /\ (leading forward_euler 1 5 /\ leading symplectic_euler 1 (- sin 10 / 2) /\ leading rk4 4 (1 / 12)
    /\ 0 < - sin 10 / 2)
  /\ (exists K h0, 0 < h0 /\ forall h n, 0 < h <= h0 -> INR n * h = 10 ->
        final_error rk4 h n <= K * h ^ 3 * final_error forward_euler h n)
  /\ forall A b velocity h y i, length A = length b -> (fold_right Qplus 0 b == 1)%Q ->
       vector_step (fun _ _ => 1) velocity h (RungeKutta A b) y i = y i + h.
Proof.
  split; [apply methods_converge | split; [apply leading_errors | split]].
  - destruct leading_errors as ((K1 & E) & _ & (K4 & R) & _).
    exists (1 / 12 + Rabs K4), (/ (Rabs K1 + 1)). assert (P1 := Rabs_pos K1). assert (P4 := Rabs_pos K4).
    split; [apply Rinv_0_lt_compat; lra|]. intros h n [pos small] T.
    assert (h * (Rabs K1 + 1) <= 1).
    { apply Rmult_le_compat_r with (r := Rabs K1 + 1) in small; [|lra]. rewrite Rinv_l in small; lra. }
    assert (h <= 1) by nra. specialize (E h n ltac:(lra) T). specialize (R h n ltac:(lra) T).
    apply Rabs_le_between in E, R. cbn [Nat.add pow] in E. change (4 + 1)%nat with 5%nat in R.
    assert (A1 := Rle_abs K1). assert (A4 := Rle_abs K4).
    assert (h <= final_error forward_euler h n) by nra.
    assert (h3 : 0 < h ^ 3) by (apply pow_lt; lra).
    assert (h4 : 0 < h ^ 4) by (apply pow_lt; lra). assert (h5 : 0 < h ^ 5 <= h ^ 4) by (split; cbn [pow] in *; nra).
    assert (K4 * h ^ 5 <= Rabs K4 * h ^ 4) by (apply Rle_trans with (Rabs K4 * h ^ 5); nra).
    apply Rle_trans with ((1 / 12 + Rabs K4) * h ^ 3 * h); [replace (h ^ 3 * h) with (h ^ 4) by ring; nra|].
    apply Rmult_le_compat_l; [nra | assumption].
  - intros A b velocity h y i L S. cbn [vector_step]. rewrite constant_slopes, L.
    cbn [app]. rewrite constant_combined, (Qeq_eqR _ _ S). unfold Q2R; cbn; field.
Qed.
