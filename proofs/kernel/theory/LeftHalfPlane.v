(** A-stability of R = P/Q: |P|^2 <= |Q|^2 on the left half-plane, because |Q|^2 - |P|^2 is a polynomial in -x and y^2
    without a negative coefficient, z = x + iy. *)

From Coq Require Import ZArith Reals Lra Lia List Bool.
Import ListNotations.
Open Scope R_scope.

(** The value at x + iy of a polynomial with integer coefficients, constant term first: real and imaginary part. *)
Fixpoint at_complex (p : list Z) (x y : R) : R * R :=
  match p with
  | [] => (0, 0)
  | c :: p => let (re, im) := at_complex p x y in (IZR c + x * re - y * im, x * im + y * re)
  end.
Definition norm2 (z : R * R) : R := fst z ^ 2 + snd z ^ 2.
Definition contractive (P Q : list Z) : Prop :=
  forall x y, x <= 0 -> norm2 (at_complex P x y) <= norm2 (at_complex Q x y).

(** Polynomials in s = -x, and polynomials in y whose coefficients they are. *)
Fixpoint add1 (p q : list Z) : list Z :=
  match p, q with c :: p, d :: q => (c + d)%Z :: add1 p q | [], q => q | p, [] => p end.
Fixpoint mul1 (p q : list Z) : list Z :=
  match p with [] => [] | c :: p => add1 (map (Z.mul c) q) (0%Z :: mul1 p q) end.
Fixpoint at1 (p : list Z) (s : R) : R := match p with [] => 0 | c :: p => IZR c + s * at1 p s end.
Fixpoint add2 (p q : list (list Z)) : list (list Z) :=
  match p, q with c :: p, d :: q => add1 c d :: add2 p q | [], q => q | p, [] => p end.
Fixpoint mul2 (p q : list (list Z)) : list (list Z) :=
  match p with [] => [] | c :: p => add2 (map (mul1 c) q) ([] :: mul2 p q) end.
Fixpoint at2 (p : list (list Z)) (s y : R) : R := match p with [] => 0 | c :: p => at1 c s + y * at2 p s y end.
Definition scaled2 (c : Z) (p : list (list Z)) : list (list Z) := map (map (Z.mul c)) p.

Lemma at1_add p : forall q s, at1 (add1 p q) s = at1 p s + at1 q s.
Proof. induction p as [|c p IH]; intros [|d q] s; cbn; try ring. rewrite plus_IZR, IH. ring. Qed.
Lemma at1_scaled c p s : at1 (map (Z.mul c) p) s = IZR c * at1 p s.
Proof. induction p as [|d p IH]; cbn [map at1]; [ring|]. rewrite mult_IZR, IH. ring. Qed.
Lemma at1_mul p q s : at1 (mul1 p q) s = at1 p s * at1 q s.
Proof. induction p as [|c p IH]; cbn [mul1 at1]; [ring|]. rewrite at1_add, at1_scaled. cbn [at1]. rewrite IH. ring. Qed.
Lemma at2_add p : forall q s y, at2 (add2 p q) s y = at2 p s y + at2 q s y.
Proof. induction p as [|c p IH]; intros [|d q] s y; cbn; try ring. rewrite at1_add, IH. ring. Qed.
Lemma at2_mul1 c p s y : at2 (map (mul1 c) p) s y = at1 c s * at2 p s y.
Proof. induction p as [|d p IH]; cbn [map at2]; [ring|]. rewrite at1_mul, IH. ring. Qed.
Lemma at2_mul p q s y : at2 (mul2 p q) s y = at2 p s y * at2 q s y.
Proof.
  induction p as [|c p IH]; cbn [mul2 at2]; [ring|]. rewrite at2_add, at2_mul1. cbn [at2 at1]. rewrite IH. ring.
Qed.
Lemma at2_scaled c p s y : at2 (scaled2 c p) s y = IZR c * at2 p s y.
Proof. induction p as [|d p IH]; cbn [scaled2 map at2]; [ring|]. unfold scaled2 in IH. rewrite at1_scaled, IH. ring. Qed.

(** Real and imaginary part as such polynomials. *)
Fixpoint parts_of (p : list Z) : list (list Z) * list (list Z) :=
  match p with
  | [] => ([], [])
  | c :: p => let (re, im) := parts_of p in
              (add2 [[c]] (add2 (mul2 [[0; -1]%Z] re) (mul2 [[]; [-1]%Z] im)),
               add2 (mul2 [[0; -1]%Z] im) (mul2 [[]; [1]%Z] re))
  end.
Definition squared (p : list Z) : list (list Z) :=
  let (re, im) := parts_of p in add2 (mul2 re re) (mul2 im im).

Lemma at_parts p s y : at_complex p (- s) y = (at2 (fst (parts_of p)) s y, at2 (snd (parts_of p)) s y).
Proof.
  induction p as [|c p IH]; cbn [at_complex parts_of]; [reflexivity|]. rewrite IH.
  destruct (parts_of p) as [re im]. cbn [fst snd]. rewrite !at2_add, !at2_mul. cbn [at2 at1]. f_equal; ring.
Qed.

Lemma at_squared p s y : norm2 (at_complex p (- s) y) = at2 (squared p) s y.
Proof.
  rewrite at_parts. unfold norm2, squared; cbn [fst snd]. destruct (parts_of p) as [re im]; cbn [fst snd].
  rewrite at2_add, !at2_mul. ring.
Qed.

(** Odd powers of y do not occur, and even ones have no negative coefficient. *)
Fixpoint visible (p : list (list Z)) (even : bool) : bool :=
  match p with
  | [] => true
  | c :: p => forallb (if even then Z.leb 0 else Z.eqb 0) c && visible p (negb even)
  end.

Lemma at1_nonneg c s : 0 <= s -> forallb (Z.leb 0) c = true -> 0 <= at1 c s.
Proof.
  intros positive. induction c as [|z c IH]; cbn [forallb at1]; intros E; [lra|].
  apply andb_prop in E as [E E']. apply Z.leb_le, IZR_le in E. specialize (IH E'). nra.
Qed.

Lemma at1_zero c s : forallb (Z.eqb 0) c = true -> at1 c s = 0.
Proof.
  induction c as [|z c IH]; cbn [forallb at1]; intros E; [reflexivity|].
  apply andb_prop in E as [E E']. apply Z.eqb_eq in E. subst z. rewrite (IH E'). ring.
Qed.

Lemma visible_nonneg p : forall s y, 0 <= s ->
  (visible p true = true -> 0 <= at2 p s y) /\ (visible p false = true -> 0 <= y * at2 p s y).
Proof.
  induction p as [|c p IH]; intros s y positive; cbn [visible at2 negb]; [lra|].
  destruct (IH s y positive) as [even odd]. split; intros E; apply andb_prop in E as [E E'].
  - generalize (at1_nonneg c s positive E), (odd E'). lra.
  - rewrite (at1_zero c s E). specialize (even E'). replace (y * (0 + y * at2 p s y)) with (y ^ 2 * at2 p s y) by ring.
    apply Rmult_le_pos; [apply pow2_ge_0 | exact even].
Qed.

Theorem contractive_of_signs P Q :
  visible (add2 (squared Q) (scaled2 (-1) (squared P))) true = true -> contractive P Q.
Proof.
  intros E x y left. apply (visible_nonneg _ (- x) y) in E; [|lra].
  rewrite at2_add, at2_scaled, <- !at_squared, Ropp_involutive in E. lra.
Qed.

Ltac by_sign := apply contractive_of_signs; vm_compute; reflexivity.
