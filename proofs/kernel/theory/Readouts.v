(** What is read out of a state, what a printed decimal says, and how a run is enclosed so that [interval] can go on. *)

From Coq Require Import QArith Qreals Qabs Qround Reals Lra Lia.
From Interval Require Export Tactic.
From driftproof Require Import Methods Runs.
Open Scope R_scope.

(** The solution from (1, 0) is (cos t, - sin t). *)
Definition flow (t : R) : state R := (cos t, - sin t).
Definition distance (z w : state R) : R := sqrt ((fst z - fst w) ^ 2 + (snd z - snd w) ^ 2).

(** The angle of (x, y), from -PI up to but not including PI; 0 at the origin, where there is none. *)
Definition angle (y x : R) : R :=
  if Rlt_dec 0 x then atan (y / x)
  else if Rlt_dec x 0 then atan (y / x) + (if Rlt_dec 0 y then PI else - PI)
  else if Rlt_dec 0 y then PI / 2
  else if Rlt_dec y 0 then - (PI / 2) else 0.
(** The angle atan2(-v, q) of z minus that of w, in degrees, wrapped: positive if z is ahead. *)
Definition phase_error (z w : state R) : R :=
  180 / PI * angle (fst z * snd w - snd z * fst w) (fst z * fst w + snd z * snd w).

(** The digits of the decimal d, as they are written, are those of x: they differ by less than half a unit of the last. *)
Definition rounds_to (x d : Q) : Prop := (Qabs (x - d) < 1 # (2 * Qden d))%Q.
Definition real_rounds_to (x : R) (d : Q) : Prop := Rabs (x - Q2R d) < / IZR (2 * Zpos (Qden d)).
Notation "x ≈ d" := (rounds_to x%Q d%Q) (at level 70) : Q_scope.
Notation "x ≈ d" := (real_rounds_to x%R d%Q) (at level 70) : R_scope.

Lemma rounds_to_of_reals x y d : Q2R x = Q2R y -> rounds_to y d -> rounds_to x d.
Proof. intros E. apply eqR_Qeq in E. unfold rounds_to. now rewrite E. Qed.

(** A readout of the exact run has the digits of the same readout of the run computed in integers. *)
Section Computed.
  Variables (m : method) (h : Q) (n : nat) (d : Q).
  Hypothesis common_is_common : is_common m h = true.
  Let z := run m h n start.
  Let w := computed_run m h n.
  Let same : to_R z = to_R w := run_computed m h n common_is_common.

  Lemma fst_computed : rounds_to (fst w) d -> rounds_to (fst z) d.
  Proof. apply rounds_to_of_reals. exact (f_equal fst same). Qed.
  Lemma snd_computed : rounds_to (snd w) d -> rounds_to (snd z) d.
  Proof. apply rounds_to_of_reals. exact (f_equal snd same). Qed.
  Lemma energy_computed : rounds_to (energy w) d -> rounds_to (energy z) d.
  Proof. apply rounds_to_of_reals. now rewrite !Q2R_energy, same. Qed.
  Lemma energy_change_computed e : rounds_to (energy w - e) d -> rounds_to (energy z - e) d.
  Proof. apply rounds_to_of_reals. now rewrite !Q2R_minus, !Q2R_energy, same. Qed.
End Computed.

(** A fact that holds for all states of a box holds for a run that ends in it. *)
Definition ends_in (m : method) (h : Q) (n : nat) (a b c d : Q) : bool :=
  let (q, v) := computed_run m h n in
  is_common m h && Qle_bool a q && Qle_bool q b && Qle_bool c v && Qle_bool v d.

Lemma of_run_in_box (P : state R -> Prop) m h n a b c d :
  ends_in m h n a b c d = true ->
  (forall q v, Q2R a <= q <= Q2R b -> Q2R c <= v <= Q2R d -> P (q, v)) -> P (to_R (run m h n start)).
Proof.
  unfold ends_in. intros ok of_box. destruct (computed_run m h n) as [q v] eqn:E.
  do 4 apply andb_prop in ok as [ok ?].
  rewrite run_computed by assumption. rewrite E.
  apply of_box; cbn [fst snd]; split; apply Qle_Rle, Qle_bool_imp_le; assumption.
Qed.

Definition below (x : Q) : Q := Qfloor (x * inject_Z (10 ^ 40)) # 10 ^ 40.
Definition above (x : Q) : Q := (Qfloor (x * inject_Z (10 ^ 40)) + 1) # 10 ^ 40.

(** Tactics, one for each way to be right. *)
Ltac by_vm := repeat match goal with |- _ /\ _ => split end; vm_compute; reflexivity.
Ltac by_run :=
  match goal with
  | |- rounds_to (fst (run _ _ _ _)) _ => apply fst_computed
  | |- rounds_to (snd (run _ _ _ _)) _ => apply snd_computed
  | |- rounds_to (energy (run _ _ _ _)) _ => apply energy_computed
  | |- rounds_to (energy (run _ _ _ _) - _) _ => apply energy_change_computed
  end; by_vm.
Ltac box_runs :=
  repeat match goal with
  | |- context [to_R (run ?m ?h ?n start)] =>
      let z := eval vm_compute in (computed_run m h n) in
      let a := eval vm_compute in (below (fst z)) in let b := eval vm_compute in (above (fst z)) in
      let c := eval vm_compute in (below (snd z)) in let d := eval vm_compute in (above (snd z)) in
      pattern (to_R (run m h n start)); apply (of_run_in_box _ m h n a b c d); [vm_cast_no_check (eq_refl true)|];
      let q := fresh "q" in let v := fresh "v" in intros q v; unfold Q2R at 1 2 3 4; cbn [Qnum Qden]; intros
  end.
Ltac by_interval :=
  repeat match goal with |- _ /\ _ => split end;
  box_runs; unfold real_rounds_to, distance, flow, energy, start;
  cbn [fst snd add mul lift reals]; unfold Q2R; cbn [Qnum Qden];
  first [interval with (i_prec 120) | apply Rminus_gt_0_lt; interval with (i_prec 120)].
(** The angle of a state to the right of the axis is an arctangent. *)
Ltac by_angle :=
  box_runs; unfold phase_error, flow, angle; cbn [fst snd];
  match goal with |- context [Rlt_dec 0 ?x] =>
    destruct (Rlt_dec 0 x) as [_ | wrong]; [ | exfalso; apply wrong; interval with (i_prec 120) ] end;
  by_interval.
