(** The oscillator, its exact solution, its energy, and where its units come from. *)

From Coq Require Import QArith Qreals Reals Lra Lia List.
From driftproof Require Import Runs Tables OneStep.
Open Scope R_scope.

(** q and v move as the oscillator does. *)
Definition solves (q v : R -> R) : Prop := forall t, is_derive q t (v t) /\ is_derive v t (- q t).

Theorem L016 : List.Forall (fun s => initial s = (1, 0)%Q) scenes.
Proof. repeat constructor. Qed.

(** All scenes run the same three methods from one start to one end; to first order in h each step is z + h J z. *)
Theorem L097 :
  List.Forall (fun s => methods s = (forward_euler :: symplectic_euler :: rk4 :: nil)%list
                        /\ initial s = (1, 0)%Q /\ duration s = 10%Q) scenes
  /\ forall q v : R, List.Forall (fun m => is_derive (fun h => fst (step m h (q, v))) 0 v
                                          /\ is_derive (fun h => snd (step m h (q, v))) 0 (- q))
                        (forward_euler :: symplectic_euler :: rk4 :: nil).
Proof.
  split; [repeat constructor|]. intros q v.
  repeat (apply Forall_cons || apply Forall_nil); split; expose; auto_derive; trivial; real_field.
Qed.

