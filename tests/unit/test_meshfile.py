"""Meshes from Gmsh and VTU files: what is read, what is mended, and what is refused."""

from __future__ import annotations

import builtins
import os

import meshio
import numpy as np
import pytest

import matpoint as mp
from matpoint.domains import Domains, Kind
from matpoint.faces import check_sets, outer_faces
from meshes import MSH22, MSH41, save, write
from support import KIND_OF_DIM, deformed_mesh

KINDS = [kind for kinds in KIND_OF_DIM.values() for kind in kinds]
SOFT, STIFF = mp.NeoHookean(1e3, 0.3, 1.0), mp.NeoHookean(1e4, 0.3, 1.0)


# -- what is read ------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [MSH22, MSH41], ids=["2.2", "4.1"])
def test_gmsh_files_by_hand(tmp_path, text):
    mesh = mp.read_mesh(write(tmp_path / "m.msh", text))
    assert mesh.dim == 2
    assert list(mesh.groups) == ["stiff part", "soft"]
    (stiff,), (soft,) = mesh.groups.values()
    assert (stiff.kind, stiff.n, soft.kind, soft.n) == (Kind.QUAD, 1, Kind.TRI, 2)
    # The clockwise quadrilateral is turned, the doubled corner is one, z = 5 is taken off.
    assert stiff.volumes() == pytest.approx([1.0])
    assert soft.volumes() == pytest.approx([0.5, 0.5])
    assert (len(stiff.vertices), len(soft.vertices)) == (4, 4)
    assert (stiff.vertices[:, 2] == 0).all()
    # The set touches one of the groups only.
    assert (list(stiff.sets), list(soft.sets)) == (["left"], [])
    np.testing.assert_array_equal(np.sort(stiff.vertices[stiff.sets["left"][0]][:, 1]), [0.0, 1.0])


def test_one_group_of_two_shapes(tmp_path):
    path = write(
        tmp_path / "m.msh", MSH22, ('2 2 "soft"\n', ""), ("Names\n3", "Names\n2"), (" 2 2 2 2 ", " 2 2 1 2 ")
    )
    quad, triangles = mp.read_mesh(path).group("stiff part")
    assert (quad.kind, triangles.kind) == (Kind.QUAD, Kind.TRI)
    bodies = mp.read_mesh(path).bodies({"stiff part": STIFF}, velocity=(1.0, 0.0))
    assert [body.name for body in bodies] == ["stiff part"] * 2
    assert bodies[1].velocity == (1.0, 0.0)


@pytest.mark.parametrize("how", ["text", "binary", "vtu", "vtu text"])
@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name.lower())
def test_round_trips(tmp_path, kind, how):
    rng = np.random.default_rng(3)
    mesh = deformed_mesh(kind.dim, kind, rng)
    groups, sides = rng.integers(1, 3, mesh.n), outer_faces(mesh)
    groups[0] = 1
    if how.startswith("vtu"):
        path, names = save(tmp_path / "m.vtu", mesh, groups, sides, binary=how == "vtu"), ("1", "2", "9")
    else:
        options = {"file_format": "gmsh22", "binary": how == "binary"}
        path, names = save(tmp_path / "m.msh", mesh, groups, sides, **options), ("a", "b", "side")
    read = mp.read_mesh(str(path), dim=kind.dim)
    assert set(read.groups) == set(names[:2])
    count = 0
    for number, name in enumerate(names[:2], start=1):
        (domains,) = read.group(name)
        assert domains.kind == kind
        np.testing.assert_allclose(domains.volumes(), mesh.volumes()[groups == number], rtol=1e-9)
        np.testing.assert_allclose(domains.centroids(), mesh.centroids()[groups == number], atol=1e-9)
        check_sets(domains)
        count += len(domains.sets.get(names[2], ()))
    assert count == len(sides)


def test_the_same_volumes_as_a_structured_mesh(tmp_path):
    box = mp.mesh_box((0, 0, 1), (1, 2, 4), (2, 3, 4))
    (read,) = mp.read_mesh(save(tmp_path / "m.vtu", box, np.ones(box.n, int), box.sets["z+"])).group("1")
    np.testing.assert_allclose(read.volumes(), box.volumes(), rtol=1e-14)
    np.testing.assert_array_equal(read.vertices[read.cells], box.vertices[box.cells])
    assert len(read.sets["9"]) == len(box.sets["z+"])


