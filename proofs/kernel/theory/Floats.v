(** Programs in binary64: Coq's primitive floats are the processor's. *)

From Coq Require Import ZArith Floats Uint63.
From driftproof Require Import Arithmetic.

Definition float_of_Z (z : Z) : float :=
  if (z <? 0)%Z then PrimFloat.opp (PrimFloat.of_uint63 (of_Z (- z))) else PrimFloat.of_uint63 (of_Z z).
#[export] Instance float_arithmetic : Arithmetic float :=
  {| plus := PrimFloat.add; times := PrimFloat.mul; over := PrimFloat.div; negative := PrimFloat.opp;
     integer := float_of_Z |}.

(** n steps of a program, each from where the last one ended. *)
Fixpoint float_run (program : float -> float -> float -> float * float) (h : float) (n : nat) (z : float * float) :=
  match n with O => z | S n => let (q, v) := float_run program h n z in program h q v end.
