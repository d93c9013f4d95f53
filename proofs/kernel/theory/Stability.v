(** For which steps the methods stay bounded, and what happens at the boundary and beyond. *)

From Coq Require Import QArith Qreals Reals Lra Lia Psatz.
From driftproof Require Import Runs Tables OneStep Energy.
Open Scope R_scope.

(** Bounded: from no start does the energy of the states leave every bound. *)
Definition bounded (m : method) (h : R) : Prop := forall z, exists B, forall n, energy (run m h n z) <= B.

Theorem L162 : forall h q v : R,
  (let z1 := step symplectic_euler h (q, v) in
   let z2 := step symplectic_euler h z1 in
   fst z2 - (2 - h ^ 2) * fst z1 + q = 0)
  /\ fst (step symplectic_euler h (1, 0)) + snd (step symplectic_euler h (0, 1)) = 2 - h ^ 2
  /\ determinant symplectic_euler h = 1.
Proof. by_ring. Qed.

(** x + iy is a root of the characteristic polynomial only off the real axis and on the unit circle. *)
Theorem L163 : forall h, 0 < h < 2 ->
  ((2 - h ^ 2) ^ 2 - 4 = - (h ^ 2 * (2 - h) * (2 + h)) /\ - (h ^ 2 * (2 - h) * (2 + h)) < 0)
  /\ forall x y : R,
       x ^ 2 - y ^ 2 - (2 - h ^ 2) * x + 1 = 0 -> 2 * x * y - (2 - h ^ 2) * y = 0 -> y <> 0 /\ x ^ 2 + y ^ 2 = 1.
Proof.
  intros h interval.
  assert (D : - (h ^ 2 * (2 - h) * (2 + h)) < 0).
  { assert (0 < h ^ 2 * (2 - h)) by (apply Rmult_lt_0_compat; nra). nra. }
  split; [split; [ring | exact D]|]. intros x y real imaginary.
  assert (y <> 0) by (intros ->; generalize (pow2_ge_0 (2 * x - (2 - h ^ 2))); lra).
  split; [assumption|].
  assert (E : (2 * x - (2 - h ^ 2)) * y = 0) by lra.
  apply Rmult_integral in E as [E|]; [|easy]. replace (2 - h ^ 2) with (2 * x) in real by lra. lra.
Qed.

Theorem L164 :
  (forall l : R, l ^ 2 - (2 - 2 ^ 2) * l + 1 = (l + 1) ^ 2)
  /\ (exists z, step symplectic_euler 2 z <> (- fst z, - snd z))
  /\ forall q v : R,
       let plus_one z := (fst (step symplectic_euler 2 z) + fst z, snd (step symplectic_euler 2 z) + snd z) in
       plus_one (plus_one (q, v)) = (0, 0).
Proof.
  split; [intros; ring | split; [exists (1, 0); expose; injection 1; lra | by_ring]].
Qed.

Theorem L165 : forall n,
  run symplectic_euler 2 n (1, 0) = ((-1) ^ n * (2 * INR n + 1), (-1) ^ n * (2 * INR n))
  /\ forall q : R, run symplectic_euler 2 n (q, q) = ((-1) ^ n * q, (-1) ^ n * q).
Proof.
  induction n as [|n [IH equal]].
  - split; [|intros q]; cbn; f_equal; ring.
  - rewrite S_INR. cbn [run pow]. rewrite IH. split; [|intros q; rewrite equal]; generalize ((-1) ^ n), (INR n);
    by_ring.
Qed.

(** l with l^2 - (2 - h^2) l + 1 = 0: a linear form that one step multiplies by l. *)
Lemma eigenform h l z : l ^ 2 - (2 - h ^ 2) * l + 1 = 0 ->
  let form z := h * fst z + (1 - h ^ 2 - l) * snd z in form (step symplectic_euler h z) = l * form z.
Proof.
  intros root. destruct z as [q v]. cbv zeta.
  apply Rminus_diag_uniq.
  replace (h * fst (step symplectic_euler h (q, v)) + (1 - h ^ 2 - l) * snd (step symplectic_euler h (q, v))
           - l * (h * fst (q, v) + (1 - h ^ 2 - l) * snd (q, v)))
    with ((l ^ 2 - (2 - h ^ 2) * l + 1) * v) by by_ring.
  rewrite root. ring.
Qed.