@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("version", [2.2, 4.1])
def test_what_gmsh_writes(tmp_path, version, binary):
    try:
        import gmsh
    except OSError:
        pytest.skip("a system library that Gmsh needs is missing")
    gmsh.initialize()
    try:
        for option, value in {
            "General.Terminal": 0,
            "Mesh.MshFileVersion": version,
            "Mesh.Binary": binary,
        }.items():
            gmsh.option.setNumber(option, value)
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 2)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="block")
        gmsh.model.addPhysicalGroup(2, [1], name="x-")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(tmp_path / "m.msh"))
    finally:
        gmsh.finalize()
    (block,) = mp.read_mesh(tmp_path / "m.msh").group("block")
    assert block.kind == Kind.TET
    assert block.volumes().sum() == pytest.approx(2.0)
    corners = block.vertices[block.sets["x-"]]
    assert (corners[..., 0] == 0).all()
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert area.sum() == pytest.approx(2.0)


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name.lower())
def test_orientation_is_mended(tmp_path, kind):
    mesh = deformed_mesh(kind.dim, kind, np.random.default_rng(4))
    mirrored = Domains(mesh.vertices * [-1, 1, 1], mesh.cells, kind, checked=True)
    (read,) = mp.read_mesh(save(tmp_path / "m.vtu", mirrored, np.ones(mesh.n, int))).group("1")
    np.testing.assert_allclose(read.volumes(), mesh.volumes(), rtol=1e-12)
    np.testing.assert_allclose(read.centroids(), mesh.centroids() * [-1, 1, 1], atol=1e-12)


def test_doubled_vertices_become_one_within_the_tolerance(tmp_path):
    box = mp.mesh_box((0, 0), (3, 3), (3, 3))
    apart = box.vertices[box.cells].reshape(-1, 3)
    apart = apart + 1e-7 * np.random.default_rng(0).uniform(-1, 1, apart.shape) * [1, 1, 0]
    loose = Domains(apart, np.arange(36).reshape(9, 4), Kind.QUAD)
    path = save(tmp_path / "m.vtu", loose, np.ones(9, int))
    assert len(mp.read_mesh(path).group("1")[0].vertices) == 36
    joined = mp.read_mesh(path, tolerance=1e-6).group("1")[0]
    assert len(joined.vertices) == 16
    assert len(outer_faces(joined)) == 12


def test_a_set_between_two_groups_belongs_to_both(tmp_path):
    box = mp.mesh_box((0, 0), (2, 1), (2, 1))
    middle = np.flatnonzero(box.vertices[:, 0] == 1.0)[None]
    read = mp.read_mesh(save(tmp_path / "m.vtu", box, np.array([1, 2]), middle))
    assert [list(domains.sets) for (domains,) in read.groups.values()] == [["9"], ["9"]]


# -- groups and materials ----------------------------------------------------------------------


def test_bodies_of_groups(tmp_path):
    mesh = mp.read_mesh(write(tmp_path / "m.msh", MSH22))
    names = [body.name for body in mesh.bodies({"soft": SOFT, "stiff part": STIFF})]
    assert names == ["soft", "stiff part"]
    assert len(mesh.bodies({"soft": SOFT}, ignore=["stiff part"])) == 1
    with pytest.raises(mp.InputError, match=r"no group 'sofd'.*did you mean 'soft'.*stiff part, soft"):
        mesh.bodies({"sofd": SOFT, "stiff part": STIFF})
    with pytest.raises(mp.InputError, match="'soft' left out: give each group a material"):
        mesh.bodies({"stiff part": STIFF})
    with pytest.raises(mp.InputError, match="no group 'nothing'"):
        mesh.group("nothing")
    with pytest.raises(mp.InputError, match="no group 'nothing'"):
        mesh.bodies({"soft": SOFT, "stiff part": STIFF}, ignore=["nothing"])


# -- what is refused ---------------------------------------------------------------------------

