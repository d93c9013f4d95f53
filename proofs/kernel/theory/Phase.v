(** Distance and angle: what the state error, the energy and the wrapped phase each see, and what they cannot. *)

From Coq Require Import QArith Qreals Reals Lra Lia Psatz List.
From driftproof Require Import Runs Tables OneStep Energy ExactFlow.
Open Scope R_scope.

(** The state of radius r at the phase angle a: clockwise, as the motion runs. *)
Definition polar (r a : R) : state R := (r * cos a, - (r * sin a)).
Definition degrees (a : R) : R := a * 180 / PI.

Lemma same_angle a b : cos a = cos b -> sin a = sin b -> exists k : Z, a = b + IZR k * (2 * PI).
Proof.
  intros C S. assert (E : sin ((a - b) / 2) = 0).
  { apply Rsqr_0_uniq. unfold Rsqr.
    assert (D : cos (a - b) = 1) by (rewrite cos_minus, C, S; generalize (sin2_cos2 b); unfold Rsqr; lra).
    replace (a - b) with (2 * ((a - b) / 2)) in D by field. rewrite cos_2a_sin in D. lra. }
  destruct (sin_eq_0_0 _ E) as [k K]. exists k. lra.
Qed.

Lemma atan_sides y x : x <> 0 -> let r := sqrt (1 + (y / x) ^ 2) in
  0 < r /\ cos (atan (y / x)) = / r /\ sin (atan (y / x)) = y / x / r.
Proof.
  intros other r. assert (0 < r) by (apply sqrt_lt_R0; generalize (pow2_ge_0 (y / x)); lra).
  unfold r. replace ((y / x) ^ 2) with ((y / x)²) by (unfold Rsqr; ring).
  rewrite cos_atan, sin_atan. split; [|split]; [| unfold Rdiv; ring | reflexivity].
  replace ((y / x)²) with ((y / x) ^ 2) by (unfold Rsqr; ring). assumption.
Qed.

(** The angle is in its range and has the right cosine and sine. *)
Lemma angle_spec y x : (x, y) <> (0, 0) ->
  - PI <= angle y x < PI /\ exists r, 0 < r /\ x = r * cos (angle y x) /\ y = r * sin (angle y x).
Proof.
  intros other. assert (P := PI_RGT_0). unfold angle.
  destruct (Rlt_dec 0 x) as [right|].
  - assert (B := atan_bound (y / x)). destruct (atan_sides y x) as (r_pos & -> & ->); [lra|].
    set (r := sqrt _) in *. split; [lra|]. exists (x * r).
    split; [now apply Rmult_lt_0_compat | split; field; lra].
  - destruct (Rlt_dec x 0) as [left|].
    + assert (B := atan_bound (y / x)). destruct (atan_sides y x) as (r_pos & C & S); [lra|].
      set (r := sqrt _) in *.
      assert (0 < - x * r) by (apply Rmult_lt_0_compat; lra).
      assert (sign : 0 < y -> atan (y / x) < 0).
      { intros up. rewrite <- atan_0. apply atan_increasing. apply Ropp_lt_cancel. rewrite Ropp_0.
        replace (- (y / x)) with (y / - x) by (field; lra). apply Rdiv_lt_0_compat; lra. }
      assert (other_sign : y <= 0 -> 0 <= atan (y / x)).
      { intros down. rewrite <- atan_0. destruct (Req_dec y 0) as [->|]; [unfold Rdiv; rewrite Rmult_0_l; lra|].
        left. apply atan_increasing. replace (y / x) with (- y / - x) by (field; lra). apply Rdiv_lt_0_compat; lra. }
      destruct (Rlt_dec 0 y) as [up|down].
      * specialize (sign up). split; [lra|]. exists (- x * r). rewrite neg_cos, neg_sin, C, S.
        split; [assumption | split; field; lra].
      * assert (O : 0 <= atan (y / x)) by (apply other_sign; lra). split; [lra|]. exists (- x * r).
        replace (atan (y / x) + - PI) with (atan (y / x) - PI) by ring.
        rewrite cos_minus, sin_minus, cos_PI, sin_PI, C, S. split; [assumption | split; field; lra].
    + assert (x = 0) by lra. subst x. destruct (Rlt_dec 0 y) as [up|].
      * split; [lra|]. exists y. rewrite cos_PI2, sin_PI2. split; [assumption | split; ring].
      * destruct (Rlt_dec y 0) as [down|]; [|exfalso; apply other; f_equal; lra].
        split; [lra|]. exists (- y). rewrite cos_neg, sin_neg, cos_PI2, sin_PI2.
        split; [lra | split; ring].
