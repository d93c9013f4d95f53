(** How A-stability is checked, and that there is none: Q y1 = P y0 with polynomials P and Q in z = x + iy over a number
    field, and the signs of |Q|^2 - |P|^2, a polynomial in -x and y. *)

From Coq Require Import QArith Qreals Reals Lra Lia List Bool.
From Bignums Require Import BigZ.
From Coquelicot Require Import Complex.
From driftproof Require Import Trees Orders LeftHalfPlane.
Import ListNotations.
Open Scope R_scope.

Section Check.
  Variable K : ring.
  Variables (nonneg : K -> bool) (divided : K -> Z -> K).
  Hypothesis value_nonneg : forall x, nonneg x = true -> 0 <= value K x.

  (** Polynomials with coefficients in K, at a complex number, and lists of them. *)
  Fixpoint at_complex (p : list K) (z : C) : C :=
    match p with [] => RtoC 0 | c :: p => (RtoC (value K c) + z * at_complex p z)%C end.
  Fixpoint add1 (p q : list K) : list K :=
    match p, q with c :: p, d :: q => plus K c d :: add1 p q | [], q => q | p, [] => p end.
  Definition scaled1 (c : K) : list K -> list K := map (mult K c).
  Definition shifted1 (p : list K) : list K := of_Z K 0 :: p.
  Definition same1 (p q : list K) : bool := forallb (same K (of_Z K 0)) (add1 p (scaled1 (of_Z K (-1)) q)).
  (** sum of row_j p_j; sum of p_i row_i, entry by entry. *)
  Fixpoint weighted_K (row : list K) (ps : list (list K)) : list K :=
    match row, ps with a :: row, p :: ps => add1 (scaled1 a p) (weighted_K row ps) | _, _ => [] end.
  Fixpoint add_rows (x y : list (list K)) : list (list K) :=
    match x, y with p :: x, q :: y => add1 p q :: add_rows x y | [], y => y | x, [] => x end.
  Fixpoint through_K (ps : list (list K)) (A : list (list K)) : list (list K) :=
    match ps, A with p :: ps, row :: A => add_rows (map (fun a => scaled1 a p) row) (through_K ps A) | _, _ => [] end.

  Lemma at_add p : forall q z, at_complex (add1 p q) z = (at_complex p z + at_complex q z)%C.
  Proof. induction p as [|c p IH]; intros [|d q] z; cbn; rewrite ?value_plus, ?RtoC_plus, ?IH; ring. Qed.
  Lemma at_scaled c p z : at_complex (scaled1 c p) z = (RtoC (value K c) * at_complex p z)%C.
  Proof.
    induction p as [|d p IH]; cbn [scaled1 map at_complex]; [ring|].
    rewrite value_mult, RtoC_mult. fold (scaled1 c p). rewrite IH. ring.
  Qed.
  Lemma at_shifted p z : at_complex (shifted1 p) z = (z * at_complex p z)%C.
  Proof. cbn. rewrite value_of_Z. ring. Qed.
  Lemma at_same p q z : same1 p q = true -> at_complex p z = at_complex q z.
  Proof.
    unfold same1. intros E. assert (at_complex (add1 p (scaled1 (of_Z K (-1)) q)) z = RtoC 0) as Z.
    { induction (add1 p _) as [|c r IH]; [reflexivity|]. cbn [forallb at_complex] in *. apply andb_prop in E as [E E'].
      apply value_same in E. rewrite <- E, value_of_Z, IH by exact E'. ring. }
    rewrite at_add, at_scaled, value_of_Z in Z. replace (RtoC (-1)) with (- RtoC 1)%C in Z
      by (rewrite <- RtoC_opp; f_equal; lra).
    replace (at_complex q z) with (at_complex q z + RtoC 0)%C by ring. rewrite <- Z. ring.
  Qed.
  Lemma at_weighted row : forall ps z,
    at_complex (weighted_K row ps) z = weighted (map (value K) row) (map (fun p => at_complex p z) ps).
  Proof. induction row as [|a row IH]; intros [|p ps] z; cbn; trivial. now rewrite at_add, at_scaled, IH. Qed.

  Fixpoint dot_C (x y : list C) : C :=
    match x, y with a :: x, c :: y => (a * c + dot_C x y)%C | _, _ => RtoC 0 end.
  Lemma dot_add_rows x : forall y Y z,
    dot_C (map (fun p => at_complex p z) (add_rows x y)) Y
    = (dot_C (map (fun p => at_complex p z) x) Y + dot_C (map (fun p => at_complex p z) y) Y)%C.
  Proof. induction x as [|p x IH]; intros [|q y] [|c Y] z; cbn; rewrite ?at_add, ?IH; ring. Qed.
  Lemma dot_scaled_row p row : forall Y z,
    dot_C (map (fun p => at_complex p z) (map (fun a => scaled1 a p) row)) Y
    = (at_complex p z * weighted (map (value K) row) Y)%C.
  Proof. induction row as [|a row IH]; intros [|c Y] z; cbn; rewrite ?at_scaled, ?IH; ring. Qed.
  Lemma dot_through ps : forall A Y z,
    dot_C (map (fun p => at_complex p z) (through_K ps A)) Y
    = dot_C (map (fun p => at_complex p z) ps) (map (fun row => weighted (map (value K) row) Y) A).
  Proof.
    induction ps as [|p ps IH]; intros [|row A] Y z; cbn [through_K map dot_C]; trivial.
    now rewrite dot_add_rows, dot_scaled_row, IH.
  Qed.

  (** The table times its denominator D, and z/D. *)
  Variables (A : list (list K)) (b : list K) (e : list Z) (D : Z).
  Hypothesis D_pos : (0 < D)%Z.
  Let e_K := map (of_Z K) e.

  Lemma weighted_over row : forall Y,
    (RtoC (IZR D) * weighted (map (over K D) row) Y = weighted (map (value K) row) Y)%C.
  Proof.
    assert (IZR D <> 0) by (apply not_0_IZR; lia).
    induction row as [|a row IH]; intros [|y Y]; cbn; try ring. rewrite <- IH. unfold over, Rdiv.
    rewrite RtoC_mult, RtoC_inv by assumption. field. injection. exact H.
  Qed.

  (** Q V = what the stages are of y0 = Q; and u, with u (I - zA) = Q b. *)
  Definition are_stages (Q : list K) (V : list (list K)) : bool :=
    (length V =? length A)%nat && (length e =? length A)%nat
    && forallb (fun p => same1 (fst p) (add1 (scaled1 (fst (snd p)) Q) (shifted1 (weighted_K (snd (snd p)) V))))
         (combine V (combine e_K A)).
  Definition are_multipliers (Q : list K) (u : list (list K)) : bool :=
    let image := add_rows (map (fun b => scaled1 b Q) b) (map shifted1 (through_K u A)) in
    (length u =? length image)%nat && forallb (fun p => same1 (fst p) (snd p)) (combine u image).
  Definition numerator (Q : list K) (u : list (list K)) : list K := add1 Q (shifted1 (weighted_K e_K u)).

  Section Step.
    Variables (Q : list K) (V u : list (list K)) (z : C).
    Hypotheses (V_ok : are_stages Q V = true) (u_ok : are_multipliers Q u = true).
    Let w : C := (z / RtoC (IZR D))%C.
    Let at_w p := at_complex p w.

    Lemma z_of_w row Y : (z * weighted (map (over K D) row) Y = w * weighted (map (value K) row) Y)%C.
    Proof.
      rewrite <- weighted_over. unfold w. field. injection. apply not_0_IZR. lia.
    Qed.

    Lemma step_exists y0 : at_w Q <> RtoC 0 -> exists Y y1,
      steps_to (map (map (over K D)) A) (map (over K D) b) (map IZR e) z y0 Y y1.
    Proof.
      intros Q0. exists (map (fun p => at_w p / at_w Q * y0)%C V). eexists. split; [|reflexivity].
      unfold are_stages in V_ok. apply andb_prop in V_ok as [L F]. apply andb_prop in L as [L L'].
      apply Nat.eqb_eq in L, L'.
      assert (W : forall row, weighted (map (value K) row) (map (fun p => at_w p / at_w Q * y0)%C V)
                         = (at_w (weighted_K row V) / at_w Q * y0)%C).
      { intros row. unfold at_w. rewrite at_weighted. generalize V. induction row as [|a row IH]; intros [|p V']; cbn.
        1-3: field; exact Q0. rewrite IH. field. exact Q0. }
      revert F. generalize L, L'. unfold e_K.
      enough (forall A' V' e', length V' = length A' -> length e' = length A' ->
        forallb (fun p => same1 (fst p) (add1 (scaled1 (fst (snd p)) Q) (shifted1 (weighted_K (snd (snd p)) V))))
          (combine V' (combine (map (of_Z K) e') A')) = true ->
        map (fun p => at_w p / at_w Q * y0)%C V' = map (fun p => RtoC (fst p) * y0 + z * weighted (snd p)
          (map (fun p => at_w p / at_w Q * y0)%C V))%C (combine (map IZR e') (map (map (over K D)) A'))) by auto.
      induction A' as [|row A' IH]; intros [|p V'] [|e0 e'] M M' F; try discriminate; [reflexivity|].
      cbn [map combine forallb fst snd] in *. apply andb_prop in F as [F F']. injection M; injection M'; intros.
      f_equal; [|apply IH; assumption]. rewrite z_of_w, W. apply at_same with (z := w) in F. unfold at_w at 1.
      rewrite F, at_add, at_scaled, at_shifted, value_of_Z. unfold at_w. field. exact Q0.
    Qed.

    Lemma dot_of_entries : forall x y Y, length x = length y ->
      forallb (fun p => same1 (fst p) (snd p)) (combine x y) = true -> dot_C (map at_w x) Y = dot_C (map at_w y) Y.
    Proof.
      induction x as [|p x IH]; intros [|q y] [|c Y] L F; try discriminate; trivial. cbn in *.
      apply andb_prop in F as [F F']. apply at_same with (z := w) in F. fold (at_w p) (at_w q) in F.
      rewrite F, (IH y Y); trivial. now injection L.
    Qed.

    Lemma numerator_of_step y0 Y y1 : length e = length A ->
      steps_to (map (map (over K D)) A) (map (over K D) b) (map IZR e) z y0 Y y1 ->
      (at_w Q * y1 = at_w (numerator Q u) * y0)%C.
    Proof.
      intros L [EY E1]. subst y1. rewrite z_of_w. unfold are_multipliers in u_ok. apply andb_prop in u_ok as [Lu F].
      apply Nat.eqb_eq in Lu. generalize (dot_of_entries _ _ Y Lu F). unfold at_w at 2. rewrite dot_add_rows.
      rewrite dot_scaled_row.
      assert (S : forall x Y, dot_C (map (fun p => at_complex p w) (map shifted1 x)) Y
                         = (w * dot_C (map (fun p => at_complex p w) x) Y)%C).
      { clear. induction x as [|p x IH]; intros [|c Y]; cbn [map dot_C]; try ring. rewrite at_shifted, IH. ring. }
      rewrite S, dot_through.
      assert (T : dot_C (map at_w u) Y = (at_w (weighted_K e_K u) * y0
        + w * dot_C (map at_w u) (map (fun row => weighted (map (value K) row) Y) A))%C).
      { rewrite EY at 1. unfold at_w at 2. rewrite at_weighted. unfold e_K. rewrite map_map.
        fold at_w. clear - L D_pos. revert L. generalize u, e.
        induction A as [|row A' IH]; intros u' [|e0 e'] L; try discriminate.
        - destruct u'; cbn; ring.
        - destruct u' as [|p u']; [cbn; ring|]. injection L; intros L'. cbn [map combine dot_C weighted fst snd].
          rewrite z_of_w, (IH u' e' L'), value_of_Z. unfold at_w. ring. }
      rewrite T. unfold numerator. intros M.
      assert (M' : (at_w Q * weighted (map (value K) b) Y = at_w (weighted_K e_K u) * y0)%C).
      { fold at_w in M. unfold at_w in *. set (X := dot_C _ _) in M.
        replace (at_complex (weighted_K e_K u) w * y0)%C
          with (at_complex (weighted_K e_K u) w * y0 + w * X - w * X)%C by ring.
        rewrite M. fold X. ring. }
      unfold at_w in *. rewrite at_add, at_shifted.
      transitivity (at_complex Q w * y0 + w * (at_complex Q w * weighted (map (value K) b) Y))%C; [ring|].
      rewrite M'. ring.
    Qed.
  End Step.

  (** Polynomials in s = -x, and polynomials in y whose coefficients they are. *)
  Fixpoint mul1 (p q : list K) : list K :=
    match p with [] => [] | c :: p => add1 (scaled1 c q) (shifted1 (mul1 p q)) end.
  Fixpoint at1 (p : list K) (s : R) : R := match p with [] => 0 | c :: p => value K c + s * at1 p s end.
  Fixpoint mul2 (p q : list (list K)) : list (list K) :=
    match p with [] => [] | c :: p => add_rows (map (mul1 c) q) ([] :: mul2 p q) end.
  Fixpoint at2 (p : list (list K)) (s y : R) : R := match p with [] => 0 | c :: p => at1 c s + y * at2 p s y end.
  Definition scaled2 (c : K) : list (list K) -> list (list K) := map (scaled1 c).

  Lemma at1_add p : forall q s, at1 (add1 p q) s = at1 p s + at1 q s.
  Proof. induction p as [|c p IH]; intros [|d q] s; cbn; try ring. rewrite value_plus, IH. ring. Qed.
  Lemma at1_scaled c p s : at1 (scaled1 c p) s = value K c * at1 p s.
  Proof.
    induction p as [|d p IH]; cbn [scaled1 map at1]; [ring|]. rewrite value_mult. fold (scaled1 c p).
    rewrite IH. ring.
  Qed.
  Lemma at1_mul p q s : at1 (mul1 p q) s = at1 p s * at1 q s.
  Proof.
    induction p as [|c p IH]; cbn [mul1 at1]; [ring|]. rewrite at1_add, at1_scaled. cbn [shifted1 at1].
    rewrite IH, value_of_Z. ring.
  Qed.
  Lemma at2_add p : forall q s y, at2 (add_rows p q) s y = at2 p s y + at2 q s y.
  Proof. induction p as [|c p IH]; intros [|d q] s y; cbn; try ring. rewrite at1_add, IH. ring. Qed.
  Lemma at2_mul1 c p s y : at2 (map (mul1 c) p) s y = at1 c s * at2 p s y.
  Proof. induction p as [|d p IH]; cbn [map at2]; [ring|]. rewrite at1_mul, IH. ring. Qed.
  Lemma at2_mul p q s y : at2 (mul2 p q) s y = at2 p s y * at2 q s y.
  Proof.
    induction p as [|c p IH]; cbn [mul2 at2]; [ring|]. rewrite at2_add, at2_mul1. cbn [at2 at1]. rewrite IH. ring.
  Qed.
  Lemma at2_scaled c p s y : at2 (scaled2 c p) s y = value K c * at2 p s y.
  Proof.
    induction p as [|d p IH]; cbn [scaled2 map at2]; [ring|]. rewrite at1_scaled. fold (scaled2 c p).
    rewrite IH. ring.
  Qed.

  (** Real and imaginary part as such polynomials. *)
  Fixpoint parts_of (p : list K) : list (list K) * list (list K) :=
    match p with
    | [] => ([], [])
    | c :: p => let (re, im) := parts_of p in let minus_s := scaled2 (of_Z K (-1)) in
                (add_rows [[c]] (add_rows (map shifted1 (minus_s re)) ([] :: minus_s im)),
                 add_rows (map shifted1 (minus_s im)) ([] :: re))
    end.
  Definition squared (p : list K) : list (list K) :=
    let (re, im) := parts_of p in add_rows (mul2 re re) (mul2 im im).

  Lemma at2_shifted p s y : at2 (map shifted1 p) s y = s * at2 p s y.
  Proof. induction p as [|c p IH]; cbn [map at2 shifted1 at1]; [ring|]. rewrite value_of_Z, IH. ring. Qed.
  Lemma at_parts p s y : at_complex p (- s, y) = (at2 (fst (parts_of p)) s y, at2 (snd (parts_of p)) s y).
  Proof.
    induction p as [|c p IH]; cbn [at_complex parts_of]; [reflexivity|]. rewrite IH.
    destruct (parts_of p) as [re im]. cbn [fst snd]. rewrite !at2_add, !at2_shifted. cbn [at2 at1].
    rewrite !at2_scaled, !value_of_Z. unfold Cplus, Cmult, RtoC; cbn [fst snd]. f_equal; ring.
  Qed.
  Lemma at_squared p s y : Cmod (at_complex p (- s, y)) ^ 2 = at2 (squared p) s y.
  Proof.
    rewrite at_parts. unfold squared. destruct (parts_of p) as [re im]; cbn [fst snd].
    rewrite at2_add, !at2_mul. unfold Cmod; cbn [fst snd]. rewrite pow2_sqrt; [ring|].
    apply Rplus_le_le_0_compat; apply pow2_ge_0.
  Qed.

  (** Odd powers of y do not occur, and even ones have no negative coefficient. *)
  Fixpoint visible (p : list (list K)) (even : bool) : bool :=
    match p with
    | [] => true
    | c :: p => forallb (if even then nonneg else same K (of_Z K 0)) c && visible p (negb even)
    end.

  Lemma at1_nonneg c s : 0 <= s -> forallb nonneg c = true -> 0 <= at1 c s.
  Proof.
    intros positive. induction c as [|z c IH]; cbn [forallb at1]; intros E; [lra|].
    apply andb_prop in E as [E E']. apply value_nonneg in E. specialize (IH E'). nra.
  Qed.
  Lemma at1_zero c s : forallb (same K (of_Z K 0)) c = true -> at1 c s = 0.
  Proof.
    induction c as [|z c IH]; cbn [forallb at1]; intros E; [reflexivity|].
    apply andb_prop in E as [E E']. apply value_same in E. rewrite <- E, value_of_Z, (IH E'). ring.
  Qed.
  Lemma visible_nonneg p : forall s y, 0 <= s ->
    (visible p true = true -> 0 <= at2 p s y) /\ (visible p false = true -> 0 <= y * at2 p s y).
  Proof.
    induction p as [|c p IH]; intros s y positive; cbn [visible at2 negb]; [lra|].
    destruct (IH s y positive) as [even odd]. split; intros E; apply andb_prop in E as [E E'].
    - generalize (at1_nonneg c s positive E), (odd E'). lra.
    - rewrite (at1_zero c s E). specialize (even E').
      replace (y * (0 + y * at2 p s y)) with (y ^ 2 * at2 p s y) by ring.
      apply Rmult_le_pos; [apply pow2_ge_0 | exact even].
  Qed.

  (** |Q|^2 - 1 shows its sign, and so does m (|Q|^2 - |P|^2) - w^2 with m >= 1. *)
  Definition minus (p q : list (list K)) : list (list K) := add_rows p (scaled2 (of_Z K (-1)) q).
  Definition signs (P Q : list K) (m : K) (w : list (list K)) : bool :=
    visible (minus (squared Q) [[of_Z K 1]]) true && nonneg (plus K m (of_Z K (-1)))
    && visible (minus (scaled2 m (minus (squared Q) (squared P))) (mul2 w w)) true.

  Lemma at_minus p q s y : at2 (minus p q) s y = at2 p s y - at2 q s y.
  Proof. unfold minus. rewrite at2_add, at2_scaled, value_of_Z. ring. Qed.
  Lemma smaller_of_signs P Q m w z : signs P Q m w = true -> Re z <= 0 ->
    1 <= Cmod (at_complex Q z) /\ Cmod (at_complex P z) <= Cmod (at_complex Q z).
  Proof.
    destruct z as [x y]. unfold Re, signs; cbn [fst]. intros E left. do 2 apply andb_prop in E as [E ?].
    apply (visible_nonneg _ (- x) y) in E; [|lra]. apply (visible_nonneg _ (- x) y) in H; [|lra].
    apply value_nonneg in H0.
    rewrite value_plus, value_of_Z in H0. rewrite at_minus, <- at_squared, Ropp_involutive in E. cbn [at2 at1] in E.
    rewrite value_of_Z in E. rewrite at_minus, at2_scaled, at_minus, <- !at_squared, !Ropp_involutive, at2_mul in H.
    generalize (Cmod_ge_0 (at_complex P (x, y))), (Cmod_ge_0 (at_complex Q (x, y))), (Rle_0_sqr (at2 w (- x) y)).
    unfold Rsqr. intros. split; [nra|]. apply Rnot_lt_le. intros big.
    assert (Cmod (at_complex Q (x, y)) ^ 2 < Cmod (at_complex P (x, y)) ^ 2) by nra. nra.
  Qed.

  Definition contraction_is_checked (Q : list K) (V u : list (list K)) (m : K) (w : list (list K)) : bool :=
    (are_stages Q V && are_multipliers Q u && signs (numerator Q u) Q m w)%bool.

  Theorem contractive_of_check Q V u m w : contraction_is_checked Q V u m w = true ->
    contractive (map (map (over K D)) A) (map (over K D) b) (map IZR e).
  Proof.
    intros E z y0 left. do 2 apply andb_prop in E as [E ?].
    assert (L : length e = length A).
    { unfold are_stages in E; do 2 apply andb_prop in E as [E ?]; now apply Nat.eqb_eq. }
    set (x := (z / RtoC (IZR D))%C).
    destruct (smaller_of_signs _ _ _ _ x H) as [one smaller].
    { unfold x. destruct z as [a c]. unfold Re, Cdiv, Cinv, Cmult, RtoC in *. cbn [fst snd] in *.
      assert (0 < IZR D) by (apply IZR_lt, D_pos).
      replace (_ - _) with (a / IZR D) by (field; lra). apply Rmult_le_reg_r with (IZR D); [lra|]. unfold Rdiv.
      rewrite Rmult_assoc, Rinv_l; lra. }
    split.
    - apply (step_exists Q V z E). fold x. intros Z. rewrite Z, Cmod_0 in one. lra.
    - intros Y y1 steps. apply (numerator_of_step Q u z H0) in steps; [|exact L]. fold x in steps.
      apply Rmult_le_reg_l with (Cmod (at_complex Q x)); [lra|]. rewrite <- Cmod_mult, steps, Cmod_mult.
      apply Rmult_le_compat_r; [apply Cmod_ge_0 | exact smaller].
  Qed.

  (** At z/D = i both |Q|^2 and |P|^2 - |Q|^2 are at least 1. *)
  Definition at_i : list (list K) -> K := fold_right (fun c => plus K (hd (of_Z K 0) c)) (of_Z K 0).
  Definition at_least_1 (p : list (list K)) : bool := nonneg (plus K (at_i p) (of_Z K (-1))).
  Definition expansion_is_checked (Q : list K) (V u : list (list K)) : bool :=
    are_stages Q V && are_multipliers Q u && at_least_1 (squared Q)
    && at_least_1 (minus (squared (numerator Q u)) (squared Q)).

  Lemma at_i_value p : value K (at_i p) = at2 p 0 1.
  Proof.
    induction p as [|[|x c] p IH]; cbn [at_i fold_right hd at2 at1]; rewrite ?value_plus, ?value_of_Z; [trivial| |];
      fold (at_i p); rewrite IH; ring.
  Qed.
  Lemma at_least_1_at_i p : at_least_1 p = true -> 1 <= at2 p 0 1.
  Proof. intros E. apply value_nonneg in E. rewrite value_plus, value_of_Z, at_i_value in E. lra. Qed.

  Theorem expansive_of_check Q V u : expansion_is_checked Q V u = true ->
    expansive (map (map (over K D)) A) (map (over K D) b) (map IZR e).
  Proof.
    intros E. do 3 apply andb_prop in E as [E ?]. apply at_least_1_at_i in H, H0.
    assert (L : length e = length A).
    { unfold are_stages in E; do 2 apply andb_prop in E as [E ?]; now apply Nat.eqb_eq. }
    assert (D_not : IZR D <> 0) by (apply not_0_IZR; lia).
    set (z := (0, IZR D) : C). set (i := (0, 1) : C).
    assert (W : (z / RtoC (IZR D))%C = i).
    { unfold z, i, Cdiv, Cinv, Cmult, RtoC. cbn [fst snd]. f_equal; field; exact D_not. }
    rewrite at_minus, <- !at_squared, Ropp_0 in H. rewrite <- at_squared, Ropp_0 in H0. fold i in H, H0.
    destruct (step_exists Q V z E (at_complex Q i)) as (Y & y1 & steps).
    { rewrite W. intros Z. rewrite Z, Cmod_0 in H0. lra. }
    exists z, (at_complex Q i), Y, y1. split; [cbn; lra | split; [exact steps|]].
    apply (numerator_of_step Q u z H1) in steps; [|exact L]. rewrite W in steps. apply (f_equal Cmod) in steps.
    rewrite !Cmod_mult in steps.
    generalize (Cmod_ge_0 y1), (Cmod_ge_0 (at_complex Q i)), (Cmod_ge_0 (at_complex (numerator Q u) i)). intros.
    assert (Cmod y1 = Cmod (at_complex (numerator Q u) i)) as ->
      by (apply Rmult_eq_reg_l with (Cmod (at_complex Q i)); nra).
    nra.
  Qed.

  (** Where the certificate comes from; nothing is proved of it. adj(I - zA) = sum B_k z^k and det(I - zA) = sum q_k z^k
      with B_0 = I, q_k = - tr(A B_(k-1))/k, B_k = A B_(k-1) + q_k I (Faddeev, Le Verrier). *)
  Definition plain (A : list (list K)) (B : list (list K)) : list (list K) :=
    map (fun row => fold_right add1 [] (map (fun p => scaled1 (fst p) (snd p)) (combine row B))) A.
  Definition diagonal (q : K) : list (list K) :=
    map (fun i => map (fun j => if (i =? j)%nat then q else of_Z K 0) (seq 0 (length A))) (seq 0 (length A)).
  Definition trace (M : list (list K)) : K :=
    fold_right (plus K) (of_Z K 0) (map (fun p => nth (fst p) (snd p) (of_Z K 0)) (combine (seq 0 (length A)) M)).
  Fixpoint le_verrier (k : nat) : list (list (list K) * K) :=  (* (B_k, q_k), ..., (B_0, q_0) *)
    match k with
    | O => [(diagonal (of_Z K 1), of_Z K 1)]
    | S k' => let known := le_verrier k' in
              let M := plain A (fst (hd ([], of_Z K 0) known)) in
              let q := divided (mult K (of_Z K (-1)) (trace M)) (Z.of_nat k) in
              (add_rows M (diagonal q), q) :: known
    end.
  (** Coefficient lists, highest first, as a list of polynomials. *)
  Definition transposed (rows : list (list K)) : list (list K) :=
    fold_left (fun ps row => map (fun p => fst p :: snd p) (combine row ps)) rows (map (fun _ => []) b).
  (** 4c (a - b y^2 + c y^4) = (2c y^2 - b)^2 + 4ac - b^2, where b is the first coefficient that is out of place. *)
  Fixpoint square_of (row : list K) (before : nat) : K * list (list K) :=
    match row with
    | q :: _ :: ((c :: _) as row') =>
        if nonneg q then square_of row' (S before)
        else (mult K (of_Z K 4) c, repeat [] (before - 1) ++ [[q]; []; [mult K (of_Z K 2) c]])
    | _ => (of_Z K 1, [])
    end.
  Definition certificate : list K * list (list K) * list (list K) :=
    let known := le_verrier (length A) in
    (rev (map snd known),
     transposed (map (fun B => map (hd (of_Z K 0)) (plain (fst B) (map (fun x => [x]) e_K))) (tl known)),
     transposed (map (fun B => hd [] (plain [b] (fst B))) (tl known))).
  Definition expansion_check : bool := let '(Q, V, u) := certificate in expansion_is_checked Q V u.
  Definition contraction_check : bool :=
    let '(Q, V, u) := certificate in
    let difference := minus (squared Q) (squared (numerator Q u)) in
    let (m, w) := square_of (map (hd (of_Z K 0)) difference) 0 in
    contraction_is_checked Q V u m w.
End Check.

Definition field_nonneg (l h : Q) (x : list bigZ) : bool := zero x || Qle_bool 0 (fst (bounds l h x)).
Definition field_divided (x : list bigZ) (k : Z) : list bigZ := map (fun c => BigZ.div c (BigZ.of_Z k)) x.

Lemma field_value_nonneg t a : crosses t = true -> is_root t a ->
  forall x, field_nonneg (low t) (high t) x = true -> 0 <= at_root a x.
Proof.
  intros easy [inside _] x E. apply orb_prop in E as [E|E]; [apply Req_le; symmetry; now apply at_zero|].
  apply Qle_bool_iff, Qle_Rle in E. unfold crosses in easy. do 2 apply andb_prop in easy as [easy ?].
  apply Qle_bool_iff, Qle_Rle in easy. replace (Q2R 0) with 0 in * by (unfold Q2R; cbn; lra).
  generalize (bounds_hold (low t) (high t) a (conj easy (proj1 inside)) (proj2 inside) x). lra.
Qed.

(** What is computed of a table, over its field. *)
Definition is_checked
  (check : forall K : ring, (K -> bool) -> (K -> Z -> K) -> list (list K) -> list K -> list Z -> bool)
  (e : list Z) (t : table) : Prop :=
  (crosses t && (0 <? denominator t)%Z = true)
  /\ forall a root, check (field_integers (relation t) a root) (field_nonneg (low t) (high t)) field_divided
                      (matrix t) (weights t) e = true.

Theorem contractive_of_table e t : is_checked contraction_check e t -> of_table contractive e t.
Proof.
  intros [easy hard]. apply andb_prop in easy as [easy D_pos]. apply Z.ltb_lt in D_pos.
  split; [now apply root_exists|]. intros a inside. specialize (hard a (proj2 inside)).
  unfold contraction_check in hard.
  destruct (certificate _ _ _ _ _) as [[Q V] u] in hard. destruct (square_of _ _ _ _) as [m w] in hard.
  exact (contractive_of_check (field_integers (relation t) a (proj2 inside)) _ (field_value_nonneg t a easy inside)
           _ _ e _ D_pos _ _ _ m w hard).
Qed.

Theorem expansive_of_table e t : is_checked (fun K nonneg => expansion_check K nonneg) e t -> of_table expansive e t.
Proof.
  intros [easy hard]. apply andb_prop in easy as [easy D_pos]. apply Z.ltb_lt in D_pos.
  split; [now apply root_exists|]. intros a inside. specialize (hard a (proj2 inside)).
  unfold expansion_check in hard.
  destruct (certificate _ _ _ _ _) as [[Q V] u] in hard.
  exact (expansive_of_check (field_integers (relation t) a (proj2 inside)) _ (field_value_nonneg t a easy inside)
           _ _ e _ D_pos _ _ _ hard).
Qed.

Ltac by_sign := apply contractive_of_table; split; [|intros a root]; by_check.
Ltac by_growth := apply expansive_of_table; split; [|intros a root]; by_check.