_LESS = ("Names\n3", "Names\n2")
_REFUSED = {
    "nan": ([("4 0 1 5\n", "4 0 nan 5\n")], "vertex 3 .* finite"),
    "far away": ([("4 0 1 5\n", "4 0 1e60 5\n")], "nearer than 1e[+]50"),
    "not flat": ([("6 2 1 5\n", "6 2 1 6\n")], "z goes from 5 to 6"),
    "unnamed": ([('2 2 "soft"\n', ""), _LESS], r'group 2 .* Physical Surface\("name", 2\)'),
    "unnamed set": ([('1 3 "left"\n', ""), _LESS], r'group 3 .* Physical Curve\("name", 3\)'),
    "no group": ([("3 2 2 2 2 ", "3 2 2 0 2 ")], "triangle 0 .* belongs to no physical group; in Gmsh"),
    "empty group": ([("Names\n3", "Names\n4"), ('2 1 "s', '2 7 "no"\n2 1 "s')], "group 'no' has no cells"),
    "no volume": ([("4 2 2 2 2 2 6 7", "4 2 2 2 2 2 6 2")], r"tri 1 .* \(1, 0\), \(2, 1\), \(1, 0\)"),
    "tangled": ([("1 4 3 2\n", "1 4 2 3\n")], r"quad 0 .* tangled.* \(0, 0\), \(0, 1\), \(1, 0\), \(1, 1\)"),
    "not a face": ([("3 1 1 4\n", "3 1 1 3\n")], r"line 0 .* 'left' is not a face.*\(0, 0\), \(1, 1\)"),
    "two groups": ([("4 2 2 2 2 2 6 7", "4 2 2 1 2 2 5 6")], "tri 0 and|tri 1 and tri 0 .* the same"),
    "higher order": ([("3 2 2 2 2 2 5 6", "3 9 2 2 2 2 5 6 1 3 4")], "triangle6 is a cell of higher order"),
    "pyramid": ([("3 2 2 2 2 2 5 6", "3 7 2 2 2 2 5 6 1 3")], "pyramid cells can't become domains"),
    "unknown type": ([("3 2 2 2 2 2 5 6", "3 99 2 2 2 2 5 6")], "99 is not known"),
    "no such vertex": ([("2 5 6\n", "2 5 8\n")], "names a vertex"),
    "cut off": ([("$EndElements\n", "")], "cut off"),
    "not closed": ([("$EndNodes\n", "")], "a section is not closed"),
    "few cells": ([("Elements\n4", "Elements\n7")], "can't be read"),
    "few nodes": ([("Nodes\n8", "Nodes\n80")], "can't be read; it is damaged"),
    "words": ([("2 1 0 5", "2 one 0 5")], "can't be read; it is damaged"),
    "old": ([("2.2 0 8", "1.0 0 8")], "format 1.0; save it as 2.2 or 4.1"),
    "4.0": ([("2.2 0 8", "4.0 0 8")], "format 4.0; save it as 2.2 or 4.1"),
}  # fmt: skip


@pytest.mark.parametrize(("changes", "message"), _REFUSED.values(), ids=_REFUSED)
def test_refused_gmsh_files(tmp_path, changes, message):
    _refused(write(tmp_path / "m.msh", MSH22, *changes), message)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([("2 1 0 5 2 1 5 1 2 0", "2 1 0 5 2 1 5 2 2 1 0")], "'soft' and 'stiff part'; one is allowed"),
        ([("2 1 0 5 2 1 5 1 2 0", "2 1 0 5 2 1 5 0 0")], "in a physical group and others in none"),
        ([("$Elements\n3 4 1 4", "$Elements\n5 4 1 4")], "can't be read; it is damaged"),
        ([("2 2 2 2\n3 2 5 6", "2 2 9 2\n3 2 5 6 1 3 4")], "can't be read; it is damaged"),
    ],
)
def test_refused_gmsh_files_of_version_4(tmp_path, changes, message):
    _refused(write(tmp_path / "m.msh", MSH41, *changes), message)


def _refused(path, message, **options):
    with pytest.raises(mp.InputError, match=message) as caught:
        mp.read_mesh(path, **options)
    text = str(caught.value)
    assert text.startswith(f"mesh file {path}: ")
    assert "\n" not in text


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("m.msh", b"", "empty"),
        ("m.msh", b" \n\n", "empty"),
        ("m.msh", b"solid\n", "not a Gmsh file"),
        ("m.msh", bytes(range(256)), "not a Gmsh file"),
        ("m.msh", b"$NOD\n0\n$ENDNOD\n", "format 1; save it as 2.2 or 4.1"),
        ("m.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n0\n$EndNodes\n", "empty"),
        ("m.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n0\n$EndElements\n", "damaged"),
        (
            "m.msh",
            b"$MeshFormat\n4.1 1 8\n\x01\x00\x00\x00\n$EndMeshFormat\n$Nodes\nab\n$EndNodes\n",
            "damaged",
        ),
        ("m.vtu", b"", "empty"),
        ("m.vtu", b"<html></html>", "not a VTU file"),
        ("m.vtu", b"<VTKFile type='PolyData'><Piece/></VTKFile>", "UnstructuredGrid"),
        ("m.vtu", b"<VTKFile type='UnstructuredGrid'></VTKFile>", "0 pieces"),
        ("m.vtu", b"<VTKFile type='UnstructuredGrid'><Piece", "damaged"),
        ("m.stl", b"solid\n", "end in .msh"),
    ],
)
def test_files_that_are_no_meshes(tmp_path, name, content, message):
    path = tmp_path / name
    path.write_bytes(content)
    _refused(path, message)