Qed.

Lemma angle_polar r a : 0 < r -> exists k : Z, angle (r * sin a) (r * cos a) = a + IZR k * (2 * PI).
Proof.
  intros r_pos. destruct (angle_spec (r * sin a) (r * cos a)) as (_ & s & s_pos & C & S).
  { injection 1. intros S C. apply Rmult_integral in S as [|S]; [lra|]. apply Rmult_integral in C as [|C]; [lra|].
    generalize (sin2_cos2 a). rewrite S, C. unfold Rsqr. lra. }
  set (b := angle _ _) in *.
  assert (r = s).
  { assert (r * r = s * s).
    { replace (r * r) with ((r * cos a) * (r * cos a) + (r * sin a) * (r * sin a))
        by (generalize (sin2_cos2 a); unfold Rsqr; nra).
      rewrite C, S. generalize (sin2_cos2 b). unfold Rsqr. nra. }
    nra. }
  subst s. apply same_angle; apply Rmult_eq_reg_l with r; lra.
Qed.

(** The phase error of two states in polar form is the difference of their angles, wrapped to [-180, 180). *)
Lemma wrapped r rho a b : 0 < r -> 0 < rho ->
  -180 <= phase_error (polar r a) (polar rho b) < 180
  /\ exists k : Z, phase_error (polar r a) (polar rho b) = degrees (a - b) + IZR k * 360.
Proof.
  intros r_pos rho_pos. assert (P := PI_RGT_0). unfold phase_error, polar, degrees; cbn [fst snd].
  replace (r * cos a * - (rho * sin b) - - (r * sin a) * (rho * cos b)) with (r * rho * sin (a - b))
    by (rewrite sin_minus; ring).
  replace (r * cos a * (rho * cos b) + - (r * sin a) * - (rho * sin b)) with (r * rho * cos (a - b))
    by (rewrite cos_minus; ring).
  assert (positive : 0 < r * rho) by now apply Rmult_lt_0_compat.
  split.
  - destruct (angle_spec (r * rho * sin (a - b)) (r * rho * cos (a - b))) as [[low high] _].
    { injection 1. intros S C. apply Rmult_integral in S as [|S]; [lra|]. apply Rmult_integral in C as [|C]; [lra|].
      generalize (sin2_cos2 (a - b)). rewrite S, C. unfold Rsqr. lra. }
    set (c := angle _ _) in *. replace (180 / PI * c) with (180 * (c / PI)) by (field; lra).
    assert (-1 <= c / PI < 1); [|lra].
    split; [apply Rmult_le_reg_r with PI | apply Rmult_lt_reg_r with PI]; try assumption;
      unfold Rdiv; rewrite Rmult_assoc, Rinv_l; lra.
  - destruct (angle_polar (r * rho) (a - b) positive) as [k ->]. exists k. field. lra.
Qed.

Lemma wrapped_eq r rho a b d : 0 < r -> 0 < rho -> -180 <= d < 180 ->
  (exists k : Z, d = degrees (a - b) + IZR k * 360) -> phase_error (polar r a) (polar rho b) = d.
Proof.
  intros r_pos rho_pos inside [k K]. destruct (wrapped r rho a b r_pos rho_pos) as [range [l L]].
  assert (E : IZR l - IZR k = 0); [|lra].
  rewrite <- minus_IZR. apply f_equal. assert (-1 < l - k < 1)%Z; [|lia].
  split; apply lt_IZR; rewrite minus_IZR; lra.
