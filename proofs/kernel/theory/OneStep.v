(** What one step of each method is: the formulas of the lesson, true of the tables. *)

From Coq Require Import QArith Qreals Reals Lra List.
From driftproof Require Import Readouts Tables.
Import ListNotations.
Open Scope R_scope.

(** Of a step that is linear in the state: the determinant of its matrix. *)
Definition determinant (m : method) (h : R) : R :=
  fst (step m h (1, 0)) * snd (step m h (0, 1)) - fst (step m h (0, 1)) * snd (step m h (1, 0)).

(** The area of the parallelogram that two states span, with its sign: z^T J w. *)
Definition area (z w : state R) : R := fst z * snd w - snd z * fst w.

Theorem L033_L204 : forall h q v : R,
  step forward_euler h (q, v) = (q + h * v, v - h * q) /\ forward_euler_program h q v = (q + h * v, v - h * q).
Proof. by_ring. Qed.

Theorem L032 : exists A b, forward_euler = RungeKutta A b /\ b = [1%Q]
  /\ forall force h (z : state R), slopes force h z A [] = [rate force z].
Proof. exists [[]], [1%Q]. repeat split. Qed.

Theorem L034 : forall h q v : R,
  let position_reused := let x := q + h * v in (x, v - h * x) in
  let velocity_reused := let y := v - h * q in (q + h * y, y) in
  let (x, y) := step forward_euler h (q, v) in
  position_reused = (x, y - h ^ 2 * v) /\ velocity_reused = (x - h ^ 2 * q, y)
  /\ position_reused = step symplectic_euler_position_first h (q, v)
  /\ velocity_reused = step symplectic_euler h (q, v).
Proof. by_ring. Qed.

Theorem L011_L050 : forall h, determinant symplectic_euler h = 1 /\ determinant forward_euler h = 1 + h ^ 2.
Proof. by_ring. Qed.

