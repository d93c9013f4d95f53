(** What a step does to the energy, and what symplectic Euler keeps instead. *)

From Coq Require Import QArith Qreals Reals Lra Lia Psatz.
From driftproof Require Import Runs Tables OneStep.
Open Scope R_scope.

Lemma pow_unbounded x B : 1 < x -> exists n, B < x ^ n.
Proof.
  intros large. destruct (Pow_x_infinity x) with (b := B + 1) as [n above].
  - rewrite Rabs_pos_eq; lra.
  - exists n. specialize (above n (Nat.le_refl n)). rewrite Rabs_pos_eq in above by (apply pow_le; lra). lra.
Qed.

Lemma energy_pos q v : (q, v) <> (0, 0) -> 0 < energy (q, v).
Proof.
  intros other. assert (q <> 0 \/ v <> 0) as [at_q|at_v].
  { destruct (Req_dec q 0), (Req_dec v 0); subst; tauto. }
  - generalize (square_pos q at_q), (Rle_0_sqr v). expose. lra.
  - generalize (square_pos v at_v), (Rle_0_sqr q). expose. lra.
Qed.

(** A method that multiplies every energy by m multiplies it by m^n in n steps. *)
Lemma energy_of_run m h factor z :
  (forall q v, energy (step m h (q, v)) = factor * energy (q, v)) ->
  forall n, energy (run m h n z) = factor ^ n * energy z.
Proof.
  intros one n. induction n as [|n IH]; cbn [run pow]; [ring|].
  destruct (run m h n z) as [q v]. rewrite one, IH. ring.
Qed.

Theorem L035_L036 : forall h q v : R,
  let (x, y) := step forward_euler h (q, v) in
  x ^ 2 = q ^ 2 + 2 * h * q * v + h ^ 2 * v ^ 2 /\ y ^ 2 = v ^ 2 - 2 * h * q * v + h ^ 2 * q ^ 2
  /\ energy (x, y) = (1 + h ^ 2) * energy (q, v).
Proof. by_ring. Qed.

Lemma energy_of_forward_euler h q v : energy (step forward_euler h (q, v)) = (1 + h ^ 2) * energy (q, v).
Proof. by_ring. Qed.

Theorem L010_L037_L123 : forall h q v : R, 0 < h ->
  energy (step forward_euler h (q, v)) - energy (q, v) = h ^ 2 * energy (q, v)
  /\ ((q, v) <> (0, 0) -> 0 < h ^ 2 * energy (q, v))
  /\ energy (step forward_euler h (0, 0)) = energy (0, 0).
Proof.
  intros h q v positive. parts; [by_ring | | by_ring].
  intros other. apply Rmult_lt_0_compat; [apply pow_lt, positive | apply energy_pos, other].
Qed.

Theorem L038 : forall h z n, energy (run forward_euler h n z) = (1 + h ^ 2) ^ n * energy z.
Proof. intros. apply energy_of_run, energy_of_forward_euler. Qed.

Theorem L040 : forall h q v : R, 0 < h ->
  ((q, v) <> (0, 0) -> forall B, exists n, B < energy (run forward_euler h n (q, v)))
  /\ (forall n, run forward_euler h n (0, 0) = (0, 0))
  /\ distance (step forward_euler h (q, v)) (0, 0) = sqrt (1 + h ^ 2) * distance (q, v) (0, 0) /\ 1 < sqrt (1 + h ^ 2).
Proof.
  intros h q v positive. split; [|split; [|split]].
  - intros other B. generalize (energy_pos q v other). intros E.
    destruct (pow_unbounded (1 + h ^ 2) (B / energy (q, v))) as [n above]; [nra|].
    exists n. rewrite L038. apply (Rmult_lt_compat_r (energy (q, v))) in above; [|assumption].
    unfold Rdiv in above. rewrite Rmult_assoc, Rinv_l, Rmult_1_r in above; lra.
  - intros n; induction n as [|n IH]; cbn [run]; [reflexivity | rewrite IH; by_ring].
  - unfold distance. rewrite <- sqrt_mult_alt by nra. f_equal. by_ring.
  - rewrite <- sqrt_1 at 1. apply sqrt_lt_1_alt. nra.
Qed.

Theorem L051 :
  (forall h q v : R, energy (step symplectic_euler h (q, v)) - energy (q, v)
     = h ^ 2 / 2 * (v - (h + 1) * q) * (v - (h - 1) * q))
  /\ exists h q v : R, energy (step symplectic_euler h (q, v)) <> energy (q, v).
Proof. split; [by_ring|]. exists 1, 0, 1. expose. lra. Qed.

