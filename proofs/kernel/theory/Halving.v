(** What halving the step does to an error: a ratio of 2^p, and three ways in which it is another; and what an order is
    for. *)

From Coq Require Import QArith Qabs Qreals Reals Lra Lia Psatz List.
From driftproof Require Import Runs Tables Energy Stability ExactFlow Phase Orders OrdersOfTables
  Convergence Problems GlobalErrors FloatRuns.
Open Scope R_scope.

(** RK4 multiplies the radius by the root of its damping, too, and turns by an arctangent. *)
Lemma rk4_polar h n : 0 < 1 - h ^ 2 / 2 + h ^ 4 / 24 ->
  run Tables.rk4 h n (1, 0)
  = polar (sqrt (damping h) ^ n) (INR n * atan ((h - h ^ 3 / 6) / (1 - h ^ 2 / 2 + h ^ 4 / 24))).
Proof.
  intros right. set (x := 1 - h ^ 2 / 2 + h ^ 4 / 24) in *. set (y := h - h ^ 3 / 6).
  assert (D : damping h = x ^ 2 + y ^ 2) by (unfold damping, x, y; field).
  assert (P : 0 < damping h) by (rewrite D; nra).
  assert (r_pos : 0 < sqrt (damping h)) by (apply sqrt_lt_R0; lra).
  assert (R1 : sqrt (1 + (y / x)²) = sqrt (damping h) / x).
  { rewrite <- (sqrt_square x) at 2 by lra. rewrite <- sqrt_div_alt by nra. f_equal. rewrite D. unfold Rsqr. field.
    lra. }
  set (s := sqrt (damping h)) in *. clearbody s. induction n as [|n IH]; cbn [run].
  - unfold polar. cbn [INR]. rewrite Rmult_0_l, cos_0, sin_0. f_equal; ring.
  - rewrite IH, <- tech_pow_Rmult, S_INR, Rmult_plus_distr_r, Rmult_1_l. unfold polar.
    rewrite cos_plus, sin_plus, cos_atan, sin_atan, R1.
    generalize (s ^ n), (cos (INR n * atan (y / x))), (sin (INR n * atan (y / x))). intros p c d.
    replace (step Tables.rk4 h (p * c, - (p * d))) with (x * (p * c) + y * - (p * d), - y * (p * c) + x * - (p * d))
      by (unfold x, y; by_ring).
    f_equal; field; lra.
Qed.

Lemma rk4_error n x t : INR n = x -> let h := 10 / x in 0 < 1 - h ^ 2 / 2 + h ^ 4 / 24 ->
  distance (run Tables.rk4 (10 / INR n) n (1, 0)) (flow t)
  = sqrt (exp (x * ln (damping h))
          - 2 * exp (x / 2 * ln (damping h))
            * cos (x * atan ((h - h ^ 3 / 6) / (1 - h ^ 2 / 2 + h ^ 4 / 24)) - t) + 1).
Proof.
  intros <-. set (h := 10 / INR n). cbv zeta. intros right. rewrite rk4_polar, flow_polar by assumption.
  unfold distance, polar; cbn [fst snd].
  assert (P : 0 < damping h).
  { replace (damping h) with ((1 - h ^ 2 / 2 + h ^ 4 / 24) ^ 2 + (h - h ^ 3 / 6) ^ 2) by (unfold damping; field). nra. }
  assert (E : sqrt (damping h) ^ n = exp (INR n / 2 * ln (damping h))).
  { rewrite <- Rpower_pow by now apply sqrt_lt_R0. unfold Rpower. f_equal.
    rewrite <- Rpower_sqrt by assumption. unfold Rpower. rewrite ln_exp. field. }
  assert (E2 : exp (INR n * ln (damping h)) = exp (INR n / 2 * ln (damping h)) * exp (INR n / 2 * ln (damping h)))
    by (rewrite <- exp_plus; f_equal; field).
  rewrite E, E2. generalize (exp (INR n / 2 * ln (damping h))). intros r. f_equal.
  rewrite cos_minus. set (a := INR n * _).
  generalize (sin2_cos2 a), (sin2_cos2 t). unfold Rsqr. intros A B.
  replace (r * cos a * cos t) with (r * cos a * cos t) by ring. nra.
Qed.