def test_files_that_cant_be_opened(tmp_path, monkeypatch):
    _refused(tmp_path / "missing.msh", "no such file")
    (tmp_path / "folder.msh").mkdir()
    _refused(tmp_path / "folder.msh", "no such file")
    with (tmp_path / "huge.msh").open("wb") as file:
        os.truncate(file.fileno(), 3_000_000_000)  # sparse: no disk is used
    _refused(tmp_path / "huge.msh", "3 GB; at most 2 GB")
    with pytest.raises(mp.InputError, match="path = 3"):
        mp.read_mesh(3)  # type: ignore[arg-type]
    path = write(tmp_path / "m.msh", MSH22)
    _refused(path, "tolerance", tolerance=0.5)
    _refused(path, "dim = 4", dim=4)
    _refused(path, "its cells are 2-D; 3-D cells are needed", dim=3)
    real = builtins.__import__
    refuse = lambda name, *rest: exec("raise ImportError") if name == "meshio" else real(name, *rest)  # noqa: E731
    monkeypatch.setattr(builtins, "__import__", refuse)
    _refused(path, r"pip install 'matpoint\[mesh\]'")


def _vtu(path, points, cells, **data):
    arrays = {name.replace("_", ":"): values for name, values in data.items()}
    meshio.write(path, meshio.Mesh(np.array(points, dtype=float), cells, cell_data=arrays))
    return path


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
CUBE = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]


@pytest.mark.parametrize("name", ["material", "group", "gmsh_physical", "medit_ref"])
def test_groups_of_vtu_files(tmp_path, name):
    path = _vtu(tmp_path / "m.vtu", SQUARE, [("triangle", [[0, 1, 2], [0, 2, 3]])], **{name: [[4.0, 7.0]]})
    assert list(mp.read_mesh(path).groups) == ["4", "7"]


_VTU = {
    "no data": (SQUARE, [("quad", [[0, 1, 2, 3]])], {}, "no cell data name the groups"),
    "fractions": (SQUARE, [("quad", [[0, 1, 2, 3]])], {"material": [[1.5]]}, "whole numbers"),
    "vectors": (SQUARE, [("quad", [[0, 1, 2, 3]])], {"material": [[[1, 2, 3]]]}, "one number for each"),
    "group 0": (SQUARE, [("quad", [[0, 1, 2, 3]])], {"medit_ref": [[0]]}, "number groups from 1"),
    "polygon": (SQUARE, [("polygon", [[0, 1, 2, 3]])], {"material": [[1]]}, "polygon cells"),
    "quad8": (SQUARE * 2, [("quad8", [list(range(8))])], {"material": [[1]]}, "quad8 is a cell"),
    "hex20": (CUBE * 3, [("hexahedron20", [list(range(20))])], {"material": [[1]]}, "hexahedron20 is"),
    "tet10": (CUBE * 2, [("tetra10", [list(range(10))])], {"material": [[1]]}, "tetra10 is a cell of higher"),
    "wedge": (CUBE, [("wedge", [[0, 1, 2, 4, 5, 6]])], {"material": [[1]]}, "wedge cells"),
    "vertices": (SQUARE, [("vertex", [[0], [1]])], {"material": [[1, 1]]}, "cells are 0-D"),
    "shell": (
        [*CUBE, [5, 0, 0], [5, 1, 0], [6, 0, 0]],
        [("hexahedron", [list(range(8))]), ("triangle", [[8, 9, 10]])],
        {"material": [[1], [2]]},
        "triangle 0 .* of boundary set '2' is not a face of any hex",
    ),
    "flat hex": (
        np.array(CUBE) * [1, 1, 0],
        [("hexahedron", [list(range(8))])],
        {"material": [[1]]},
        "hex 0 .* no volume",
    ),
    "upright": (
        [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
        [("quad", [[0, 1, 2, 3]])],
        {"material": [[1]]},
        "parallel to the x-y plane",
    ),
    "slanted line": (SQUARE, [("line", [[0, 1], [1, 2]])], {"material": [[1, 1]]}, "along the x axis"),
}  # fmt: skip


@pytest.mark.parametrize(("points", "cells", "data", "message"), _VTU.values(), ids=_VTU)
def test_refused_vtu_files(tmp_path, points, cells, data, message):
    _refused(_vtu(tmp_path / "m.vtu", points, cells, **data), message)


def test_vtu_files_that_meshio_would_read_in_part(tmp_path):
    path = _vtu(tmp_path / "m.vtu", SQUARE, [("quad", [[0, 1, 2, 3]])], material=[[1]])
    text = path.read_text()
    start, end = text.index("<Piece"), text.index("</Piece>") + len("</Piece>")
    path.write_text(text[:end] + text[start:end] + text[end:])
    _refused(path, "2 pieces; save it as one")
    ascii_file = tmp_path / "a.vtu"
    mesh = meshio.Mesh(
        np.array(CUBE, dtype=float), [("hexahedron", [list(range(8))])], cell_data={"material": [[1]]}
    )
    meshio.write(ascii_file, mesh, binary=False)
    text = ascii_file.read_text()
    assert "\n12\n" in text
    ascii_file.write_text(text.replace("\n12\n", "\n11\n"))
    _refused(ascii_file, "type 11|not known")
