(** The order of a Runge-Kutta method: its conditions over all rooted trees, and how they are checked for all at once.

    An ordered tree is a vertex, or a tree with one more branch grafted to its root. Every rooted tree is one, drawn in
    the plane in some way, and the weight and the density do not depend on the way. *)

From Coq Require Import QArith Qreals Reals Lra Lia List.
Import ListNotations.
Open Scope R_scope.

Inductive tree := vertex | graft (t u : tree).  (* u is the last branch of the root *)

Fixpoint vertices (t : tree) : nat :=
  match t with vertex => 1 | graft t u => vertices t + vertices u end.

(** The product over the branches of the root of their densities; times the number of vertices, the density. *)
Fixpoint branches (t : tree) : nat :=
  match t with vertex => 1 | graft t u => branches t * (vertices u * branches u) end.
Definition density (t : tree) : nat := vertices t * branches t.

(** Phi(t) = sum_i b_i prod over the branches u of (A phi(u))_i: the elementary weight (Butcher 2016, 312). *)
Section Weights.
  Variables (A : list (list R)) (b : list R).
  Fixpoint dot (x y : list R) : R :=
    match x, y with a :: x, c :: y => a * c + dot x y | _, _ => 0 end.
  Fixpoint times (x y : list R) : list R :=
    match x, y with a :: x, c :: y => a * c :: times x y | _, _ => [] end.
  Fixpoint stages (t : tree) : list R :=
    match t with
    | vertex => map (fun _ => 1) b
    | graft t u => times (stages t) (map (fun row => dot row (stages u)) A)
    end.
  Definition weight (t : tree) : R := dot b (stages t).
  Definition meets (t : tree) : Prop := weight t * INR (density t) = 1.

  (** Order p and no higher: every tree with up to p vertices meets its condition, one with p + 1 does not. *)
  Definition order (p : nat) : Prop :=
    (forall t, (vertices t <= p)%nat -> meets t) /\ exists t, vertices t = S p /\ ~ meets t.
End Weights.