Theorem L174 : forall h, 2 < h ->
  (-1) ^ 2 - (2 - h ^ 2) * -1 + 1 = (2 - h) * (2 + h) /\ (2 - h) * (2 + h) < 0
  /\ snd (step symplectic_euler h (1, 0)) = - h
  /\ exists l, l ^ 2 - (2 - h ^ 2) * l + 1 = 0 /\ l < -1
     /\ forall B, exists n, B < Rabs (h * fst (run symplectic_euler h n (1, 0))
                                       + (1 - h ^ 2 - l) * snd (run symplectic_euler h n (1, 0))).
Proof.
  intros h large. split; [ring | split; [nra | split; [by_ring|]]].
  set (b := h ^ 2 - 2). assert (2 < b) by (unfold b; nra).
  assert (D : 0 <= b ^ 2 - 4) by nra.
  set (r := sqrt (b ^ 2 - 4)). assert (rr : r * r = b ^ 2 - 4) by (now apply sqrt_sqrt).
  assert (0 <= r) by apply sqrt_pos.
  exists ((- b - r) / 2).
  assert (root : ((- b - r) / 2) ^ 2 - (2 - h ^ 2) * ((- b - r) / 2) + 1 = 0)
    by (replace (2 - h ^ 2) with (- b) by (unfold b; ring); nra).
  split; [exact root | split; [lra|]]. intros B.
  destruct (pow_unbounded ((b + r) / 2) (Rmax B 0 / h)) as [n above]; [lra|].
  exists n.
  assert (form : forall n, let z := run symplectic_euler h n (1, 0) in
    h * fst z + (1 - h ^ 2 - (- b - r) / 2) * snd z = ((- b - r) / 2) ^ n * h).
  { clear n above. intros n. induction n as [|n IH]; cbv zeta in *; cbn [run pow fst snd]; [ring|].
    rewrite (eigenform h _ _ root), IH. ring. }
  rewrite (form n). replace ((- b - r) / 2) with (-1 * ((b + r) / 2)) by field.
  rewrite Rpow_mult_distr, !Rabs_mult, pow_1_abs, Rmult_1_l, Rabs_pos_eq, Rabs_pos_eq;
    [| lra | apply pow_le; lra].
  apply Rmult_lt_compat_r with (r := h) in above; [|lra].
  unfold Rdiv at 1 in above. rewrite Rmult_assoc, Rinv_l, Rmult_1_r in above by lra.
  generalize (Rmax_l B 0). lra.
Qed.

(** Below its limit symplectic Euler stays bounded, and beyond it does not. *)
Lemma symplectic_bounded h : 0 < h < 2 -> bounded symplectic_euler h.
Proof.
  intros inside [q v]. set (I := modified_energy h (q, v)). exists (2 * I / (1 - h ^ 2 / 4)). intros n.
  generalize (modified_energy_of_run h (q, v) n). fold I. destruct (run symplectic_euler h n (q, v)) as [x y].
  intros kept.
  destruct (L055 h x y) as (_ & _ & _ & Q & V & _); [lra|]. rewrite kept in Q, V.
  replace (energy (x, y)) with ((x ^ 2 + y ^ 2) / 2) by by_ring. lra.
Qed.
Lemma symplectic_unbounded h : 2 < h -> ~ bounded symplectic_euler h.
Proof.
  intros large all. destruct (all (1, 0)) as [B within]. destruct (L174 h large) as (_ & _ & _ & l & _ & _ & grows).
  set (c := 1 - h ^ 2 - l) in grows. set (w := h ^ 2 + c ^ 2).
  assert (w0 : 0 < w) by (unfold w; generalize (pow2_ge_0 c); nra).
  destruct (grows (Rabs B + 2 * w + 1)) as [n above]. specialize (within n).
  destruct (run symplectic_euler h n (1, 0)) as [q v]. cbn [fst snd] in above. set (f := h * q + c * v) in above.
  assert (F : f ^ 2 <= 2 * w * energy (q, v)).
  { replace (2 * w * energy (q, v)) with (f ^ 2 + (h * v - c * q) ^ 2) by (unfold f, w; by_ring).
    generalize (pow2_ge_0 (h * v - c * q)). lra. }
  rewrite <- pow2_abs in F. assert (B1 := Rle_abs B). assert (B2 := Rabs_pos B).
  assert (2 * w * energy (q, v) <= 2 * w * Rabs B) by (apply Rmult_le_compat_l; lra). nra.
Qed.

