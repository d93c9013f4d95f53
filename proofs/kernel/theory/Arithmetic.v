(** The operations of a program, in the order in which it makes them, over any numbers. *)

From Coq Require Import ZArith Reals.

Class Arithmetic (T : Type) :=
  { plus : T -> T -> T; times : T -> T -> T; over : T -> T -> T; negative : T -> T; integer : Z -> T }.
#[export] Instance real_arithmetic : Arithmetic R :=
  {| plus := Rplus; times := Rmult; over := Rdiv; negative := Ropp; integer := IZR |}.
