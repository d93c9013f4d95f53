(** Smooth problems y' = f(y) of any dimension, and the steps of a method for them. *)

From Coq Require Import QArith Qreals Reals List.
From Coquelicot Require Import Coquelicot.
From driftproof Require Import Methods.
Import ListNotations.
Open Scope R_scope.

Definition vector : Type := nat -> R.  (* of d components, those below d *)

(** One step of the same data. A kick moves those components that are velocities, a drift the others. *)
Section Step.
  Variables (f : vector -> vector) (velocity : nat -> bool) (h : R).
  Fixpoint combined (y : vector) (row : list Q) (slopes : list vector) : vector :=
    match row, slopes with
    | a :: row, k :: slopes => combined (fun i => y i + Q2R a * h * k i) row slopes
    | _, _ => y
    end.
  Fixpoint vector_slopes (y : vector) (rows : list (list Q)) (known : list vector) : list vector :=
    match rows with
    | [] => known
    | row :: rows => vector_slopes y rows (known ++ [f (combined y row known)])
    end.
  Definition vector_part (y : vector) (s : substep) : vector :=
    match s with
    | kick c => fun i => if velocity i then y i + Q2R c * h * f y i else y i
    | drift c => fun i => if velocity i then y i else y i + Q2R c * h * f y i
    end.
  Definition vector_step (m : method) (y : vector) : vector :=
    match m with
    | RungeKutta A b => combined y b (vector_slopes y A [])
    | Splitting parts => fold_left vector_part parts y
    end.
  Fixpoint vector_run (m : method) (n : nat) (y : vector) : vector :=
    match n with O => y | S n => vector_step m (vector_run m n y) end.
End Step.

Fixpoint total (d : nat) (x : nat -> R) : R := match d with O => 0 | S d => total d x + x d end.
Definition in_ball (d : nat) (B : R) (y : vector) : Prop := forall i, (i < d)%nat -> Rabs (y i) <= B.

(** f = D [] has partial derivatives of all orders, D (j :: l) being that of D l
    in the direction j: the chain rule holds
    along every curve, and each is bounded on each ball. *)
Record smooth (d : nat) (D : list nat -> vector -> vector) : Prop := {
  chain_rule : forall l (c : R -> vector) (c' : vector) t i, (i < d)%nat ->
    (forall j, (j < d)%nat -> is_derive (fun s => c s j) t (c' j)) ->
    is_derive (fun s => D l (c s) i) t (total d (fun j => D (j :: l)%list (c t) i * c' j));
  bounded_on_balls : forall l B, exists M, forall y i, (i < d)%nat -> in_ball d B y -> Rabs (D l y i) <= M }.

Definition solution (d : nat) (f : vector -> vector) (T : R) (y : R -> vector) : Prop :=
  forall t i, 0 <= t <= T -> (i < d)%nat -> is_derive (fun s => y s i) t (f (y t) i).

(** Over a fixed interval the runs of the method err by O(h^p). *)
Definition converges (m : method) (p : nat) : Prop :=
  forall d velocity D T y, smooth d D -> 0 <= T -> solution d (D []) T y ->
  exists C h0, 0 < h0 /\ forall h n i, 0 < h <= h0 -> INR n * h <= T -> (i < d)%nat ->
    Rabs (vector_run (D []) velocity h m n (y 0) i - y (INR n * h) i) <= C * h ^ p.
(** One step from the exact state errs by O(h^p). *)
Definition one_step_error (m : method) (p : nat) : Prop :=
  forall d velocity D T y, smooth d D -> 0 <= T -> solution d (D []) T y ->
  exists C, forall t h i, 0 <= t -> 0 <= h <= 1 -> t + h <= T -> (i < d)%nat ->
    Rabs (vector_step (D []) velocity h m (y t) i - y (t + h) i) <= C * h ^ p.
