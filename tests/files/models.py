"""Stairs as meshes, in every format of them."""

import numpy as np
import trimesh

Z_TO_Y_UP = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def box(low, high):
    return trimesh.creation.box(bounds=[low, high])


def stair_of_solids(n_steps=5, rise=0.175, going=0.28, width=1.0):
    """A flight built as models are: every step a solid that goes on under the next, on a slab."""
    end = n_steps * going
    parts = [box((-1.2, -0.3, -0.05), (0.0, width + 0.3, 0.0))]
    parts += [box((k * going, 0.0, 0.0), (end, width, (k + 1) * rise)) for k in range(n_steps)]
    return trimesh.util.concatenate(parts)


def exported(mesh, name):
    """The bytes of a mesh in the format that a file's name says; ``ascii`` in it asks for text."""
    kind = name.rpartition(".")[2]
    if kind == "glb":
        mesh = mesh.copy()
        mesh.apply_transform(Z_TO_Y_UP)
    if kind == "stl" and "ascii" in name:
        kind = "stl_ascii"
    options = {"encoding": "ascii"} if kind == "ply" and "ascii" in name else {}
    content = mesh.export(file_type=kind, **options)
    return content.encode() if isinstance(content, str) else content


def gltf_text(mesh):
    """The JSON of a glTF and its bytes beside it."""
    return dict(mesh.export(file_type="gltf"))