Qed.

Lemma flow_polar t : flow t = polar 1 t.
Proof. unfold flow, polar. f_equal; ring. Qed.

Theorem L134 : forall z w, 0 <= distance z w /\ distance z w ^ 2 = (fst z - fst w) ^ 2 + (snd z - snd w) ^ 2.
Proof.
  intros z w. split; [apply sqrt_pos|]. unfold distance. rewrite <- Rsqr_pow2. apply Rsqr_sqrt.
  generalize (pow2_ge_0 (fst z - fst w)), (pow2_ge_0 (snd z - snd w)). lra.
Qed.

Theorem L152 : forall r a, energy (polar r a) = r ^ 2 / 2.
Proof. intros. unfold polar. generalize (sin2_cos2 a). unfold Rsqr. expose. intros C. nra. Qed.

Theorem L108 : forall r rho a b, 0 < r -> 0 < rho ->
  (r = rho <-> energy (polar r a) = energy (polar rho b))
  /\ exists k : Z, phase_error (polar r a) (polar rho b) = degrees (a - b) + IZR k * 360.
Proof. intros. split; [rewrite !L152; split; intros; [subst; reflexivity | nra] | now apply wrapped]. Qed.

(** None of the angles that differ by whole turns is shorter; 45 degrees ahead is +45; of -180 and 180 it is -180. Every
    state off the origin has a radius and an angle. *)
Theorem L135 : (forall z, z <> (0, 0) -> exists r a, 0 < r /\ z = polar r a) /\ forall r rho a b, 0 < r -> 0 < rho ->
  let e := phase_error (polar r a) (polar rho b) in
  -180 <= e < 180 /\ (exists k : Z, e = degrees (a - b) + IZR k * 360)
  /\ (forall k : Z, Rabs e <= Rabs (e + IZR k * 360))
  /\ phase_error (1, -1) (1, 0) = 45 /\ phase_error (-1, 0) (1, 0) = -180.
Proof.
  split.
  { intros [q v] other. destruct (angle_spec (- v) q) as (_ & r & pos & Q & V).
    - injection 1; intros V Q. apply other. f_equal; lra.
    - exists r, (angle (- v) q). split; [exact pos|]. unfold polar. f_equal; lra. }
  intros r rho a b r_pos rho_pos e. destruct (wrapped r rho a b r_pos rho_pos) as [range turns].
  fold e in range, turns. assert (P := PI_RGT_0).
  split; [exact range | split; [exact turns | split; [|split]]].
  - intros k. destruct (Z.eq_dec k 0) as [-> | other]; [rewrite Rmult_0_l, Rplus_0_r; lra|].
    assert (IZR k <= -1 \/ 1 <= IZR k) as [E|E]
      by (destruct (Z_lt_le_dec k 0); [left | right]; apply IZR_le; lia); unfold Rabs; repeat destruct Rcase_abs; lra.
  - unfold phase_error, angle; cbn [fst snd]. destruct Rlt_dec; [|lra].
    replace ((1 * 0 - -1 * 1) / (1 * 1 + -1 * 0)) with 1 by field. rewrite atan_1. field. lra.
  - unfold phase_error, angle; cbn [fst snd]. destruct Rlt_dec; [lra|]. destruct Rlt_dec; [|lra].
    destruct Rlt_dec; [lra|]. replace ((-1 * 0 - 0 * 1) / (-1 * 1 + 0 * 0)) with 0 by field. rewrite atan_0. field. lra.
Qed.

(** Turned by a, forwards if a > 0. *)
Theorem L153 : forall r t a, 0 < r ->
  energy (polar r (t + a)) = energy (polar r t)
  /\ exists k : Z, phase_error (polar r (t + a)) (polar r t) = degrees a + IZR k * 360.
Proof.
  intros r t a pos. rewrite !L152. split; [reflexivity|].
  destruct (wrapped r r (t + a) t pos pos) as [_ [k K]]. exists k. now replace (t + a - t) with a in K by ring.
