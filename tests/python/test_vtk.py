# SPDX-License-Identifier: BSD-3-Clause
"""Reads files of VTK and compares with VTK's own reader. A short test without VTK: tests/engine/mesh/vtk_test.cpp."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import keepout


def corners_by_vtk(file):
    """Returns the corners of all triangles, (n, 3, 3), in any order."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkPolyDataReader() if file.suffix == ".vtk" else vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.Update()
    surface = triangles.GetOutput()
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(surface.GetPoints().GetData()).astype(float)[corners]


def in_order(corners):
    """Returns the sorted triangles, each rotated to start at its smallest corner."""
    rows = [min(tuple(map(tuple, np.roll(triangle, k, axis=0))) for k in range(3)) for triangle in corners.tolist()]
    return np.array(sorted(rows))


def test_every_file_of_vtk_is_read_as_vtk_reads_it(tmp_path):
    pytest.importorskip("vtkmodules.vtkIOXML", reason="needs python3-vtk9")
    from write_vtk_files import write_all

    write_all(tmp_path)
    files = sorted(tmp_path.iterdir())
    kept = Path(__file__).resolve().parents[1] / "engine" / "mesh" / "vtk_files"
    assert [file.name for file in files] == sorted(file.name for file in kept.glob("*.vt[kp]"))
    for file in files:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh = keepout.load_mesh(file)
        assert mesh.space in ("LPS", "RAS"), file.name
        ours = in_order(mesh.vertices[mesh.triangles])
        np.testing.assert_allclose(ours, in_order(corners_by_vtk(file)), atol=1e-6, err_msg=file.name)
