"""Meshes from files: Gmsh's .msh and VTK's .vtu."""

from __future__ import annotations

from matpoint.meshfile.mesh import Mesh, read_mesh

__all__ = ["Mesh", "read_mesh"]
