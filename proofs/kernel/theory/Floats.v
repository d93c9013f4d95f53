(** Programs in binary64: Coq's primitive floats are the processor's. *)

From Coq Require Import ZArith QArith Floats Uint63.
From driftproof Require Import Arithmetic.

Definition float_of_Z (z : Z) : float :=
  if (z <? 0)%Z then PrimFloat.opp (PrimFloat.of_uint63 (of_Z (- z))) else PrimFloat.of_uint63 (of_Z z).
#[export] Instance float_arithmetic : Arithmetic float :=
  {| plus := PrimFloat.add; times := PrimFloat.mul; over := PrimFloat.div; negative := PrimFloat.opp;
     integer := float_of_Z |}.

(** n steps of a program, each from where the last one ended. *)
Fixpoint float_run (program : float -> float -> float -> float * float) (h : float) (n : nat) (z : float * float) :=
  match n with O => z | S n => let (q, v) := float_run program h n z in program h q v end.

(** Binary32, of which the processor's floats are no instance: the operations that Coq specifies, bit for bit. *)
Definition single_of_Z (z : Z) : spec_float := binary_normalize 24 128 z 0 false.
Definition single_arithmetic : Arithmetic spec_float :=
  {| plus := SFadd 24 128; times := SFmul 24 128; over := SFdiv 24 128; negative := SFopp; integer := single_of_Z |}.
Fixpoint single_run (program : spec_float -> spec_float -> spec_float -> spec_float * spec_float) (h : spec_float)
  (n : nat) (z : spec_float * spec_float) :=
  match n with O => z | S n => let (q, v) := single_run program h n z in program h q v end.
(** The rational number that a finite float is. *)
Definition rational_of (x : spec_float) : Q :=
  match x with
  | S754_finite s m e => Qred (inject_Z (if s then Zneg m else Zpos m) * Qpower 2 e)
  | _ => 0
  end.
