(** The order of a Runge-Kutta method: its conditions over all rooted trees, and how they are checked for all at once.

    An ordered tree is a vertex, or a tree with one more branch grafted to its root. Every rooted tree is one, drawn in
    the plane in some way, and the weight and the density do not depend on the way. *)

From Coq Require Import ZArith Reals Lra Lia List.
Import ListNotations.
Open Scope R_scope.

Inductive tree := vertex | graft (t u : tree).  (* u is the last branch of the root *)

Fixpoint vertices (t : tree) : nat :=
  match t with vertex => 1 | graft t u => vertices t + vertices u end.

(** The product over the branches of the root of their densities; times the number of vertices, the density. *)
Fixpoint branches (t : tree) : nat :=
  match t with vertex => 1 | graft t u => branches t * (vertices u * branches u) end.
Definition density (t : tree) : nat := vertices t * branches t.

(** Phi(t) = sum_i b_i prod over the branches u of (A phi(u))_i: the elementary weight (Butcher 2016, 312). *)
Section Weights.
  Variables (A : list (list R)) (b : list R).
  Fixpoint dot (x y : list R) : R :=
    match x, y with a :: x, c :: y => a * c + dot x y | _, _ => 0 end.
  Fixpoint times (x y : list R) : list R :=
    match x, y with a :: x, c :: y => a * c :: times x y | _, _ => [] end.
  Fixpoint stages (t : tree) : list R :=
    match t with
    | vertex => map (fun _ => 1) b
    | graft t u => times (stages t) (map (fun row => dot row (stages u)) A)
    end.
  Definition weight (t : tree) : R := dot b (stages t).
  Definition meets (t : tree) : Prop := weight t * INR (density t) = 1.

  (** Order p and no higher: every tree with up to p vertices meets its condition, one with p + 1 does not. *)
  Definition order (p : nat) : Prop :=
    (forall t, (vertices t <= p)%nat -> meets t) /\ exists t, vertices t = S p /\ ~ meets t.

  (** Rounded coefficients: the conditions of up to p vertices are missed by at most r, one of p + 1 by more than s. *)
  Definition missed (t : tree) : R := Rabs (weight t - / INR (density t)).
  Definition order_within (p : nat) (r s : R) : Prop :=
    (forall t, (vertices t <= p)%nat -> missed t <= r) /\ exists t, vertices t = S p /\ s < missed t.
End Weights.

