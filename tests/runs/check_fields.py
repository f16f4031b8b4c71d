"""Every field of the state is saved: each component of the types below is named in the procedure
that passes it to an archive. A field that was forgotten would restart with another value.

usage: check_fields.py SOURCE"""
import re
import sys
from pathlib import Path

# type, its file, the procedure that keeps it, its file; fields that follow from the model
KEPT = [
    ("consistent_state_t", "consistent/kj_consistent_state.f90", "keep_state", "consistent/kj_consistent_archive.f90",
     "mean final active stages trial"),
    ("kept_t", "consistent/kj_consistent_state.f90", "keep_kept", "consistent/kj_consistent_archive.f90", ""),
    ("poses_t", "consistent/kj_consistent_matrix.f90", "keep_poses", "consistent/kj_consistent_archive.f90", ""),
    ("consistent_joint_t", "consistent/kj_consistent_batch.f90", "keep_joint", "consistent/kj_consistent_archive.f90", ""),
    ("march_t", "consistent/kj_consistent_march.f90", "keep_march", "consistent/kj_consistent_archive.f90", ""),
    ("bound_t", "consistent/kj_consistent_safe_step.f90", "keep_bound", "consistent/kj_consistent_archive.f90", "lambda"),
    ("contact_t", "consistent/kj_consistent_impact_step.f90", "keep_contact", "consistent/kj_consistent_archive.f90", ""),
    ("legacy_state_t", "legacy/kj_legacy_state.f90", "keep_legacy", "legacy/kj_legacy_archive.f90", "team crew jointed sprung on_main idle_limit trial"),
    ("world_t", "legacy/kj_legacy_force.f90", "keep_world", "legacy/kj_legacy_archive.f90", ""),
    ("legacy_joint_t", "legacy/kj_legacy_joint.f90", "keep_joint", "legacy/kj_legacy_archive.f90", ""),
    ("gravity_t", "model/kj_gravity.f90", "keep_gravity", "model/kj_gravity.f90", "each"),
    ("scheme_t", "api/kj_scheme.f90", "keep_scene", "api/kj_checkpoint.f90",
     "legacy integrator nodal islands n_island shown pause"),
]


def components(text, name):
    body = re.search(rf"^ *type(?:, *\w+(?:\(\w+\))?)* *:: *{name}\n(.*?)^ *end type {name}", text, re.S | re.M)
    if not body:
        sys.exit(f"check_fields: no type {name}")
    found = []
    for line in body.group(1).splitlines():
        line = line.split("!")[0]
        if "::" not in line:
            continue
        names = line.split("::", 1)[1]
        names = re.sub(r"=[^,]*?\([^()]*\)|=[^,]*", "", re.sub(r"\([^()]*\)", "", names))
        found += [word.strip() for word in names.split(",") if word.strip()]
    return found


def procedure(text, name):
    body = re.search(rf"^ *subroutine {name}\(.*?^ *end subroutine {name}\n", text, re.S | re.M)
    if not body:
        sys.exit(f"check_fields: no procedure {name}")
    return "\n".join(line.split("!")[0] for line in body.group(0).splitlines())


def main(source):
    missing, count = [], 0
    for kind, home, keeper, file, made in KEPT:
        text = procedure((source / file).read_text(), keeper)
        for field in components((source / home).read_text(), kind):
            count += 1
            if field not in made.split() and not re.search(rf"%{field}\b", text):
                missing.append(f"{file}: {keeper} does not keep {kind}%{field}")
    print("\n".join(missing))
    print(f"check_fields: {count} fields of {len(KEPT)} types, {len(missing)} forgotten")
    return bool(missing) or count < 100


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) / "src"))
