"""Run Coq: compile the files, list the axioms that the theorems rest on, and check that planted errors fail."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

from proofs.kernel.certificates import ORDER, Certificate, all_theorems, source
from proofs.kernel.coq import Theorem

BUILD = Path(__file__).parents[2] / "build" / "kernel"
PACKAGES = ("coq", "libcoq-interval", "libcoq-flocq", "libcoq-coquelicot", "libcoq-bignums", "libcoq-gappa", "gappa")
# The allowed axioms: those of the reals, and those of machine integers and floats.
AXIOMS = re.compile(
    r"(ClassicalDedekindReals\.sig_(not|forall)_dec|FunctionalExtensionality\.functional_extensionality_dep"
    r"|Classical_Prop\.classic|(PrimInt63|Uint63|PrimFloat|FloatAxioms|FloatOps)\.\w+)$"
)
# Chosen: far above the slowest certificate, which takes two seconds.
SECONDS_PER_FILE = 300
SECONDS_PER_MUTANT = 20


class Refused(Exception):
    """Coq rejects a file, or its answers show that a check did not work."""


def missing_programs() -> str | None:
    """Advice on what to install if Coq or one of its libraries is missing; None if all are there."""
    if shutil.which("coqc"):
        where = Path(_coq("coqc", "-where").strip())
        if all(
            (where / "user-contrib" / library).is_dir()
            for library in ("Interval", "Flocq", "Coquelicot", "Bignums", "Gappa")
        ):
            return None
    return f"Coq or its libraries are missing; on Debian: apt-get install --no-install-recommends {' '.join(PACKAGES)}"


def compile_all(folder: Path = BUILD) -> None:
    """Write all files; compile those that changed and all after them. Raises Refused if Coq rejects one."""
    folder.mkdir(parents=True, exist_ok=True)
    newest = 0.0
    for name in (bar := tqdm(ORDER, unit="file", disable=None)):
        bar.set_postfix_str(name)
        file, text = folder / f"{name}.v", source(name)
        compiled = file.with_suffix(".vo")
        made = compiled.stat().st_mtime if compiled.exists() and file.read_text(encoding="utf-8") == text else 0.0
        if made <= newest:
            compiled.unlink(missing_ok=True)
            file.write_text(text, encoding="utf-8")
            _coqc(file)
            made = compiled.stat().st_mtime
        newest = made


def foreign_axioms(folder: Path = BUILD) -> list[str]:
    """The axioms that some theorem rests on and that AXIOMS does not allow; should be empty."""
    names = ", ".join(f"{found.file}.{found.theorem.name}" for found in all_theorems())
    files = " ".join(dict.fromkeys(found.file for found in all_theorems()))
    script = f"From driftproof Require {files}.\nDefinition everything := ({names}).\nPrint Assumptions everything.\n"
    file = folder / "Assumptions.v"
    file.write_text(script, encoding="utf-8")
    found = re.findall(r"^(\S+)(?: :.*|)$", _coqc(file).partition("Axioms:")[2], re.M)
    if not found:
        raise Refused("Coq lists no axioms, not even those of the reals")
    return [name for name in found if not AXIOMS.match(name)]


def accepted_mutants(mutants: Sequence[tuple[Certificate, Theorem]], folder: Path = BUILD) -> list[str]:
    """The mutated statements that Coq accepts with the proof of the right theorem; should be empty.

    Raises Refused if Coq cannot read a mutated statement, or rejects a right theorem where its mutants are tried.
    """
    found = []
    for name in (bar := tqdm(dict.fromkeys(certificate.file for certificate, _ in mutants), unit="file", disable=None)):
        bar.set_postfix_str(f"mutants of {name}")
        here = [(certificate.theorem, mutant) for certificate, mutant in mutants if certificate.file == name]
        script = [*_preamble(name), f"Set Default Timeout {SECONDS_PER_MUTANT}."]
        for i, (theorem, mutant) in enumerate(here):
            script.append(f"Definition readable_{i} : Prop := {mutant.statement}.")
            script += [_attempt(f"right_{i}", theorem), _attempt(f"mutant_{i}", mutant)]
            script += [f"Check {kind}_{i}." for kind in ("readable", "right", "mutant")]
        known = set(re.findall(r"^(\w+_\d+)$", _talk("\n".join(script), folder), re.M))
        for i, (theorem, mutant) in enumerate(here):
            for kind in ("readable", "right"):
                if f"{kind}_{i}" not in known:
                    raise Refused(
                        f"{theorem.name} in {name}: not {kind}, so its mutant says nothing: {mutant.statement}"
                    )
            if f"mutant_{i}" in known:
                found.append(f"{theorem.name}: {mutant.statement}")
    return found


def _attempt(name: str, theorem: Theorem) -> str:
    return Theorem(name, theorem.statement, theorem.proof).text() + "Abort All."


def _preamble(name: str) -> list[str]:
    """The import sentences of a file, and one that imports the file itself."""
    imports = re.findall(r"^(?:From|Import|Open) [^.]*\.", source(name), re.M)
    return [*imports, f"From driftproof Require Import {name}."]


def _talk(script: str, folder: Path) -> str:
    """The answers of coqtop to a script; an error in one sentence does not stop the following ones."""
    answers = _coq("coqtop", "-color", "no", *_IN_FOLDER, folder=folder, script=script)
    return re.sub(r"^(\w+ < )+", "", answers, flags=re.M)


# Relative paths, to be run in the folder itself: some tactics of Coq leave caches in the current folder.
_IN_FOLDER = ("-q", "-w", "none", "-Q", ".", "driftproof")


def _coqc(file: Path) -> str:
    return _coq("coqc", *_IN_FOLDER, file.name, folder=file.parent)


def _coq(*command: str, folder: Path = Path(), script: str = "") -> str:
    done = subprocess.run(
        command, cwd=folder, input=script, capture_output=True, text=True, timeout=SECONDS_PER_FILE, check=False
    )
    if done.returncode != 0:
        raise Refused(done.stderr.strip() or done.stdout.strip())
    return done.stdout