Theorem L052 :
  (forall h q v : R, modified_energy h (q, v) = (q ^ 2 + v ^ 2 - h * q * v) / 2
     /\ modified_energy h (step symplectic_euler h (q, v)) = modified_energy h (q, v))
  /\ exists h q v : R, modified_energy h (step symplectic_euler_position_first h (q, v)) <> modified_energy h (q, v).
Proof. split; [by_ring|]. exists 1, 1, 0. expose. lra. Qed.

Lemma modified_energy_of_run h z n : modified_energy h (run symplectic_euler h n z) = modified_energy h z.
Proof.
  induction n as [|n IH]; cbn [run]; [reflexivity|]. rewrite <- IH.
  destruct (run symplectic_euler h n z) as [q v]. by_ring.
Qed.

Theorem L054 : forall h q v : R,
  modified_energy h (q, v) - energy (q, v) = - (1 / 2) * h * q * v
  /\ (modified_energy h (q, v) = energy (q, v) <-> h = 0 \/ q = 0 \/ v = 0).
Proof.
  intros h q v.
  assert (D : modified_energy h (q, v) - energy (q, v) = - (1 / 2) * h * q * v) by by_ring.
  split; [exact D | split; intros E].
  - assert (P : h * q * v = 0) by lra.
    apply Rmult_integral in P as [P|]; [apply Rmult_integral in P as [|]|]; auto.
  - apply Rminus_diag_uniq. rewrite D. destruct E as [->|[->| ->]]; ring.
Qed.

(** On a level curve of 0 < h < 2 both components stay bounded. *)
Theorem L055 : forall h q v : R, 0 < h < 2 ->
  2 * modified_energy h (q, v) = (q - h * v / 2) ^ 2 + (1 - h ^ 2 / 4) * v ^ 2
  /\ 2 * modified_energy h (q, v) = (v - h * q / 2) ^ 2 + (1 - h ^ 2 / 4) * q ^ 2
  /\ 0 < 1 - h ^ 2 / 4
  /\ q ^ 2 <= 2 * modified_energy h (q, v) / (1 - h ^ 2 / 4)
  /\ v ^ 2 <= 2 * modified_energy h (q, v) / (1 - h ^ 2 / 4)
  /\ (modified_energy h (q, v) = 0 -> q = 0 /\ v = 0).
Proof.
  intros h q v interval.
  assert (A : 2 * modified_energy h (q, v) = (q - h * v / 2) ^ 2 + (1 - h ^ 2 / 4) * v ^ 2) by by_ring.
  assert (B : 2 * modified_energy h (q, v) = (v - h * q / 2) ^ 2 + (1 - h ^ 2 / 4) * q ^ 2) by by_ring.
  assert (P : 0 < 1 - h ^ 2 / 4) by nra.
  assert (bound : forall x y c : R, c = y ^ 2 + (1 - h ^ 2 / 4) * x ^ 2 -> x ^ 2 <= c / (1 - h ^ 2 / 4)).
  { intros x y c ->. apply Rmult_le_reg_r with (1 - h ^ 2 / 4); [assumption|].
    unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. generalize (pow2_ge_0 y). lra. }
  parts; [exact A | exact B | exact P | exact (bound _ _ _ B) | exact (bound _ _ _ A) |].
  intros E. rewrite E in A, B. split; apply Rsqr_0_uniq; unfold Rsqr.
  - generalize (pow2_ge_0 (v - h * q / 2)), (pow2_ge_0 q); nra.
  - generalize (pow2_ge_0 (q - h * v / 2)), (pow2_ge_0 v); nra.
Qed.

(** Open: on every curve there are states as far away as one likes. *)
Theorem L056 :
  (forall q v : R, modified_energy 2 (q, v) = (q - v) ^ 2 / 2)
  /\ forall h level B, 2 < h -> exists q v, modified_energy h (q, v) = level /\ B < q ^ 2 + v ^ 2.
Proof.
  split; [by_ring|]. intros h level B large. assert (b := Rabs_pos B). assert (l := Rabs_pos level).
  assert (B <= Rabs B) by apply Rle_abs. assert (- level <= Rabs level) by (rewrite <- Rabs_Ropp; apply Rle_abs).
  set (k := h ^ 2 - 4). assert (k_pos : 0 < k) by (unfold k; nra).
  set (v := 1 + Rabs B + 8 * Rabs level / k). set (d := (h * v) ^ 2 - 4 * (v ^ 2 - 2 * level)).
  assert (0 <= 8 * Rabs level / k) by (apply Rmult_le_pos; [lra | now apply Rlt_le, Rinv_0_lt_compat]).
  assert (v1 : 1 + Rabs B <= v) by (unfold v; lra).
  assert (D : 0 <= d).
  { replace d with (k * v ^ 2 + 8 * level) by (unfold d, k; ring).
    assert (k * v <= k * v ^ 2) by (apply Rmult_le_compat_l; nra).
    assert (k * v = k + k * Rabs B + 8 * Rabs level) by (unfold v; field; lra).
    assert (0 <= k * Rabs B) by (apply Rmult_le_pos; lra). lra. }
  assert (S : sqrt d * sqrt d = (h * v) ^ 2 - 4 * (v ^ 2 - 2 * level)) by now apply sqrt_sqrt.
  generalize dependent (sqrt d). intros r S. clear D d. clearbody v. exists ((h * v + r) / 2), v.
  split; [|generalize (pow2_ge_0 ((h * v + r) / 2)); nra].
  transitivity ((r * r - (h * v) ^ 2 + 4 * v ^ 2) / 8); [by_ring | lra].