Qed.

Theorem L154 : forall q v : R,
  energy (- q, - v) = energy (q, v) /\ distance (q, v) (- q, - v) = 2 * sqrt (q ^ 2 + v ^ 2).
Proof.
  intros q v. split; [by_ring|]. unfold distance; cbn [fst snd].
  replace ((q - - q) ^ 2 + (v - - v) ^ 2) with (2 * 2 * (q ^ 2 + v ^ 2)) by ring.
  rewrite sqrt_mult_alt, sqrt_square by lra. reflexivity.
Qed.

Theorem L155 : (energy (1, 0) == 1 / 2 /\ energy (0, -1) == 1 / 2)%Q.
Proof. by_vm. Qed.

Definition phase_angle (z : state R) : R := angle (- snd z) (fst z).

Theorem L156 : phase_angle (1, 0) = 0 /\ phase_angle (0, -1) = PI / 2 /\ PI / 2 = 2 * PI / 4.
Proof.
  unfold phase_angle, angle; cbn [fst snd]. split; [|split; [|field]].
  - destruct Rlt_dec; [|lra]. replace (- 0 / 1) with 0 by field. apply atan_0.
  - destruct Rlt_dec; [lra|]. destruct Rlt_dec; [lra|]. destruct Rlt_dec; lra.
Qed.

Theorem L157 : phase_angle (flow 0) = 0 /\ forall t, exists k : Z, phase_angle (flow t) = t + IZR k * (2 * PI).
Proof.
  split.
  - rewrite (proj1 L018). apply L156.
  - intros t. unfold phase_angle. rewrite flow_polar. unfold polar; cbn [fst snd].
    rewrite Ropp_involutive. apply angle_polar. lra.
Qed.

(** A later state is ahead, by as many degrees as it is later. *)
Theorem L160 : forall t s, 0 < s < PI ->
  phase_error (flow (t + s)) (flow t) = degrees s /\ 0 < degrees s
  /\ phase_error (flow t) (flow (t + s)) = - degrees s.