(** Halving the step divides C h^p by 2^p; RK4's error, halved from 1/32, falls by 16 to within a thousandth. *)
Theorem L191 : (forall C h p, C <> 0 -> 0 < h -> C * h ^ p / (C * (h / 2) ^ p) = 2 ^ p)
  /\ has_order forward_euler 1 /\ has_order rk4 4 /\ 2 ^ 1 = 2 /\ 2 ^ 4 = 16
  /\ let error n := distance (run Tables.rk4 (10 / INR n) n (1, 0)) (flow 10) in
     15.999 * error 640%nat < error 320%nat < 16.001 * error 640%nat.
Proof.
  split; [|split; [exact order_of_forward_euler | split; [exact order_of_rk4 | split; [ring | split; [ring|]]]]].
  - intros C h p other positive. unfold Rdiv. rewrite Rpow_mult_distr, <- Rinv_pow by lra.
    assert (h ^ p <> 0) by (apply pow_nonzero; lra). assert (2 ^ p <> 0) by (apply pow_nonzero; lra). field. auto.
  - assert (coarse : INR 320 = 320) by (rewrite INR_IZR_INZ; reflexivity).
    assert (fine : INR 640 = 640) by (rewrite INR_IZR_INZ; reflexivity).
    cbv beta zeta. rewrite (rk4_error _ _ 10 coarse), (rk4_error _ _ 10 fine) by lra. unfold damping. by_interval.
Qed.

(** How far two rational components are from the exact state at t, added up. *)
Definition missed (z : Q * Q) (t : R) : R := Rabs (Q2R (fst z) - cos t) + Rabs (Q2R (snd z) + sin t).
(** A leading term that vanishes at T = 4: a ratio of 4, not 2. A coarse step: forward Euler's error,
    halved from 5/2, falls by less than 1.19, and it grows from 5/2 to 2. Roundoff: RK4's exact error is divided by 16,
    that of the same runs in binary32 by less than 2. *)
Theorem L192 :
  (let velocity_error h n := Rabs (snd (to_R (run symplectic_euler h n start)) - - sin 4) in
   3.9 * velocity_error (1 # 64)%Q 256%nat < velocity_error (1 # 32)%Q 128%nat)
  /\ error Tables.forward_euler (5#2) 4 10 < 1.19 * error Tables.forward_euler (5#4) 8 10
  /\ error Tables.forward_euler (5#2) 4 10 < error Tables.forward_euler 2 5 10
  /\ (let error n := distance (run Tables.rk4 (10 / INR n) n (1, 0)) (flow 10) in
      15.9 * error 1280%nat < error 640%nat)
  /\ missed (single_rk4 640) 10 <= 2 * missed (single_rk4 1280) 10.
Proof.
  split; [cbv beta zeta; by_interval | split; [unfold error; by_interval | split; [unfold error; by_interval | split]]].
  - assert (coarse : INR 640 = 640) by (rewrite INR_IZR_INZ; reflexivity).
    assert (fine : INR 1280 = 1280) by (rewrite INR_IZR_INZ; reflexivity).
    cbv beta zeta. rewrite (rk4_error _ _ 10 coarse), (rk4_error _ _ 10 fine) by lra. unfold damping. by_interval.
  - rewrite binary32_run_640, binary32_run_1280. unfold missed, Q2R. cbn [fst snd Qnum Qden].
    apply Rlt_le. by_interval.
Qed.

(** y' = 1 from t = 1/3 on and 0 before: by how much RK4 misses y(1) = 2/3 with 2^k steps. *)
Definition jump_error (k : nat) : Q :=
  match Tables.rk4 with
  | RungeKutta A b =>
      let size := (1 # Pos.of_nat (2 ^ k))%Q in
      let stage i p := let t := ((inject_Z (Z.of_nat i) + fold_right Qplus 0 (snd p)) * size)%Q in
                       (if Qle_bool (1 # 3) t then fst p * size else 0)%Q in
      let sum := fold_right (fun x y => Qred (x + y)) 0%Q (flat_map (fun i => map (stage i) (combine b A)) (seq 0 (2
        ^ k))) in
      Qred (Qabs (sum - (2 # 3)))
  | Splitting _ => 0%Q
  end.

(** Of any method, a one-step error O(h^(p+1)) becomes a global error O(h^p). With a rate that jumps RK4's is O(h), at
    these steps h/6; and over a time that grows forward Euler's energy exceeds every bound. *)
Theorem L185 : (forall m p, (1 <= p)%nat -> one_step_error m (p + 1) -> converges m p)
  /\ map jump_error (seq 1 8) = map (fun k => Qred ((1 # 6) * (1 # Pos.of_nat (2 ^ k)))) (seq 1 8)
  /\ forall h B, 0 < h -> exists n, B < energy (run Tables.forward_euler h n (1, 0)).
Proof. split; [exact converges_of_one_step | split; [vm_compute; reflexivity | apply L041]]. Qed.