Qed.

Theorem L090 : (energy (run symplectic_euler (1#2) 1 start) == 13 / 32 /\ ~ 13 / 32 == energy start)%Q
  /\ forall h, determinant symplectic_euler h = 1.
Proof. split; [split; [reflexivity | discriminate] | by_ring]. Qed.

Theorem L091 :
  let error m := distance (to_R (run m (1#2) 1 start)) (flow (1 / 2)) in
  let change m := Rabs (energy (to_R (run m (1#2) 1 start)) - 1 / 2) in
  error rk4 < error symplectic_euler /\ error rk4 < error forward_euler
  /\ change rk4 < change symplectic_euler /\ change rk4 < change forward_euler.
Proof. cbv zeta. by_interval. Qed.

Theorem L111 : ((17 / 16) ^ 20 * (17 / 16) ^ 20 == 2 * energy (run forward_euler (1#4) 40 start)
  /\ 3.36 < (17 / 16) ^ 20 < 3.37)%Q.
Proof. by_vm. Qed.

(** What is read out as the energy change is measured from 1/2. *)
Theorem L137 : (energy start == 1 / 2)%Q
  /\ forall m h n, (energy (run m h n start) - energy start == energy (run m h n start) - 1 / 2)%Q.
Proof. split; [reflexivity|]. intros. change (energy start) with (1 # 2). reflexivity. Qed.

Theorem L146 :
  (forall h q v : R, 2 * modified_energy h (q, v) - (1 - h / 2) * (q ^ 2 + v ^ 2) = h / 2 * (q - v) ^ 2)
  /\ forall n, let (q, v) := run symplectic_euler (1 / 2) n (1, 0) in q ^ 2 + v ^ 2 <= 4 / 3.
Proof.
  assert (I : forall h q v : R, 2 * modified_energy h (q, v) - (1 - h / 2) * (q ^ 2 + v ^ 2) = h / 2 * (q - v) ^ 2)
    by by_ring.
  split; [exact I|]. intros n. generalize (modified_energy_of_run (1 / 2) (1, 0) n).
  destruct (run symplectic_euler (1 / 2) n (1, 0)) as [q v]. intros kept. specialize (I (1 / 2) q v).
  rewrite kept in I. clear kept. revert I. generalize (pow2_ge_0 (q - v)). expose. lra.
Qed.

Theorem L228_L236 : forall h, 0 < h ->
  (exists z, energy z < energy (step symplectic_euler h z)) /\ exists z, energy (step symplectic_euler h z) < energy z.
Proof.
  intros h positive. assert (0 < h ^ 2) by nra.
  split; [exists (0, 1); generalize (proj1 L051 h 0 1) | exists (1, h); generalize (proj1 L051 h 1 h)]; nra.
Qed.

Theorem L238 : forall h : R,
  energy (step symplectic_euler h (1, 0)) - energy (1, 0) = h ^ 2 * (h ^ 2 - 1) / 2
  /\ energy (step symplectic_euler h (0, 1)) - energy (0, 1) = h ^ 2 / 2
  /\ (0 < h < 1 -> h ^ 2 * (h ^ 2 - 1) / 2 < 0) /\ (1 < h -> 0 < h ^ 2 * (h ^ 2 - 1) / 2).
Proof.
  intros h. split; [by_ring | split; [by_ring | split; intros inside]].
  - assert (0 < h ^ 2 < 1) by (split; nra). nra.
  - assert (1 < h ^ 2) by nra. nra.
Qed.

Theorem L227 : (energy (run forward_euler (1#2) 1 (0, 1)) == 5 / 8 /\ energy (run symplectic_euler (1#2) 1 (0,
  1)) == 5 / 8)%Q.
Proof. by_vm. Qed.

Theorem L235 : (energy (0, 1) == 1 / 2 /\ 1 / 2 < 5 / 8 /\ energy (run symplectic_euler (1#2) 1 (0, 1)) == 5 / 8)%Q.
Proof. by_vm. Qed.
