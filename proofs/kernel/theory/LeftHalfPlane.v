(** A-stability: a step for y' = z y increases no |y| where Re z <= 0. And such a step, as a quotient of polynomials. *)

From Coq Require Import ZArith QArith Reals Lra Lia List Bool.
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

(** How the stages are eliminated: Q y1 = P y0 with polynomials P and Q in z over a number field. *)
Section Elimination.
  Context {K : ring}.
  (** Polynomials with coefficients in K, at a complex number, and lists of them. *)
  Fixpoint at_complex (p : list K) (z : C) : C :=
    match p with [] => RtoC 0 | c :: p => (RtoC (value K c) + z * at_complex p z)%C end.
  Fixpoint add1 (p q : list K) : list K :=
    match p, q with c :: p, d :: q => plus K c d :: add1 p q | [], q => q | p, [] => p end.
  Definition scaled1 (c : K) : list K -> list K := map (mult K c).
  Definition shifted1 (p : list K) : list K := of_Z K 0 :: p.
  Definition same1 (p q : list K) : bool := forallb (same K (of_Z K 0)) (add1 p (scaled1 (of_Z K (-1)) q)).
  (** sum of row_j p_j; sum of p_i row_i, entry by entry. *)
  Fixpoint weighted_K (row : list K) (ps : list (list K)) : list K :=
    match row, ps with a :: row, p :: ps => add1 (scaled1 a p) (weighted_K row ps) | _, _ => [] end.
  Fixpoint add_rows (x y : list (list K)) : list (list K) :=
    match x, y with p :: x, q :: y => add1 p q :: add_rows x y | [], y => y | x, [] => x end.
  Fixpoint through_K (ps : list (list K)) (A : list (list K)) : list (list K) :=
    match ps, A with p :: ps, row :: A => add_rows (map (fun a => scaled1 a p) row) (through_K ps A) | _, _ => [] end.

  Lemma at_add p : forall q z, at_complex (add1 p q) z = (at_complex p z + at_complex q z)%C.
  Proof. induction p as [|c p IH]; intros [|d q] z; cbn; rewrite ?value_plus, ?RtoC_plus, ?IH; ring. Qed.
  Lemma at_scaled c p z : at_complex (scaled1 c p) z = (RtoC (value K c) * at_complex p z)%C.
  Proof.
    induction p as [|d p IH]; cbn [scaled1 map at_complex]; [ring|].
    rewrite value_mult, RtoC_mult. fold (scaled1 c p). rewrite IH. ring.
  Qed.
  Lemma at_shifted p z : at_complex (shifted1 p) z = (z * at_complex p z)%C.
  Proof. cbn. rewrite value_of_Z. ring. Qed.
  Lemma at_same p q z : same1 p q = true -> at_complex p z = at_complex q z.
  Proof.
    unfold same1. intros E. assert (at_complex (add1 p (scaled1 (of_Z K (-1)) q)) z = RtoC 0) as Z.
    { induction (add1 p _) as [|c r IH]; [reflexivity|]. cbn [forallb at_complex] in *. apply andb_prop in E as [E E'].
      apply value_same in E. rewrite <- E, value_of_Z, IH by exact E'. ring. }
    rewrite at_add, at_scaled, value_of_Z in Z. replace (RtoC (-1)) with (- RtoC 1)%C in Z
      by (rewrite <- RtoC_opp; f_equal; lra).
    replace (at_complex q z) with (at_complex q z + RtoC 0)%C by ring. rewrite <- Z. ring.
  Qed.
  Lemma at_weighted row : forall ps z,
    at_complex (weighted_K row ps) z = weighted (map (value K) row) (map (fun p => at_complex p z) ps).
  Proof. induction row as [|a row IH]; intros [|p ps] z; cbn; trivial. now rewrite at_add, at_scaled, IH. Qed.

  Fixpoint dot_C (x y : list C) : C :=
    match x, y with a :: x, c :: y => (a * c + dot_C x y)%C | _, _ => RtoC 0 end.
  Lemma dot_add_rows x : forall y Y z,
    dot_C (map (fun p => at_complex p z) (add_rows x y)) Y
    = (dot_C (map (fun p => at_complex p z) x) Y + dot_C (map (fun p => at_complex p z) y) Y)%C.
  Proof. induction x as [|p x IH]; intros [|q y] [|c Y] z; cbn; rewrite ?at_add, ?IH; ring. Qed.
  Lemma dot_scaled_row p row : forall Y z,
    dot_C (map (fun p => at_complex p z) (map (fun a => scaled1 a p) row)) Y
    = (at_complex p z * weighted (map (value K) row) Y)%C.
  Proof. induction row as [|a row IH]; intros [|c Y] z; cbn; rewrite ?at_scaled, ?IH; ring. Qed.
  Lemma dot_through ps : forall A Y z,
    dot_C (map (fun p => at_complex p z) (through_K ps A)) Y
    = dot_C (map (fun p => at_complex p z) ps) (map (fun row => weighted (map (value K) row) Y) A).
  Proof.
    induction ps as [|p ps IH]; intros [|row A] Y z; cbn [through_K map dot_C]; trivial.
    now rewrite dot_add_rows, dot_scaled_row, IH.
  Qed.

  (** The table times its denominator D, and z/D. *)
  Variables (A : list (list K)) (b : list K) (e : list Z) (D : Z).
  Hypothesis D_pos : (0 < D)%Z.
  Let e_K := map (of_Z K) e.

  Lemma weighted_over row : forall Y,
    (RtoC (IZR D) * weighted (map (over K D) row) Y = weighted (map (value K) row) Y)%C.
  Proof.
    assert (IZR D <> 0) by (apply not_0_IZR; lia).
    induction row as [|a row IH]; intros [|y Y]; cbn; try ring. rewrite <- IH. unfold over, Rdiv.
    rewrite RtoC_mult, RtoC_inv by assumption. field. injection. exact H.
  Qed.

  (** Q V = what the stages are of y0 = Q; and u, with u (I - zA) = Q b. *)
  Definition are_stages (Q : list K) (V : list (list K)) : bool :=
    (length V =? length A)%nat && (length e =? length A)%nat
    && forallb (fun p => same1 (fst p) (add1 (scaled1 (fst (snd p)) Q) (shifted1 (weighted_K (snd (snd p)) V))))
         (combine V (combine e_K A)).
  Definition are_multipliers (Q : list K) (u : list (list K)) : bool :=
    let image := add_rows (map (fun b => scaled1 b Q) b) (map shifted1 (through_K u A)) in
    (length u =? length image)%nat && forallb (fun p => same1 (fst p) (snd p)) (combine u image).
  Definition numerator (Q : list K) (u : list (list K)) : list K := add1 Q (shifted1 (weighted_K e_K u)).

  Section Step.
    Variables (Q : list K) (V u : list (list K)) (z : C).
    Hypotheses (V_ok : are_stages Q V = true) (u_ok : are_multipliers Q u = true).
    Let w : C := (z / RtoC (IZR D))%C.
    Let at_w p := at_complex p w.

    Lemma z_of_w row Y : (z * weighted (map (over K D) row) Y = w * weighted (map (value K) row) Y)%C.
    Proof.
      rewrite <- weighted_over. unfold w. field. injection. apply not_0_IZR. lia.
    Qed.

    Lemma step_exists y0 : at_w Q <> RtoC 0 -> exists Y y1,
      steps_to (map (map (over K D)) A) (map (over K D) b) (map IZR e) z y0 Y y1.
    Proof.
      intros Q0. exists (map (fun p => at_w p / at_w Q * y0)%C V). eexists. split; [|reflexivity].
      unfold are_stages in V_ok. apply andb_prop in V_ok as [L F]. apply andb_prop in L as [L L'].
      apply Nat.eqb_eq in L, L'.
      assert (W : forall row, weighted (map (value K) row) (map (fun p => at_w p / at_w Q * y0)%C V)
                         = (at_w (weighted_K row V) / at_w Q * y0)%C).
      { intros row. unfold at_w. rewrite at_weighted. generalize V. induction row as [|a row IH]; intros [|p V']; cbn.
        1-3: field; exact Q0. rewrite IH. field. exact Q0. }
      revert F. generalize L, L'. unfold e_K.
      enough (forall A' V' e', length V' = length A' -> length e' = length A' ->
        forallb (fun p => same1 (fst p) (add1 (scaled1 (fst (snd p)) Q) (shifted1 (weighted_K (snd (snd p)) V))))
          (combine V' (combine (map (of_Z K) e') A')) = true ->
        map (fun p => at_w p / at_w Q * y0)%C V' = map (fun p => RtoC (fst p) * y0 + z * weighted (snd p)
          (map (fun p => at_w p / at_w Q * y0)%C V))%C (combine (map IZR e') (map (map (over K D)) A'))) by auto.
      induction A' as [|row A' IH]; intros [|p V'] [|e0 e'] M M' F; try discriminate; [reflexivity|].
      cbn [map combine forallb fst snd] in *. apply andb_prop in F as [F F']. injection M; injection M'; intros.
      f_equal; [|apply IH; assumption]. rewrite z_of_w, W. apply at_same with (z := w) in F. unfold at_w at 1.
      rewrite F, at_add, at_scaled, at_shifted, value_of_Z. unfold at_w. field. exact Q0.
    Qed.

    Lemma dot_of_entries : forall x y Y, length x = length y ->
      forallb (fun p => same1 (fst p) (snd p)) (combine x y) = true -> dot_C (map at_w x) Y = dot_C (map at_w y) Y.
    Proof.
      induction x as [|p x IH]; intros [|q y] [|c Y] L F; try discriminate; trivial. cbn in *.
      apply andb_prop in F as [F F']. apply at_same with (z := w) in F. fold (at_w p) (at_w q) in F.
      rewrite F, (IH y Y); trivial. now injection L.
    Qed.

    Lemma numerator_of_step y0 Y y1 : length e = length A ->
      steps_to (map (map (over K D)) A) (map (over K D) b) (map IZR e) z y0 Y y1 ->
      (at_w Q * y1 = at_w (numerator Q u) * y0)%C.
    Proof.
      intros L [EY E1]. subst y1. rewrite z_of_w. unfold are_multipliers in u_ok. apply andb_prop in u_ok as [Lu F].
      apply Nat.eqb_eq in Lu. generalize (dot_of_entries _ _ Y Lu F). unfold at_w at 2. rewrite dot_add_rows.
      rewrite dot_scaled_row.
      assert (S : forall x Y, dot_C (map (fun p => at_complex p w) (map shifted1 x)) Y
                         = (w * dot_C (map (fun p => at_complex p w) x) Y)%C).
      { clear. induction x as [|p x IH]; intros [|c Y]; cbn [map dot_C]; try ring. rewrite at_shifted, IH. ring. }
      rewrite S, dot_through.
      assert (T : dot_C (map at_w u) Y = (at_w (weighted_K e_K u) * y0
        + w * dot_C (map at_w u) (map (fun row => weighted (map (value K) row) Y) A))%C).
      { rewrite EY at 1. unfold at_w at 2. rewrite at_weighted. unfold e_K. rewrite map_map.
        fold at_w. clear - L D_pos. revert L. generalize u, e.
        induction A as [|row A' IH]; intros u' [|e0 e'] L; try discriminate.
        - destruct u'; cbn; ring.
        - destruct u' as [|p u']; [cbn; ring|]. injection L; intros L'. cbn [map combine dot_C weighted fst snd].
          rewrite z_of_w, (IH u' e' L'), value_of_Z. unfold at_w. ring. }
      rewrite T. unfold numerator. intros M.
      assert (M' : (at_w Q * weighted (map (value K) b) Y = at_w (weighted_K e_K u) * y0)%C).
      { fold at_w in M. unfold at_w in *. set (X := dot_C _ _) in M.
        replace (at_complex (weighted_K e_K u) w * y0)%C
          with (at_complex (weighted_K e_K u) w * y0 + w * X - w * X)%C by ring.
        rewrite M. fold X. ring. }
      unfold at_w in *. rewrite at_add, at_shifted.
      transitivity (at_complex Q w * y0 + w * (at_complex Q w * weighted (map (value K) b) Y))%C; [ring|].
      rewrite M'. ring.
    Qed.
  End Step.
End Elimination.
