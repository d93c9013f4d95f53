(** A-stability: a step for y' = z y increases no |y| where Re z <= 0. *)

From Coq Require Import ZArith QArith Reals List.
From Coquelicot Require Import Complex.
From driftproof Require Import Trees Orders.
Import ListNotations.
Open Scope R_scope.

(** One step of size 1 for y' = z y: the stages Y = y0 e + z A Y, then y0 + z b Y. *)
Fixpoint weighted (row : list R) (Y : list C) : C :=
  match row, Y with a :: row, y :: Y => (RtoC a * y + weighted row Y)%C | _, _ => RtoC 0 end.
Definition steps_to (A : list (list R)) (b e : list R) (z y0 : C) (Y : list C) (y1 : C) : Prop :=
  Y = map (fun p => RtoC (fst p) * y0 + z * weighted (snd p) Y)%C (combine e A) /\ y1 = (y0 + z * weighted b Y)%C.
Definition contractive (A : list (list R)) (b e : list R) : Prop := forall z y0, Re z <= 0 ->
  (exists Y y1, steps_to A b e z y0 Y y1) /\ forall Y y1, steps_to A b e z y0 Y y1 -> Cmod y1 <= Cmod y0.
Definition expansive (A : list (list R)) (b e : list R) : Prop := exists z y0 Y y1,
  Re z <= 0 /\ steps_to A b e z y0 Y y1 /\ Cmod y0 < Cmod y1.

(** Of a Runge-Kutta method e is (1, ..., 1). *)
Definition of_table (is_so : list (list R) -> list R -> list R -> Prop) (e : list Z) (t : table) : Prop :=
  (exists a, is_root t a) /\ forall a, is_root t a ->
    is_so (map (map (coefficient t a)) (matrix t)) (map (coefficient t a) (weights t)) (map IZR e).
Definition a_stable (t : table) : Prop := of_table contractive (map (fun _ => 1%Z) (written_weights t)) t.
Definition not_a_stable (t : table) : Prop := of_table expansive (map (fun _ => 1%Z) (written_weights t)) t.

(** Collocation at the s nodes that are the roots of m, constant term first. The stages are the polynomial U of degree
    below s with U = y0 + z (integral of U) at the nodes, by its coefficients: t^k goes to t^(k+1)/(k+1), and t^s to
    what m leaves of it. All over the denominator s! m_s. *)
Definition collocation (m : list Z) : table :=
  let s := (length m - 1)%nat in
  let part k := (fold_left Z.mul (map Z.of_nat (seq 1 s)) 1 / Z.of_nat k)%Z in  (* s!/k *)
  let when (c : bool) x := if c then x else 0%Z in
  let entry i j := (when (S j =? i)%nat (last m 0 * part i) - when (S j =? s)%nat (nth i m 0 * part s))%Z in
  {| written_relation := [0%Z]; low := 0; high := 0; denominator := last m 0%Z * part 1%nat;
     written_matrix := map (fun i => map (fun j => [entry i j]) (seq 0 s)) (seq 0 s);
     written_weights := map (fun k => [(last m 0 * part (S k))%Z]) (seq 0 s) |}.
Definition one (m : list Z) : list Z := map (fun k => match k with O => 1 | _ => 0 end%Z) (seq 0 (length m - 1)).
Definition collocation_is_a_stable (m : list Z) : Prop := of_table contractive (one m) (collocation m).
Definition collocation_is_not_a_stable (m : list Z) : Prop := of_table expansive (one m) (collocation m).
