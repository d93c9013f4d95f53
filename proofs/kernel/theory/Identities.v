(** Identities in h, q and v, and inequalities that they make visible: how both are proved of any table. *)

From Coq Require Import QArith Qreals Reals Lra.
From Coquelicot Require Export Coquelicot.
From driftproof Require Export Methods Arithmetic Readouts.
Open Scope R_scope.

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