Proof.
  intros t s inside. assert (P := PI_RGT_0). rewrite !flow_polar. unfold degrees.
  assert (0 < s * 180 / PI < 180).
  { replace (s * 180 / PI) with (180 * (s / PI)) by (field; lra).
    assert (0 < s / PI < 1); [|lra]. split; [apply Rdiv_lt_0_compat; lra|].
    apply Rmult_lt_reg_r with PI; [lra|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra. }
  split; [|split; [lra|]]; apply wrapped_eq; try lra; exists 0%Z; unfold degrees; field; lra.
Qed.

Theorem L136_L161 : forall (k : Z) t w,
  flow (t + IZR k * (2 * PI)) = flow t /\ phase_error (flow (t + IZR k * (2 * PI))) w = phase_error (flow t) w
  /\ flow (t + PI) <> flow t.
Proof.
  assert (turns : forall k t, flow (t + IZR k * (2 * PI)) = flow t).
  { intros k t. unfold flow. rewrite cos_plus, sin_plus.
    replace (IZR k * (2 * PI)) with (2 * (IZR k * PI)) by ring. rewrite cos_2a_sin, sin_2a.
    assert (Z0 : sin (IZR k * PI) = 0) by (apply sin_eq_0_1; now exists k). rewrite Z0. f_equal; ring. }
  intros k t w. rewrite turns. split; [reflexivity | split; [reflexivity|]].
  unfold flow. rewrite neg_cos, neg_sin. injection 1. intros. generalize (sin2_cos2 t). unfold Rsqr.
  assert (cos t = 0) by lra. assert (sin t = 0) by lra. nra.
Qed.

(** Forward Euler multiplies the radius by sqrt (1 + h^2) and turns by atan h. *)
Lemma forward_euler_polar h n : run forward_euler h n (1, 0) = polar (sqrt (1 + h ^ 2) ^ n) (INR n * atan h).
Proof.
  assert (0 < sqrt (1 + h ^ 2)) by (apply sqrt_lt_R0; generalize (pow2_ge_0 h); lra).
  assert (E : sqrt (1 + h²) = sqrt (1 + h ^ 2)) by (f_equal; unfold Rsqr; ring).
  set (s := sqrt (1 + h ^ 2)) in *. clearbody s. induction n as [|n IH]; cbn [run].
  - unfold polar. cbn [INR]. rewrite Rmult_0_l, cos_0, sin_0. f_equal; ring.
  - rewrite IH, <- tech_pow_Rmult, S_INR, Rmult_plus_distr_r, Rmult_1_l. unfold polar.
    rewrite cos_plus, sin_plus, cos_atan, sin_atan, E.
    generalize (s ^ n), (cos (INR n * atan h)), (sin (INR n * atan h)). by_ring.
Qed.

Theorem L158 : phase_error (run forward_euler (1 / 4) 40 (1, 0)) (flow 10) = degrees (40 * atan (1 / 4) - 10).
Proof.
  rewrite forward_euler_polar, flow_polar. replace (INR 40) with 40 by (cbn; ring).
  apply wrapped_eq; [apply pow_lt, sqrt_lt_R0; lra | lra | unfold degrees; split; by_interval |].
  exists 0%Z. ring.
Qed.

(** Any two states; and at h = 5/2 the run lags by more than half a turn: what is read out is a lead. *)
Theorem L159 :
  (forall r rho a b, 0 < r -> 0 < rho -> forall k : Z,
     Rabs (phase_error (polar r a) (polar rho b)) <= Rabs (degrees (a - b) + IZR k * 360))
  /\ let unwrapped := degrees (4 * atan (5 / 2) - 10) in
     unwrapped < -180 /\ phase_error (run forward_euler (5 / 2) 4 (1, 0)) (flow 10) = unwrapped + 360
     /\ 0 < unwrapped + 360 < 180.
Proof.
  split.
  { intros r rho a b r_pos rho_pos k. destruct (proj2 L135 r rho a b r_pos rho_pos) as (_ & [j E] & shortest & _).
    replace (degrees (a - b) + IZR k * 360) with (phase_error (polar r a) (polar rho b) + IZR (k - j) * 360)
      by (rewrite minus_IZR; lra).
    apply shortest. }
  cbv zeta. split; [unfold degrees; by_interval | split; [|unfold degrees; by_interval]].
  rewrite forward_euler_polar, flow_polar. replace (INR 4) with 4 by (cbn; ring).
  apply wrapped_eq; [apply pow_lt, sqrt_lt_R0; lra | lra | unfold degrees; split; by_interval |].
  exists 1%Z. ring.
Qed.

Theorem L240_L245 : forall r a b,
  energy (polar r a) = energy (polar r b)
  /\ distance (polar r a) (polar r b) ^ 2 = 4 * r ^ 2 * sin ((a - b) / 2) ^ 2
  /\ forall z, distance z (0, 0) = sqrt (2 * energy z).
Proof.
  intros r a b. rewrite !L152. split; [reflexivity|]. split; [|intros [x y]; unfold distance; f_equal; by_ring].
  rewrite (proj2 (L134 _ _)). unfold polar; cbn [fst snd].
  assert (C : cos (a - b) = 1 - 2 * sin ((a - b) / 2) * sin ((a - b) / 2))
    by (rewrite <- cos_2a_sin; f_equal; field).
  rewrite cos_minus in C. generalize (sin2_cos2 a), (sin2_cos2 b). unfold Rsqr. nra.
Qed.

Theorem L246 : (energy (0, -1) == energy (1, 0) /\ energy (1, 0) == 1 / 2)%Q.
Proof. by_vm. Qed.

Theorem L247 : distance (0, -1) (1, 0) = sqrt 2.
Proof. unfold distance; cbn [fst snd]. f_equal. ring. Qed.

(** Pairs of states that agree in one of the errors and in no other; two runs of one cost; and, for the cost, a method
    that asks for a force in vain. *)
Definition wasteful_euler := RungeKutta (nil :: nil :: nil) (1 :: 0 :: nil)%Q.

Theorem L007 :
  let errors z := (distance z (1, 0), energy z - 1 / 2, phase_error z (1, 0)) in
  (fst (fst (errors (2, 0))) = fst (fst (errors (1, 1)))
   /\ snd (fst (errors (2, 0))) <> snd (fst (errors (1, 1))) /\ snd (errors (2, 0)) <> snd (errors (1, 1)))
  /\ (snd (fst (errors (0, -1))) = snd (fst (errors (1, 0)))
      /\ fst (fst (errors (0, -1))) <> fst (fst (errors (1, 0))) /\ snd (errors (0, -1)) <> snd (errors (1, 0)))
  /\ (snd (errors (2, 0)) = snd (errors (3, 0))
      /\ fst (fst (errors (2, 0))) <> fst (fst (errors (3, 0)))
      /\ snd (fst (errors (2, 0))) <> snd (fst (errors (3, 0))))
  /\ (100 * evaluations forward_euler = 25 * evaluations rk4)%nat
  /\ (distance (to_R (run rk4 (2#5) 25 start)) (flow 10)
      < distance (to_R (run forward_euler (1#10) 100 start)) (flow 10)
      /\ energy (to_R (run rk4 (2#5) 25 start)) < energy (to_R (run forward_euler (1#10) 100 start))
      /\ phase_error (to_R (run forward_euler (1#10) 100 start)) (flow 10) < -1
      /\ -1 < phase_error (to_R (run rk4 (2#5) 25 start)) (flow 10))
  /\ (forall h q v : R, step wasteful_euler h (q, v) = step forward_euler h (q, v))
  /\ evaluations wasteful_euler = (2 * evaluations forward_euler)%nat.
Proof.
  assert (P := PI_RGT_0). cbv zeta. cbn [fst snd].
  assert (ahead : forall x y, 0 < x -> phase_error (x, y) (1, 0) = 180 / PI * atan (- y / x)).
  { intros x y right. unfold phase_error, angle; cbn [fst snd].
    replace (x * 1 + y * 0) with x by ring. replace (x * 0 - y * 1) with (- y) by ring.
    destruct Rlt_dec; [reflexivity | lra]. }
  assert (level : forall x, 0 < x -> phase_error (x, 0) (1, 0) = 0).
  { intros x right. rewrite ahead, Ropp_0 by lra. unfold Rdiv at 2. rewrite Rmult_0_l, atan_0. ring. }
  assert (eighth : phase_error (1, 1) (1, 0) < 0) by (rewrite ahead by lra; interval).
  assert (quarter : phase_error (0, -1) (1, 0) = 90).
  { unfold phase_error, angle; cbn [fst snd].
    destruct Rlt_dec; [lra|]. destruct Rlt_dec; [lra|]. destruct Rlt_dec; [field; lra | lra]. }
  rewrite quarter, !level by lra. unfold distance; cbn [fst snd].
  replace ((2 - 1) ^ 2 + (0 - 0) ^ 2) with 1 by ring. replace ((1 - 1) ^ 2 + (1 - 0) ^ 2) with 1 by ring.
  replace ((0 - 1) ^ 2 + (-1 - 0) ^ 2) with 2 by ring. replace ((1 - 1) ^ 2 + (0 - 0) ^ 2) with 0 by ring.
  replace ((3 - 1) ^ 2 + (0 - 0) ^ 2) with (2 * 2) by ring. rewrite sqrt_1, sqrt_0, sqrt_square by lra.
  assert (0 < sqrt 2) by (apply sqrt_lt_R0; lra).
  parts; lazymatch goal with
  | |- forall h q v : R, _ => by_ring
  | |- context [evaluations] => reflexivity
  | |- context [phase_error] => by_angle
  | |- context [run] => by_interval
  | |- context [energy] => expose; lra
  | |- _ => lra
  end.
Qed.