(** RK4's multiplier of the energy. *)
Definition damping (h : R) : R := 1 - h ^ 6 / 72 + h ^ 8 / 576.

Lemma energy_of_rk4 h q v : energy (step rk4 h (q, v)) = damping h * energy (q, v).
Proof. by_ring. Qed.

Theorem L176 : forall h q v : R,
  energy (step rk4 h (q, v)) = (1 - h ^ 6 / 72 + h ^ 8 / 576) * energy (q, v)
  /\ 1 - h ^ 6 / 72 + h ^ 8 / 576 = (1 - h ^ 2 / 2 + h ^ 4 / 24) ^ 2 + (h - h ^ 3 / 6) ^ 2.
Proof. by_ring. Qed.

Lemma two_roots_of_two : 0 < 2 * sqrt 2 /\ (2 * sqrt 2) ^ 2 = 8.
Proof.
  assert (0 < sqrt 2) by (apply sqrt_lt_R0; lra). assert (sqrt 2 * sqrt 2 = 2) by (apply sqrt_sqrt; lra).
  split; [lra|]. replace ((2 * sqrt 2) ^ 2) with (4 * (sqrt 2 * sqrt 2)) by ring. lra.
Qed.

Theorem L177 : forall h, 0 < h < 2 * sqrt 2 ->
  1 - damping h = h ^ 6 * (8 - h ^ 2) / 576 /\ 0 < h ^ 6 * (8 - h ^ 2) / 576
  /\ damping h - 1 / 4 = (h ^ 2 - 6) ^ 2 * (h ^ 4 + 4 * h ^ 2 + 12) / 576 /\ 1 / 4 <= damping h < 1.
Proof.
  intros h inside. destruct two_roots_of_two as [positive eight]. set (s := 2 * sqrt 2) in *.
  assert (A : 1 - damping h = h ^ 6 * (8 - h ^ 2) / 576) by (unfold damping; field).
  assert (B : damping h - 1 / 4 = (h ^ 2 - 6) ^ 2 * (h ^ 4 + 4 * h ^ 2 + 12) / 576) by (unfold damping; field).
  assert (C : 0 < h ^ 6 * (8 - h ^ 2)) by (apply Rmult_lt_0_compat; [apply pow_lt; lra | nra]).
  assert (D : 0 <= (h ^ 2 - 6) ^ 2 * (h ^ 4 + 4 * h ^ 2 + 12)) by (apply Rmult_le_pos;
    [apply pow2_ge_0 | generalize (pow2_ge_0 h), (pow2_ge_0 (h ^ 2)); nra]).
  parts; try assumption; lra.
Qed.

Theorem L178 : forall h, 2 * sqrt 2 < h -> damping h - 1 = h ^ 6 * (h ^ 2 - 8) / 576 /\ 1 < damping h.
Proof.
  intros h large. destruct two_roots_of_two as [positive eight]. set (s := 2 * sqrt 2) in *.
  assert (A : damping h - 1 = h ^ 6 * (h ^ 2 - 8) / 576) by (unfold damping; field).
  assert (0 < h ^ 6 * (h ^ 2 - 8)) by (apply Rmult_lt_0_compat; [apply pow_lt; lra | nra]).
  split; [exact A | lra].
Qed.

Lemma damping_le_one h : 0 <= h -> (damping h <= 1 <-> h <= 2 * sqrt 2).
Proof.
  intros [positive | <-]; [|unfold damping; destruct two_roots_of_two; split; lra].
  split; intros.
  - apply Rnot_lt_le. intros large. apply L178 in large. lra.
  - destruct (Rle_lt_or_eq_dec _ _ H) as [inside | E]; [apply Rlt_le, (L177 h); lra|].
    clear positive H. subst h.
    destruct two_roots_of_two as [_ eight]. unfold damping.
    replace ((2 * sqrt 2) ^ 6) with (((2 * sqrt 2) ^ 2) ^ 3) by ring.
    replace ((2 * sqrt 2) ^ 8) with (((2 * sqrt 2) ^ 2) ^ 4) by ring. rewrite eight. lra.
Qed.

Lemma energy_ge_0 q v : 0 <= energy (q, v).
Proof. expose. generalize (Rle_0_sqr q), (Rle_0_sqr v); unfold Rsqr; lra. Qed.

Lemma damping_ge_0 h : 0 <= damping h.
Proof.
  generalize (energy_of_rk4 h 1 1), (energy_ge_0 (fst (step rk4 h (1, 1))) (snd (step rk4 h (1, 1)))).
  rewrite <- surjective_pairing. intros ->. replace (energy (1, 1)) with 1 by by_ring. lra.
Qed.

Theorem L175 : forall h, 0 <= h -> (bounded rk4 h <-> h <= 2 * sqrt 2).
Proof.
  intros h positive. rewrite <- damping_le_one by assumption.
  assert (E : forall z n, energy (run rk4 h n z) = damping h ^ n * energy z)
    by (intros; apply energy_of_run, energy_of_rk4).
  split.
  - intros all. destruct (all (1, 0)) as [B within]. apply Rnot_lt_le. intros large.
    destruct (pow_unbounded _ (2 * B) large) as [n above]. specialize (within n). rewrite E in within.
    replace (energy (1, 0)) with (1 / 2) in within by by_ring. lra.
  - intros small [q v]. exists (energy (q, v)). intros n. rewrite E.
    generalize (energy_ge_0 q v), (pow_incr (damping h) 1 n (conj (damping_ge_0 h) small)). rewrite pow1. nra.
Qed.

(** No double is 2 sqrt 2: it lies between neighbours.
    At the nearest one the multiplier is above 1, at the one before below. *)
Theorem L179 : damping (2 * sqrt 2) = 1
  /\ let nearest := 6369051672525773 / 2 ^ 51 in let before := 6369051672525772 / 2 ^ 51 in
     1 < damping nearest /\ damping before < 1 /\ before ^ 2 < 8 < nearest ^ 2
     /\ nearest - 2 * sqrt 2 < 2 * sqrt 2 - before.
Proof.
  split.
  - destruct two_roots_of_two as [_ eight]. unfold damping.
    replace ((2 * sqrt 2) ^ 6) with (((2 * sqrt 2) ^ 2) ^ 3) by ring.
    replace ((2 * sqrt 2) ^ 8) with (((2 * sqrt 2) ^ 2) ^ 4) by ring. rewrite eight. lra.
  - cbv zeta. unfold damping. by_interval.
Qed.

Theorem L180 : forall q v : R, let limit := 2 * sqrt 2 in
  step rk4 limit (q, v) = (- (1 / 3) * q - limit / 3 * v, limit / 3 * q - 1 / 3 * v)
  /\ cos (PI + atan limit) = - (1 / 3) /\ sin (PI + atan limit) = - (limit / 3)
  /\ 88.47 < (PI + atan limit - limit) * 180 / PI < 88.48.
Proof.
  intros q v limit. destruct two_roots_of_two as [positive eight]. fold limit in positive, eight.
  assert (three : sqrt (1 + limit * limit) = 3)
    by (replace (1 + limit * limit) with (3 * 3) by lra; apply sqrt_square; lra).
  split; [|split; [|split]].
  - replace (step rk4 limit (q, v))
      with ((1 - limit ^ 2 / 2 + (limit ^ 2) ^ 2 / 24) * q + (limit - limit * limit ^ 2 / 6) * v,
            (- limit + limit * limit ^ 2 / 6) * q + (1 - limit ^ 2 / 2 + (limit ^ 2) ^ 2 / 24) * v)
      by (clear; by_ring).
    rewrite eight. f_equal; field.
  - rewrite Rplus_comm, neg_cos, cos_atan. unfold Rsqr. rewrite three. field.
  - rewrite Rplus_comm, neg_sin, sin_atan. unfold Rsqr. rewrite three. field.
  - unfold limit. by_interval.
Qed.

Theorem L182 : 4 < (5 / 2) ^ 2 < 8 /\ bounded rk4 (5 / 2) /\ ~ bounded symplectic_euler (5 / 2)
  /\ damping (5 / 2) = 38081 / 147456
  /\ forall l, l ^ 2 - (2 - (5 / 2) ^ 2) * l + 1 = 0 <-> l = -4 \/ l = - (1 / 4).
Proof.
  destruct two_roots_of_two as [positive eight].
  split; [lra | split; [apply L175; [lra | nra] |]].
  split; [apply symplectic_unbounded; lra | split; [unfold damping; field|]].
  intros l. split; [intros root | intros [-> | ->]; field].
  assert (-4 - l = 0 \/ -1 / 4 - l = 0) as [E|E] by (apply Rmult_integral; lra); lra.
Qed.

(** With the force -w^2 q the step of size h is that of size w h, with v measured in units of w. *)
Theorem L183 : forall w h q v : R, w <> 0 ->
  let scaled m := let (x, y) := step m (w * h) (q, v / w) in (x, w * y) in
  let with_frequency m := step_with (fun x => - (w ^ 2) * x) m h (q, v) in
  with_frequency forward_euler = scaled forward_euler
  /\ with_frequency symplectic_euler = scaled symplectic_euler /\ with_frequency rk4 = scaled rk4.
Proof. by_ring. Qed.
