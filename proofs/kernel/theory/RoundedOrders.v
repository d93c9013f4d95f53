(** The order but for rounding of a table with rounded coefficients: what its conditions miss, in numbers of fixed point
    that carry a bound of their error. *)

From Coq Require Import QArith Qreals Reals Lra Lia List Bool.
From Bignums Require Import BigZ.
From driftproof Require Import Methods Trees.
Import ListNotations.
Open Scope R_scope.

(** Of a method in rationals: r bounds what the conditions of up to p vertices are missed by,
    and s does not for p + 1. *)
Definition has_rounded_order (m : method) (p : nat) (r s : Q) : Prop :=
  match m with
  | RungeKutta A b => order_within (map (map Q2R) A) (map Q2R b) p (Q2R r) (Q2R s)
  | Splitting _ => False
  end.

Lemma Rabs_bounds x r : Rabs x <= r -> - r <= x <= r.
Proof. unfold Rabs. destruct Rcase_abs; lra. Qed.

(** A center c and a radius r, in units of 2^-120: some x with |c - x| <= r. *)
Definition ball : Type := bigZ * bigZ.
Definition digits : Z := 120.
Definition units : Z := 2 ^ digits.
Section Balls.
  Variables one places : bigZ.  (* 2^120 and 120, which are computed once *)
  Definition ball_plus (x y : ball) : ball := (BigZ.add (fst x) (fst y), BigZ.add (snd x) (snd y)).
  Definition ball_mult (x y : ball) : ball :=
    let spread := BigZ.add (BigZ.mul (BigZ.abs (fst x)) (snd y)) (BigZ.mul (BigZ.add (BigZ.abs (fst y)) (snd y)) (snd
      x)) in
    (BigZ.shiftr (BigZ.mul (fst x) (fst y)) places, BigZ.add (BigZ.shiftr spread places) BigZ.two).
  Definition balls : numbers :=
    {| element := ball; plus := ball_plus; mult := ball_mult; of_Z z := (BigZ.mul (BigZ.of_Z z) one, BigZ.zero) |}.
  Definition ball_of (x : Q) : ball :=
    (BigZ.div (BigZ.mul (BigZ.of_Z (Qnum x)) one) (BigZ.of_Z (Zpos (Qden x))), BigZ.one).

  Hypotheses (one_is : [one]%bigZ = units) (places_are : [places]%bigZ = digits).
  Let u := IZR units.
  Let u_pos : 0 < u.
  Proof. apply IZR_lt. reflexivity. Qed.
  Definition encloses (b : ball) (x : R) : Prop := Rabs (IZR [fst b]%bigZ - x * u) <= IZR [snd b]%bigZ.

  Lemma encloses_plus x y a b : encloses x a -> encloses y b -> encloses (ball_plus x y) (a + b).
  Proof.
    unfold encloses; cbn [ball_plus fst snd]. rewrite !BigZ.spec_add, !plus_IZR. intros X Y.
    apply Rabs_bounds in X, Y. apply Rabs_le. lra.
  Qed.
  Lemma encloses_of_Z z : encloses (of_Z balls z) (IZR z).
  Proof.
    unfold encloses; cbn [balls of_Z fst snd]. rewrite BigZ.spec_mul, BigZ.spec_of_Z, one_is, mult_IZR, BigZ.spec_0.
    fold u. rewrite Rminus_eq_0, Rabs_R0. lra.
  Qed.
  Lemma encloses_ball_of x : encloses (ball_of x) (Q2R x).
  Proof.
    unfold encloses; cbn [ball_of fst snd]. rewrite BigZ.spec_div, BigZ.spec_mul, !BigZ.spec_of_Z, one_is, BigZ.spec_1.
    assert (B := floor_within (Qnum x * units) (Zpos (Qden x)) eq_refl). rewrite mult_IZR in B. fold u in B.
    assert (0 < IZR (Zpos (Qden x))) by now apply IZR_lt.
    replace (Q2R x * u) with (IZR (Qnum x) * u / IZR (Zpos (Qden x))) by (unfold Q2R; field; lra). apply Rabs_le. lra.
  Qed.
  Lemma encloses_mult x y a b : encloses x a -> encloses y b -> encloses (ball_mult x y) (a * b).
  Proof.
    unfold encloses; cbn [ball_mult fst snd].
    rewrite BigZ.spec_add, !BigZ.spec_shiftr, BigZ.spec_add, !BigZ.spec_mul, BigZ.spec_add, !BigZ.spec_abs, BigZ.spec_2.
    rewrite places_are, !Z.shiftr_div_pow2 by easy. fold units. rewrite plus_IZR. set (c := [fst x]%bigZ).
    set (r := [snd x]%bigZ). set (d := [fst y]%bigZ).
    set (s := [snd y]%bigZ). intros X Y.
    assert (P := floor_within (c * d) units eq_refl).
    assert (S := floor_within (Z.abs c * s + (Z.abs d + s) * r) units eq_refl). fold u in P, S.
    rewrite plus_IZR, !mult_IZR, plus_IZR, !abs_IZR in S. rewrite mult_IZR in P.
    assert (E : Rabs (IZR c * IZR d / u - a * b * u)
                <= (Rabs (IZR c) * IZR s + (Rabs (IZR d) + IZR s) * IZR r) / u).
    { replace (IZR c * IZR d / u - a * b * u) with ((IZR c * (IZR d - b * u) + b * u * (IZR c - a * u)) / u)
        by (field; lra).
      unfold Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ u)) by (apply Rlt_le, Rinv_0_lt_compat, u_pos).
      apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat, u_pos|].
      eapply Rle_trans; [apply Rabs_triang|]. rewrite !(Rabs_mult _ (_ - _)).
      assert (Rabs (b * u) <= Rabs (IZR d) + IZR s).
      { replace (b * u) with (IZR d + - (IZR d - b * u)) by ring. eapply Rle_trans; [apply Rabs_triang|].
        rewrite Rabs_Ropp. lra. }
      apply Rplus_le_compat; [apply Rmult_le_compat_l; [apply Rabs_pos | exact Y]|].
      apply Rmult_le_compat; trivial; apply Rabs_pos. }
    apply Rabs_bounds in E. apply Rabs_le. lra.
  Qed.

  Lemma encloses_dot x a y b : Forall2 encloses x a -> Forall2 encloses y b -> encloses (dot_K balls x y) (dot a b).
  Proof.
    intros X. revert y b. induction X; intros y' b' Y; [apply (encloses_of_Z 0)|].
    destruct Y; [apply (encloses_of_Z 0)|]. cbn. apply encloses_plus; [now apply encloses_mult | auto].
  Qed.
  Lemma encloses_times x a y b : Forall2 encloses x a -> Forall2 encloses y b ->
    Forall2 encloses (times_K balls x y) (times a b).
  Proof.
    intros X. revert y b. induction X; intros y' b' Y; [constructor|]. destruct Y; cbn; constructor; auto.
    now apply encloses_mult.
  Qed.

  (** The table, its stages, and what is left of a condition. *)
  Variables (A : list (list Q)) (b : list Q).
  Let A_K := map (map ball_of) A.
  Let b_K := map ball_of b.
  Lemma encloses_row row : Forall2 encloses (map ball_of row) (map Q2R row).
  Proof. induction row; cbn; constructor; [apply encloses_ball_of | assumption]. Qed.
  Lemma encloses_sums rows x a : Forall2 encloses x a ->
    Forall2 encloses (map (fun row => dot_K balls row x) (map (map ball_of) rows))
      (map (fun row => dot row a) (map (map Q2R) rows)).
  Proof.
    intros X. rewrite !map_map. induction rows; constructor; [|assumption].
    apply encloses_dot; [apply encloses_row | exact X].
  Qed.
  Lemma encloses_stages t :
    Forall2 encloses (stages_of balls (entry_of balls A_K b_K t)) (stages (map (map Q2R) A) (map Q2R b) t).
  Proof.
    induction t as [|t IH w IH']; cbn [entry_of single grafted kept snd stages_of stages].
    - unfold b_K. rewrite !map_map. induction b; cbn; constructor; [apply (encloses_of_Z 1) | assumption].
    - apply encloses_times; [exact IH | now apply encloses_sums].
  Qed.

  (** |c/2^120 - 1/g| and the radius, times g 2^120, of the condition of an entry with density g. *)
  Definition center_and_radius (n : Z) (e : entry balls) : bigZ * bigZ :=
    let w := dot_K balls b_K (stages_of balls e) in let g := BigZ.of_Z (n * branches_of balls e) in
    (BigZ.abs (BigZ.sub (BigZ.mul (fst w) g) one), BigZ.mul (snd w) g).
  Definition scaled_bound (q : Q) (n : Z) (e : entry balls) : bigZ :=
    BigZ.mul (BigZ.of_Z (Qnum q * (n * branches_of balls e))) one.
  Definition at_most (r : Q) (n : Z) (e : entry balls) : bool :=
    let (c, w) := center_and_radius n e in
    BigZ.leb (BigZ.mul (BigZ.of_Z (Zpos (Qden r))) (BigZ.add c w)) (scaled_bound r n e).
  Definition more_than (s : Q) (n : Z) (e : entry balls) : bool :=
    let (c, w) := center_and_radius n e in
    BigZ.ltb (scaled_bound s n e) (BigZ.mul (BigZ.of_Z (Zpos (Qden s))) (BigZ.sub c w)).

  Lemma missed_within t : let (c, w) := center_and_radius (Z.of_nat (vertices t)) (entry_of balls A_K b_K t) in
    let miss := missed (map (map Q2R) A) (map Q2R b) t * (u * INR (density t)) in
    IZR [c]%bigZ - IZR [w]%bigZ <= miss <= IZR [c]%bigZ + IZR [w]%bigZ.
  Proof.
    cbv beta zeta delta [center_and_radius]. assert (E := encloses_dot _ _ _ _ (encloses_row b) (encloses_stages t)).
    fold b_K in E. unfold missed. fold (weight (map (map Q2R) A) (map Q2R b) t) in E. unfold encloses in E.
    set (w := dot_K _ _ _) in *. set (x := weight _ _ _) in *.
    rewrite BigZ.spec_abs, BigZ.spec_sub, !BigZ.spec_mul, BigZ.spec_of_Z, abs_IZR, minus_IZR, !mult_IZR, one_is.
    rewrite branches_of_entry, <- INR_IZR_INZ, <- mult_INR. fold (density t) u.
    assert (g_pos : 0 < INR (density t)) by (apply lt_0_INR; generalize (density_pos t); lia).
    set (g := INR (density t)) in *. rewrite <- (Rabs_pos_eq (u * g)) by nra. rewrite <- Rabs_mult.
    replace ((x - / g) * (u * g)) with ((x * u) * g - u) by (field; lra).
    assert (F : Rabs (IZR [fst w]%bigZ * g - u - (x * u * g - u)) <= IZR [snd w]%bigZ * g).
    { replace (_ - _) with ((IZR [fst w]%bigZ - x * u) * g) by ring. rewrite Rabs_mult, (Rabs_pos_eq g) by lra.
      apply Rmult_le_compat_r; lra. }
    unfold Rabs in *. repeat destruct Rcase_abs; lra.
  Qed.

  Lemma bound_is q t : IZR [scaled_bound q (Z.of_nat (vertices t)) (entry_of balls A_K b_K t)]%bigZ
    = Q2R q * (u * INR (density t)) * IZR (Zpos (Qden q)).
  Proof.
    unfold scaled_bound, density. rewrite BigZ.spec_mul, BigZ.spec_of_Z, one_is, !mult_IZR, branches_of_entry.
    rewrite <- INR_IZR_INZ, mult_INR. fold u. unfold Q2R. field. now apply not_0_IZR.
  Qed.

  Lemma at_most_missed r t : at_most r (Z.of_nat (vertices t)) (entry_of balls A_K b_K t) = true ->
    missed (map (map Q2R) A) (map Q2R b) t <= Q2R r.
  Proof.
    unfold at_most. assert (B := missed_within t). destruct (center_and_radius _ _) as [c w].
    intros E. apply BigZ.leb_le in E. unfold BigZ.le in E. apply IZR_le in E. revert E.
    rewrite bound_is, BigZ.spec_mul, BigZ.spec_add, BigZ.spec_of_Z, mult_IZR, plus_IZR.
    assert (0 < IZR (Zpos (Qden r))) by now apply IZR_lt.
    assert (g_pos : 0 < INR (density t)) by (apply lt_0_INR; generalize (density_pos t); lia). intros E.
    apply Rmult_le_reg_r with (u * INR (density t)); [nra|].
    apply Rmult_le_reg_l with (IZR (Zpos (Qden r))); [assumption|]. nra.
  Qed.
  Lemma more_than_missed s t : more_than s (Z.of_nat (vertices t)) (entry_of balls A_K b_K t) = true ->
    Q2R s < missed (map (map Q2R) A) (map Q2R b) t.
  Proof.
    unfold more_than. assert (B := missed_within t). destruct (center_and_radius _ _) as [c w].
    intros E. apply BigZ.ltb_lt in E. unfold BigZ.lt in E. apply IZR_lt in E. revert E.
    rewrite bound_is, BigZ.spec_mul, BigZ.spec_sub, BigZ.spec_of_Z, mult_IZR, minus_IZR.
    assert (0 < IZR (Zpos (Qden s))) by now apply IZR_lt.
    assert (g_pos : 0 < INR (density t)) by (apply lt_0_INR; generalize (density_pos t); lia). intros E.
    apply Rmult_lt_reg_r with (u * INR (density t)); [nra|].
    apply Rmult_lt_reg_l with (IZR (Zpos (Qden s))); [assumption|]. nra.
  Qed.
End Balls.

(** What is computed of a table: the trees with up to p vertices are within the bound, and this one with p + 1 is not.
    *)
Definition rounded_order_is_checked (A : list (list Q)) (b : list Q) (p : nat) (r s : Q) (failing : tree) : bool :=
  let one := BigZ.of_Z units in let K := balls one (BigZ.of_Z digits) in
  let A_K := map (map (ball_of one)) A in let b_K := map (ball_of one) b in
  passes K A_K b_K (at_most one _ b r) p && (vertices failing =? S p)%nat
  && more_than one _ b s (Z.of_nat (vertices failing)) (entry_of K A_K b_K failing).

Theorem rounded_order_of_check A b p r s failing : rounded_order_is_checked A b p r s failing = true ->
  has_rounded_order (RungeKutta A b) p r s.
Proof.
  intros E. apply andb_prop in E as [E fails]. apply andb_prop in E as [all size]. apply Nat.eqb_eq in size.
  assert (one_is := BigZ.spec_of_Z units). assert (places_are := BigZ.spec_of_Z digits). split.
  - intros t small. apply (at_most_missed _ _ one_is places_are). exact (tree_passes _ _ _ _ _ _ all small).
  - exists failing. split; [exact size | exact (more_than_missed _ _ one_is places_are _ _ _ _ fails)].
Qed.

Ltac by_rounded_order failing := apply (rounded_order_of_check _ _ _ _ _ failing); vm_cast_no_check (eq_refl true).