Theorem L006 : forall h q v : R,
  let (x, y) := step forward_euler h (q, v) in
  let (x', y') := step symplectic_euler h (q, v) in
  y' = y /\ x' - x = h * (y' - v) /\ x' - x = - (h ^ 2 * q).
Proof. by_ring. Qed.

Theorem L042_L045 : forall h q v : R,
  let (x, y) := step symplectic_euler h (q, v) in y = v - h * q /\ x = q + h * y.
Proof. by_ring. Qed.

Theorem L043_L205 : forall h q v : R,
  symplectic_euler_program h q v = (q + h * (v - h * q), v - h * q)
  /\ step symplectic_euler h (q, v) = ((1 - h ^ 2) * q + h * v, - h * q + 1 * v)
  /\ step symplectic_euler h (q, v) = symplectic_euler_program h q v.
Proof. by_ring. Qed.

Theorem L044 : (forall h z w, area (step symplectic_euler h z) (step symplectic_euler h w) = area z w)
  /\ forall h, h <> 0 -> exists z w, area (step forward_euler h z) (step forward_euler h w) <> area z w.
Proof.
  split; [intros h [q v] [x y]; by_ring|]. intros h other. exists (1, 0), (0, 1). apply Rminus_not_eq.
  replace (_ - _) with (h * h) by by_ring. generalize (square_pos h other). lra.
Qed.

(** The force is asked once, at the old position, whatever it is. *)
Theorem L046 : evaluations symplectic_euler = 1%nat
  /\ forall (force : R -> R) h q v,
       step_with force symplectic_euler h (q, v) = (q + h * (v + h * force q), v + h * force q).
Proof. split; [reflexivity | by_ring]. Qed.

(** H(q, v) = (1 + q^2) v^2 / 2: the formula for the new velocity holds of two of them at once. *)
Theorem L047 :
  (forall q v1, derivable_pt_lim (fun x => (1 + x ^ 2) * v1 ^ 2 / 2) q (q * v1 ^ 2))
  /\ (forall h q v v1, v1 = v - h * (q * v1 ^ 2) <-> h * q * v1 ^ 2 + v1 - v = 0)
  /\ exists h q v a b, a <> b /\ a = v - h * (q * a ^ 2) /\ b = v - h * (q * b ^ 2).
Proof.
  repeat split; intros; try lra.
  - apply is_derive_Reals. auto_derive; [trivial | field].
  - exists 1, (-1), 0, 0, 1. lra.
Qed.

Theorem L059_L207 : forall h q v : R,
  let k1 := (v, - q) in
  let k2 := (v + h / 2 * snd k1, - (q + h / 2 * fst k1)) in
  let k3 := (v + h / 2 * snd k2, - (q + h / 2 * fst k2)) in
  let k4 := (v + h * snd k3, - (q + h * fst k3)) in
  let weighted component := h / 6 * (component k1 + 2 * component k2 + 2 * component k3 + component k4) in
  step rk4 h (q, v) = (q + weighted fst, v + weighted snd)
  /\ rk4_program h q v = (q + weighted fst, v + weighted snd)
  /\ step rk4 h (q, v) = ((1 - h ^ 2 / 2 + h ^ 4 / 24) * q + (h - h ^ 3 / 6) * v,
                          (- h + h ^ 3 / 6) * q + (1 - h ^ 2 / 2 + h ^ 4 / 24) * v).
Proof. by_ring. Qed.

Theorem L060 : forall q v : R,
  List.Forall (fun k => k = rate oscillator (q, v)) (rates rk4 0 (q, v)) /\ step rk4 0 (q, v) = (q, v).
Proof. split; [| by_ring]. expose. repeat (apply Forall_cons || apply Forall_nil); apply f_equal2; field. Qed.

(** The states at which RK4 asks are those whose rates it forms: none of them is the result, whatever the step. *)
Lemma turned a b q v : (q, v) <> (0, 0) -> a <> 0 \/ b <> 0 -> a * q + b * v = 0 -> a * v - b * q = 0 -> False.
Proof.
  intros other N E F. assert (0 < a * a + b * b) by (destruct N; nra). apply other.
  assert (zero : forall x, (a * a + b * b) * x = 0 -> x = 0) by (intros x X; apply Rmult_integral in X as [|]; lra).
  f_equal; apply zero.
  - replace (_ * q) with (a * (a * q + b * v) - b * (a * v - b * q)) by ring. rewrite E, F. ring.
  - replace (_ * v) with (b * (a * q + b * v) + a * (a * v - b * q)) by ring. rewrite E, F. ring.
Qed.
Theorem L062 : forall h z w, h <> 0 -> z <> (0, 0) ->
  In w (map (fun k => (- snd k, fst k)) (rates rk4 h z)) -> w <> step rk4 h z.
Proof.
  intros h [q v] w other nonzero. revert w. rewrite <- Forall_forall. assert (0 < h * h) by now apply square_pos.
  assert (differ : forall a b w, a <> 0 \/ b <> 0 ->
    step rk4 h (q, v) = (fst w + (a * q + b * v), snd w + (a * v - b * q)) -> w <> step rk4 h (q, v)).
  { intros a b [x y] N E F. rewrite E in F. injection F; cbn [fst snd]; intros. apply (turned a b q v); trivial; lra. }
  unfold rates, rk4. cbn [slopes app map]. repeat (apply Forall_cons || apply Forall_nil).
  - apply (differ (h * h * (h * h / 24 - 1 / 2)) (h * (1 - h * h / 6))); [|by_ring].
    destruct (Req_dec (h * h) 6) as [-> |]; [left; lra | right; apply Rmult_integral_contrapositive; split; lra].
  - apply (differ (h * h * (h * h / 24 - 1 / 2)) (h * (1 / 2 - h * h / 6))); [|by_ring].
    destruct (Req_dec (h * h) 3) as [-> |]; [left; lra | right; apply Rmult_integral_contrapositive; split; lra].
  - apply (differ (h * h * (h * h / 24 - 1 / 4)) (h * (1 / 2 - h * h / 6))); [|by_ring].
    destruct (Req_dec (h * h) 3) as [-> |]; [left; lra | right; apply Rmult_integral_contrapositive; split; lra].
  - apply (differ (h * h * (h * h) / 24) (h * h * h / 12)); [left; nra | by_ring].
Qed.

Theorem L208 : forall q v : R, energy_program q v = (q ^ 2 + v ^ 2) / 2.
Proof. by_ring. Qed.

Theorem L057 : forall q v : R,
  rate oscillator (q, v) = (0 * q + 1 * v, -1 * q + 0 * v)
  /\ rate oscillator (rate oscillator (q, v)) = (- q, - v).
Proof. by_ring. Qed.

Theorem L015 : forall q v : R, rate oscillator (q, v) = (v, - q).
Proof. by_ring. Qed.

(** For any force its Jacobian has determinant 1; the flow, a rotation, has it, too. *)
Theorem L049 :
  (forall (F : R -> R) slope h q v, is_derive F q slope -> exists a b c d,
     is_derive (fun x => fst (step_with F symplectic_euler h (x, v))) q a
     /\ is_derive (fun y => fst (step_with F symplectic_euler h (q, y))) v b
     /\ is_derive (fun x => snd (step_with F symplectic_euler h (x, v))) q c
     /\ is_derive (fun y => snd (step_with F symplectic_euler h (q, y))) v d
     /\ a * d - b * c = 1)
  /\ forall t, cos t * cos t - sin t * - sin t = 1.
Proof.
  split.
  - intros F slope h q v slope_of_F.
    exists (1 + h * (h * slope)), h, (h * slope), 1.
    assert (ex_derive F q) by (now exists slope).
    assert (D : Derive (fun x => F x) q = slope) by (now apply is_derive_unique).
    parts; try (expose; auto_derive); trivial; rewrite ?D; real_field.
  - intros t. generalize (sin2_cos2 t). unfold Rsqr. lra.
Qed.