Lemma vertices_pos t : (1 <= vertices t)%nat.
Proof. induction t; cbn; lia. Qed.
Lemma density_pos t : (1 <= density t)%nat.
Proof.
  unfold density. enough (1 <= branches t)%nat by (generalize (vertices_pos t); nia).
  induction t as [|t IH u IH']; cbn; [lia|]. generalize (vertices_pos u). nia.
Qed.

(** Numbers as far as weights are computed in them. *)
Record numbers := {
  element :> Type;
  plus : element -> element -> element;
  mult : element -> element -> element;
  of_Z : Z -> element
}.

(** Of a tree with n vertices: its stages, and the product of its branches; in integers, of a table that is written over
    a denominator D, D^(n-1) times its stages. Kept with them: A times the stages, D^n times. *)
Section Levels.
  Variables (K : numbers) (A : list (list K)) (b : list K).
  Fixpoint dot_K (x y : list K) : K :=
    match x, y with a :: x, c :: y => plus K (mult K a c) (dot_K x y) | _, _ => of_Z K 0 end.
  Fixpoint times_K (x y : list K) : list K :=
    match x, y with a :: x, c :: y => mult K a c :: times_K x y | _, _ => [] end.

  Record entry := { stages_of : list K; branches_of : Z }.
  Definition sums (e : entry) : list K := map (fun row => dot_K row (stages_of e)) A.
  Definition kept (e : entry) : entry * list K := (e, sums e).
  Definition single : entry := {| stages_of := map (fun _ => of_Z K 1) b; branches_of := 1 |}.
  Definition grafted (t : entry) (size_of_u : Z) (u : entry * list K) : entry :=
    {| stages_of := times_K (stages_of t) (snd u);
       branches_of := branches_of t * (size_of_u * branches_of (fst u)) |}.
  Fixpoint entry_of (t : tree) : entry :=
    match t with
    | vertex => single
    | graft t u => grafted (entry_of t) (Z.of_nat (vertices u)) (kept (entry_of u))
    end.

  (** The trees with k + 1 vertices, from those with 1, 2, ..., k: [descending] begins with those of k vertices. *)
  Fixpoint next (descending ascending : list (list (entry * list K))) (size_of_u : Z) : list entry :=
    match descending, ascending with
    | ts :: descending, us :: ascending =>
        flat_map (fun t => map (grafted (fst t) size_of_u) us) ts ++ next descending ascending (size_of_u + 1)
    | _, _ => []
    end.
  Definition level_after (ls : list (list (entry * list K))) : list entry :=
    match ls with [] => [single] | _ => next (rev ls) ls 1 end.
  Fixpoint levels (k : nat) : list (list (entry * list K)) :=
    match k with O => [] | S k => let ls := levels k in ls ++ [map kept (level_after ls)] end.

  (** A test of all trees with up to p vertices; those with p need not be kept. *)
  Variable test : Z -> entry -> bool.
  Fixpoint all_pass (n : Z) (ls : list (list (entry * list K))) : bool :=
    match ls with [] => true | l :: ls => forallb (fun e => test n (fst e)) l && all_pass (n + 1) ls end.
  Definition passes (p : nat) : bool :=
    match p with
    | O => true
    | S k => let ls := levels k in all_pass 1 ls && forallb (test (Z.of_nat p)) (level_after ls)
    end.

  (** Each tree has its entry in its level. *)
  Lemma in_next : forall ds us e f i first, (i < length ds)%nat -> (i < length us)%nat ->
    In (kept e) (nth i ds []) -> In f (nth i us []) -> In (grafted e (first + Z.of_nat i) f) (next ds us first).
  Proof.
    induction ds as [|l ds IH]; intros [|l' us] e f i first Hi Hi' He Hf; cbn in Hi, Hi'; try lia.
    cbn [next]. apply in_or_app. destruct i as [|i].
    - left. apply in_flat_map. exists (kept e). split; [exact He|]. rewrite Z.add_0_r. now apply in_map.
    - right. replace (first + Z.of_nat (S i))%Z with (first + 1 + Z.of_nat i)%Z by lia.
      apply IH; trivial; lia.
  Qed.

  Lemma levels_length k : length (levels k) = k.
  Proof. induction k; [reflexivity|]. cbn [levels]. rewrite app_length, IHk. cbn. lia. Qed.

  Definition complete (k : nat) : Prop := forall t, (vertices t <= k)%nat ->
    In (kept (entry_of t)) (nth (vertices t - 1) (levels k) []).
  Lemma level_complete k : complete k -> forall t, vertices t = S k -> In (entry_of t) (level_after (levels k)).
  Proof.
    intros known t E. destruct k as [|k].
    { destruct t as [|t u]; [now left|]. cbn in E. generalize (vertices_pos t), (vertices_pos u). lia. }
    assert (L := levels_length (S k)).
    replace (level_after (levels (S k))) with (next (rev (levels (S k))) (levels (S k)) 1)
      by (destruct (levels (S k)); [discriminate | reflexivity]).
    destruct t as [|t u]; cbn [vertices] in E; [lia|]. generalize (vertices_pos t), (vertices_pos u). intros.
    cbn [entry_of]. replace (Z.of_nat (vertices u)) with (1 + Z.of_nat (vertices u - 1))%Z by lia.
    apply in_next; rewrite ?rev_length, ?L; try lia; [|apply known; lia].
    rewrite rev_nth by (rewrite L; lia). rewrite L.
    replace (S k - S (vertices u - 1))%nat with (vertices t - 1)%nat by lia. apply known. lia.
  Qed.
  Lemma levels_complete k : complete k.
  Proof.
    induction k as [|k IH]; intros t size; [generalize (vertices_pos t); lia|]. cbn [levels].
    destruct (Nat.eq_dec (vertices t) (S k)) as [E|].
    - rewrite E, app_nth2, levels_length by (rewrite levels_length; lia).
      replace (S k - 1 - k)%nat with O by lia. apply in_map. now apply level_complete.
    - rewrite app_nth1; [apply IH; lia|]. rewrite levels_length. generalize (vertices_pos t). lia.
  Qed.

  Lemma all_pass_nth : forall ls n i e, all_pass n ls = true -> In e (nth i ls []) ->
    test (n + Z.of_nat i)%Z (fst e) = true.
  Proof.
    induction ls as [|l ls IH]; intros n i e H He; [destruct i; destruct He|].
    cbn in H. apply andb_prop in H as [Hl H]. destruct i as [|i].
    - rewrite Z.add_0_r. rewrite forallb_forall in Hl. now apply Hl.
    - replace (n + Z.of_nat (S i))%Z with (n + 1 + Z.of_nat i)%Z by lia. now apply IH.
  Qed.

  (** What is computed for the entries of all levels is true of all trees. *)
  Lemma tree_passes p t : passes p = true -> (vertices t <= p)%nat -> test (Z.of_nat (vertices t)) (entry_of t) = true.
  Proof.
    destruct p as [|k]; [generalize (vertices_pos t); lia|]. cbn [passes]. intros H size.
    apply andb_prop in H as [before last]. destruct (Nat.eq_dec (vertices t) (S k)) as [E|].
    - rewrite E. rewrite forallb_forall in last. apply last. apply level_complete; [apply levels_complete | exact E].
    - replace (Z.of_nat (vertices t)) with (1 + Z.of_nat (vertices t - 1))%Z by (generalize (vertices_pos t); lia).
      exact (all_pass_nth _ _ _ (kept _) before (levels_complete k t ltac:(lia))).
  Qed.
  Lemma branches_of_entry t : IZR (branches_of (entry_of t)) = INR (branches t).
  Proof.
    induction t as [|t IH u IH']; [reflexivity|]. cbn [entry_of grafted kept fst branches_of branches].
    now rewrite !mult_IZR, !mult_INR, IH, IH', <- INR_IZR_INZ.
  Qed.
End Levels.
