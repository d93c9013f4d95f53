(** How A-stability is checked, and that there is none: of Q y1 = P y0, with polynomials P and Q in z = x + iy over a
    number field, the signs of |Q|^2 - |P|^2, a polynomial in -x and y. *)

From Coq Require Import QArith Qreals Reals Lra Lia List Bool.
From Bignums Require Import BigZ.
From Coquelicot Require Import Complex.
From driftproof Require Import Trees Orders LeftHalfPlane.
Import ListNotations.
Open Scope R_scope.

Section Check.
  Context {K : ring}.
  Variables (nonneg : K -> bool) (divided : K -> Z -> K).
  Hypothesis value_nonneg : forall x, nonneg x = true -> 0 <= value K x.

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

  (** The table times its denominator D. *)
  Variables (A : list (list K)) (b : list K) (e : list Z) (D : Z).
  Hypothesis D_pos : (0 < D)%Z.
  Definition contraction_is_checked (Q : list K) (V u : list (list K)) (m : K) (w : list (list K)) : bool :=
    are_stages A e Q V && are_multipliers A b Q u && signs (numerator e Q u) Q m w.

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
    - apply (step_exists A b e D D_pos Q V z E). fold x. intros Z. rewrite Z, Cmod_0 in one. lra.
    - intros Y y1 steps. apply (numerator_of_step A b e D D_pos Q u z H0) in steps; [|exact L]. fold x in steps.
      apply Rmult_le_reg_l with (Cmod (at_complex Q x)); [lra|]. rewrite <- Cmod_mult, steps, Cmod_mult.
      apply Rmult_le_compat_r; [apply Cmod_ge_0 | exact smaller].
  Qed.

  (** At z/D = i both |Q|^2 and |P|^2 - |Q|^2 are at least 1. *)
  Definition at_i : list (list K) -> K := fold_right (fun c => plus K (hd (of_Z K 0) c)) (of_Z K 0).
  Definition at_least_1 (p : list (list K)) : bool := nonneg (plus K (at_i p) (of_Z K (-1))).
  Definition expansion_is_checked (Q : list K) (V u : list (list K)) : bool :=
    are_stages A e Q V && are_multipliers A b Q u && at_least_1 (squared Q)
    && at_least_1 (minus (squared (numerator e Q u)) (squared Q)).

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
    destruct (step_exists A b e D D_pos Q V z E (at_complex Q i)) as (Y & y1 & steps).
    { rewrite W. intros Z. rewrite Z, Cmod_0 in H0. lra. }
    exists z, (at_complex Q i), Y, y1. split; [cbn; lra | split; [exact steps|]].
    apply (numerator_of_step A b e D D_pos Q u z H1) in steps; [|exact L]. rewrite W in steps.
    apply (f_equal Cmod) in steps.
    rewrite !Cmod_mult in steps.
    generalize (Cmod_ge_0 y1), (Cmod_ge_0 (at_complex Q i)), (Cmod_ge_0 (at_complex (numerator e Q u) i)). intros.
    assert (Cmod y1 = Cmod (at_complex (numerator e Q u) i)) as ->
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
     transposed (map (fun B => map (hd (of_Z K 0)) (plain (fst B) (map (fun x => [of_Z K x]) e))) (tl known)),
     transposed (map (fun B => hd [] (plain [b] (fst B))) (tl known))).
  Definition expansion_check : bool := let '(Q, V, u) := certificate in expansion_is_checked Q V u.
  Definition contraction_check : bool :=
    let '(Q, V, u) := certificate in
    let difference := minus (squared Q) (squared (numerator e Q u)) in
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

Theorem contractive_of_table e t : is_checked (@contraction_check) e t -> of_table contractive e t.
Proof.
  intros [easy hard]. apply andb_prop in easy as [easy D_pos]. apply Z.ltb_lt in D_pos.
  split; [now apply root_exists|]. intros a inside. specialize (hard a (proj2 inside)).
  unfold contraction_check in hard.
  destruct (certificate _ _ _ _) as [[Q V] u] in hard. destruct (square_of _ _ _) as [m w] in hard.
  exact (@contractive_of_check (field_integers (relation t) a (proj2 inside)) _ (field_value_nonneg t a easy inside)
           _ _ e _ D_pos _ _ _ m w hard).
Qed.

Theorem expansive_of_table e t : is_checked (@expansion_check) e t -> of_table expansive e t.
Proof.
  intros [easy hard]. apply andb_prop in easy as [easy D_pos]. apply Z.ltb_lt in D_pos.
  split; [now apply root_exists|]. intros a inside. specialize (hard a (proj2 inside)).
  unfold expansion_check in hard.
  destruct (certificate _ _ _ _) as [[Q V] u] in hard.
  exact (@expansive_of_check (field_integers (relation t) a (proj2 inside)) _ (field_value_nonneg t a easy inside)
           _ _ e _ D_pos _ _ _ hard).
Qed.

Ltac by_sign := apply contractive_of_table; split; [|intros a root]; by_check.
Ltac by_growth := apply expansive_of_table; split; [|intros a root]; by_check.