Theorem L094 :
  List.Forall (fun s => initial s = (1, 0)%Q /\ (size s * (Z.of_nat (steps s) # 1) == 10)%Q) scenes
  /\ forall n, (3 * n <> 10)%Z.
Proof. split; [repeat constructor | intros; lia]. Qed.

Theorem L017 :
  (forall q v, solves q v -> forall t, Derive q t = v t /\ is_derive (Derive q) t (- q t))
  /\ forall q, (forall t, ex_derive q t /\ is_derive (Derive q) t (- q t)) -> solves q (Derive q).
Proof.
  split.
  - intros q v both. assert (D : forall t, Derive q t = v t) by (intros; apply is_derive_unique, both).
    intros t. split; [apply D|]. apply (is_derive_ext v); [now intros; rewrite D | apply both].
  - intros q both t. split; [apply Derive_correct, both | apply both].
Qed.

(** There is no other: turned back by t, what solves the equations and starts there stays where it is. *)
Theorem L018 : flow 0 = (1, 0) /\ solves (fun t => fst (flow t)) (fun t => snd (flow t))
  /\ forall q v, solves q v -> (q 0, v 0) = (1, 0) -> forall t, (q t, v t) = flow t.
Proof.
  split; [unfold flow; rewrite cos_0, sin_0; f_equal; ring|]. split.
  { intros t. split; unfold flow; cbn [fst snd]; auto_derive; trivial; real_field. }
  intros q v both start t. injection start; intros v0 q0.
  assert (same : forall f, (forall s, is_derive f s 0) -> f t = f 0).
  { intros f D. destruct (MVT_gen f 0 t (fun _ => 0)) as (c & _ & E); [auto | |lra].
    intros x _. apply derivable_continuous_pt. exists 0. apply is_derive_Reals, D. }
  assert (Dq : forall s, ex_derive q s /\ Derive (fun x => q x) s = v s)
    by (intros s; split; [exists (v s) | apply is_derive_unique]; exact (proj1 (both s))).
  assert (Dv : forall s, ex_derive v s /\ Derive (fun x => v x) s = - q s)
    by (intros s; split; [exists (- q s) | apply is_derive_unique]; exact (proj2 (both s))).
  assert (C : q t * cos t - v t * sin t = 1).
  { rewrite <- q0, <- (Rmult_1_r (q 0)), <- cos_0. replace (q 0 * cos 0) with (q 0 * cos 0 - v 0 * sin 0)
      by (rewrite sin_0; ring).
    apply (same (fun s => q s * cos s - v s * sin s)). intros s. destruct (Dq s) as [? E], (Dv s) as [? F].
    auto_derive; [easy|]. rewrite E, F. real_field. }
  assert (S : v t * cos t + q t * sin t = 0).
  { rewrite <- v0. replace (v 0) with (v 0 * cos 0 + q 0 * sin 0) by (rewrite cos_0, sin_0; ring).
    apply (same (fun s => v s * cos s + q s * sin s)). intros s. destruct (Dq s) as [? E], (Dv s) as [? F].
    auto_derive; [easy|]. rewrite E, F. real_field. }
  assert (U := sin2_cos2 t). unfold Rsqr in U. unfold flow. f_equal.
  - transitivity (q t * (sin t * sin t + cos t * cos t)); [rewrite U; ring|].
    transitivity (cos t * (q t * cos t - v t * sin t) + sin t * (v t * cos t + q t * sin t)); [ring|].
    rewrite C, S. ring.
  - transitivity (v t * (sin t * sin t + cos t * cos t)); [rewrite U; ring|].
    transitivity (cos t * (v t * cos t + q t * sin t) - sin t * (q t * cos t - v t * sin t)); [ring|].
    rewrite C, S. ring.
Qed.

Theorem L019 : forall t, is_derive cos t (- sin t) /\ is_derive (fun s => - sin s) t (- cos t).
Proof. intros t. split; auto_derive; trivial; real_field. Qed.

(** From (1, 0), with radius 1, and the rate q v' - v q' at which the area is swept, counterclockwise, is -1. *)
Theorem L020_L106 : flow 0 = (1, 0) /\ forall t,
  fst (flow t) ^ 2 + snd (flow t) ^ 2 = 1
  /\ fst (flow t) * Derive (fun s => snd (flow s)) t - snd (flow t) * Derive (fun s => fst (flow s)) t = -1.
Proof.
  split; [apply L018|]. intros t. assert (C := sin2_cos2 t). unfold Rsqr in C. unfold flow; cbn [fst snd].
  assert (DC : Derive (fun s => cos s) t = - sin t) by (apply is_derive_unique, L019).
  assert (DS : Derive (fun s => - sin s) t = - cos t) by (apply is_derive_unique, L019).
  rewrite DC, DS. lra.
Qed.

Theorem L021 : forall q v : R,
  is_derive (fun y => energy (q, y)) v (fst (rate oscillator (q, v)))
  /\ is_derive (fun x => - energy (x, v)) q (snd (rate oscillator (q, v))).
Proof. intros. split; expose; auto_derive; trivial; real_field. Qed.

Lemma energy_rate q v t dv :
  is_derive q t (v t) -> is_derive v t dv -> is_derive (fun s => energy (q s, v s)) t (v t * (q t + dv)).
Proof.
  intros Dq Dv. expose.
  assert (ex_derive q t) by (now exists (v t)). assert (ex_derive v t) by (now exists dv).
  auto_derive; [easy|].
  replace (Derive (fun s => q s) t) with (v t) by (symmetry; now apply is_derive_unique).
  replace (Derive (fun s => v s) t) with dv by (symmetry; now apply is_derive_unique).
  real_field.
Qed.

Theorem L022 : forall q v, solves q v -> forall t,
  is_derive (fun s => energy (q s, v s)) t (q t * v t - v t * q t) /\ q t * v t - v t * q t = 0.
Proof.
  intros q v both t. split; [|ring]. replace (q t * v t - v t * q t) with (v t * (q t + - q t)) by ring.
  now apply energy_rate; apply both.
Qed.

(** With a force f from outside the energy changes at the rate v f, with damping -v at the rate -v^2. *)
Theorem L009 : forall q v t, is_derive q t (v t) ->
  (is_derive v t (- q t) -> is_derive (fun s => energy (q s, v s)) t 0)
  /\ (forall f, is_derive v t (- q t + f) -> is_derive (fun s => energy (q s, v s)) t (v t * f))
  /\ (is_derive v t (- q t - v t) -> is_derive (fun s => energy (q s, v s)) t (- (v t) ^ 2)).
Proof.
  intros q v t Dq. split; [|split]; intros.
  - replace 0 with (v t * (q t + - q t)) by ring. now apply energy_rate.
  - replace (v t * f) with (v t * (q t + (- q t + f))) by ring. now apply energy_rate.
  - replace (- v t ^ 2) with (v t * (q t + (- q t - v t))) by ring. now apply energy_rate.
Qed.

Theorem L014 :
  let error m := distance (to_R (run m (1#4) 40 start)) (flow 10) in
  0 < error rk4 /\ error rk4 < error symplectic_euler /\ error symplectic_euler < error forward_euler.
Proof. cbv zeta. by_interval. Qed.

(** Half-way between (1, 0) and the state after h the chord is cos (h/2) times the arc. *)
Theorem L104 : forall h,
  (1 + fst (flow h)) / 2 = cos (h / 2) * fst (flow (h / 2))
  /\ (0 + snd (flow h)) / 2 = cos (h / 2) * snd (flow (h / 2))
  /\ (0 < h < PI -> 0 < cos (h / 2) < 1) /\ cos (1 / 8) < 1.
Proof.
  intros h. assert (C := sin2_cos2 (h / 2)). unfold Rsqr in C. unfold flow; cbn [fst snd].
  assert (A : cos h = 2 * cos (h / 2) * cos (h / 2) - 1) by (rewrite <- cos_2a_cos; f_equal; field).
  assert (B : sin h = 2 * sin (h / 2) * cos (h / 2)) by (rewrite <- sin_2a; f_equal; field).
  rewrite A, B. split; [field | split; [field | split; [intros inside; split|]]].
  - apply cos_gt_0; lra.
  - rewrite <- cos_0. apply cos_decreasing_1; lra.
  - by_interval.
Qed.

(** A spring of mass m and stiffness k with length L: omega = sqrt (k/m), q = x/L, v = x'/(L omega). *)
Section Spring.
  Variables m k L : R.
  Hypotheses (m_pos : 0 < m) (k_pos : 0 < k) (L_pos : 0 < L).
  Definition frequency (m k : R) : R := sqrt (k / m).
  Definition scaled (m k L x velocity : R) : R * R := (x / L, velocity / (L * frequency m k)).

  Lemma frequency_pos : 0 < frequency m k.
  Proof. apply sqrt_lt_R0, Rdiv_lt_0_compat; assumption. Qed.

  Lemma frequency_squared : frequency m k * frequency m k = k / m.
  Proof. apply sqrt_sqrt, Rlt_le, Rdiv_lt_0_compat; assumption. Qed.
End Spring.

Theorem L024 : forall m k L (x dx : R -> R), 0 < m -> 0 < k -> 0 < L ->
  (forall tau, is_derive x tau (dx tau) /\ is_derive dx tau (- k * x tau / m)) ->
  let at_time t := let tau := t / frequency m k in scaled m k L (x tau) (dx tau) in
  solves (fun t => fst (at_time t)) (fun t => snd (at_time t)).
Proof.
  intros m k L x dx m_pos k_pos L_pos newton at_time t.
  assert (P := frequency_pos m k m_pos k_pos). assert (S := frequency_squared m k m_pos k_pos).
  unfold at_time, scaled; cbn [fst snd]. set (w := frequency m k) in *.
  destruct (newton (t / w)) as [Dx Ddx].
  assert (ex_derive x (t / w)) by (eexists; exact Dx). assert (ex_derive dx (t / w)) by (eexists; exact Ddx).
  split; auto_derive; trivial.
  - replace (Derive (fun x0 => x x0) (t * / w)) with (dx (t / w)) by (symmetry; now apply is_derive_unique).
    change (@eq R (1 * / w * dx (t / w) * / L) (dx (t / w) / (L * w))). field. lra.
  - replace (Derive (fun x0 => dx x0) (t * / w)) with (- k * x (t / w) / m) by (symmetry; now apply is_derive_unique).
    replace (- k * x (t / w) / m) with (- (w * w) * x (t / w)) by (rewrite S; field; lra).
    real_field. lra.
Qed.

Theorem L025 : forall m k L x velocity kg metre second, 0 < m -> 0 < k -> 0 < L -> 0 < kg -> 0 < metre -> 0 < second ->
  scaled (m * kg) (k * kg / second ^ 2) (L * metre) (x * metre) (velocity * metre / second) = scaled m k L x velocity.
Proof.
  intros. unfold scaled, frequency.
  replace (k * kg / second ^ 2 / (m * kg)) with (k / m / (second * second)) by (field; lra).
  rewrite sqrt_div_alt, sqrt_square by nra.
  assert (0 < sqrt (k / m)) by (apply sqrt_lt_R0, Rdiv_lt_0_compat; assumption).
  f_equal; field; lra.
Qed.

Theorem L026 : forall m k L x velocity, 0 < m -> 0 < k -> 0 < L ->
  m * velocity ^ 2 / 2 + k * x ^ 2 / 2 = k * L ^ 2 * energy (scaled m k L x velocity).
Proof.
  intros m k L x velocity m_pos k_pos L_pos.
  assert (P := frequency_pos m k m_pos k_pos). assert (S := frequency_squared m k m_pos k_pos).
  unfold scaled. set (w := frequency m k) in *. clearbody w.
  replace (k * L ^ 2 * energy (x / L, velocity / (L * w))) with (k / (w * w) * velocity ^ 2 / 2 + k * x ^ 2 / 2)
    by (expose; field; lra).
  rewrite S. field; lra.
Qed.

Theorem L027 : forall m k h, 0 < m -> 0 < k ->
  frequency m k * (h / frequency m k) = h /\ h / frequency m k = h * sqrt (m / k).
Proof.
  intros m k h m_pos k_pos. assert (P := frequency_pos m k m_pos k_pos). split; [field; lra|].
  unfold frequency in *. replace (m / k) with (/ (k / m)) by (field; lra).
  rewrite <- inv_sqrt by (apply Rdiv_lt_0_compat; assumption). reflexivity.
Qed.
