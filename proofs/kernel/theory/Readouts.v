(** What is read out of a state, what a printed decimal says; and how identities in h, q and v are proved of any
    table. *)

From Coq Require Import QArith Qreals Qabs Reals Lra.
From Coquelicot Require Export Coquelicot.
From driftproof Require Export Methods.
Open Scope R_scope.

(** The solution from (1, 0) is (cos t, - sin t). *)
Definition flow (t : R) : state R := (cos t, - sin t).
Definition distance (z w : state R) : R := sqrt ((fst z - fst w) ^ 2 + (snd z - snd w) ^ 2).

(** The angle of (x, y), from -PI up to but not including PI; 0 at the origin, where there is none. *)
Definition angle (y x : R) : R :=
  if Rlt_dec 0 x then atan (y / x)
  else if Rlt_dec x 0 then atan (y / x) + (if Rlt_dec 0 y then PI else - PI)
  else if Rlt_dec 0 y then PI / 2
  else if Rlt_dec y 0 then - (PI / 2) else 0.
(** The angle atan2(-v, q) of z minus that of w, in degrees, wrapped: positive if z is ahead. *)
Definition phase_error (z w : state R) : R :=
  180 / PI * angle (fst z * snd w - snd z * fst w) (fst z * fst w + snd z * snd w).

(** The digits of the decimal d, as they are written, are those of x: they differ by less than half a unit of the
    last. *)
Definition rounds_to (x d : Q) : Prop := (Qabs (x - d) < 1 # (2 * Qden d))%Q.
Definition real_rounds_to (x : R) (d : Q) : Prop := Rabs (x - Q2R d) < / IZR (2 * Zpos (Qden d)).
Notation "x ≈ d" := (rounds_to x%Q d%Q) (at level 70) : Q_scope.
Notation "x ≈ d" := (real_rounds_to x%R d%Q) (at level 70) : R_scope.

Lemma rounds_to_of_reals x y d : Q2R x = Q2R y -> rounds_to y d -> rounds_to x d.
Proof. intros E. apply eqR_Qeq in E. unfold rounds_to. now rewrite E. Qed.

(** Everything of a step is unfolded but the arithmetic of the reals: what is left are polynomials. *)
Ltac expose :=
  cbv -[Rplus Rmult Ropp Rminus Rdiv Rinv IZR pow Rlt Rle Rgt Rge Rabs PI sin cos sqrt exp ln atan not INR
        is_derive ex_derive Derive derivable_pt_lim Q2R];
  unfold Q2R; cbn [Qnum Qden].

(** A conjunction is proved part by part; [split] alone would take definitions apart, too. *)
Ltac parts := repeat match goal with |- _ /\ _ => split end.

(** Equations, of numbers or of states, and several of them. *)
Ltac by_ring :=
  intros; expose;
  repeat match goal with |- _ /\ _ => split | |- (_, _) = (_, _) => apply f_equal2 end; intros; field; try lra.

(** An equation of numbers that Coquelicot calls elements of a module. *)
Ltac real_field := match goal with |- @eq _ ?x ?y => change (@eq R x y) end; field.
Ltac real_ring := match goal with |- @eq _ ?x ?y => change (@eq R x y) end; ring.

(** A sign that an identity shows: squares and products of what is positive. *)
Lemma square_pos x : x <> 0 -> 0 < x * x.
Proof. intros. nra. Qed.

Lemma pow_le_exp x n : 0 <= x -> (1 + x) ^ n <= exp (INR n * x).
Proof.
  intros positive. apply Rle_trans with (exp x ^ n); [apply pow_incr; split; [lra | apply exp_ineq1_le]|].
  apply Req_le. induction n as [|n IH]; cbn [pow]; [cbn; now rewrite Rmult_0_l, exp_0|].
  rewrite IH, <- exp_plus, S_INR. f_equal. ring.
Qed.
