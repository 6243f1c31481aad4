# SPDX-License-Identifier: BSD-3-Clause
"""Writes the files of tests/engine/mesh/vtk_files with VTK (python3-vtk9): write_vtk_files.py FOLDER

Each file contains the same sphere of 20 triangles. The files of 3D Slicer use its settings."""

import sys
from pathlib import Path

from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkStripper
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter


def sphere(double=False, strips=False, space=None):
    source = vtkSphereSource()
    source.SetRadius(20)
    source.SetThetaResolution(5)
    source.SetPhiResolution(4)
    source.SetOutputPointsPrecision(1 if double else 0)
    source.Update()
    data = vtkPolyData()
    data.ShallowCopy(source.GetOutput())
    if strips:
        stripper = vtkStripper()
        stripper.SetInputData(data)
        stripper.Update()
        data.ShallowCopy(stripper.GetOutput())
    if space:
        array = vtkStringArray()
        array.SetName("SPACE")
        array.InsertNextValue(space)
        data.GetFieldData().AddArray(array)
    return data


def write(writer, file, data):
    writer.SetFileName(str(file))
    writer.SetInputData(data)
    if not writer.Write():
        sys.exit(f"{file}: cannot be written")


def legacy(file, data, binary, version=51, title="3D Slicer output. SPACE=LPS"):
    writer = vtkPolyDataWriter()
    writer.SetHeader(title)
    writer.SetFileVersion(version)
    writer.SetFileType(2 if binary else 1)
    write(writer, file.with_suffix(".vtk"), data)


def xml(file, data, mode, packed=False, counts=64, encode=True, big_endian=False):
    writer = vtkXMLPolyDataWriter()
    getattr(writer, f"SetDataModeTo{mode}")()
    if not packed:
        writer.SetCompressorTypeToNone()
    writer.SetHeaderType(counts)
    writer.SetEncodeAppendedData(encode)
    if big_endian:
        writer.SetByteOrderToBigEndian()
    write(writer, file.with_suffix(".vtp"), data)


def write_all(folder):
    legacy(folder / "text42", sphere(), False, 42)
    legacy(folder / "binary42", sphere(), True, 42)  # as 3D Slicer does
    legacy(folder / "text51", sphere(double=True), False)
    legacy(folder / "binary51", sphere(double=True), True)
    legacy(folder / "strips42", sphere(strips=True), True, 42)
    legacy(folder / "strips51", sphere(strips=True), True)
    legacy(folder / "field", sphere(space="RAS"), True, title="made by VTK")
    legacy(folder / "field_text", sphere(space="RAS"), False, title="made by VTK")
    xml(folder / "slicer", sphere(space="LPS"), "Appended", packed=True, counts=32)
    xml(folder / "text", sphere(double=True, space="RAS"), "Ascii")
    xml(folder / "base64", sphere(space="RAS"), "Binary", counts=32)
    xml(folder / "base64_packed", sphere(space="RAS"), "Binary", packed=True)
    xml(folder / "raw", sphere(strips=True, space="RAS"), "Appended", encode=False)
    xml(folder / "raw_packed", sphere(space="RAS"), "Appended", packed=True, counts=32, encode=False)
    xml(folder / "big_endian", sphere(strips=True, space="RAS"), "Appended", packed=True, big_endian=True)


if __name__ == "__main__":
    write_all(Path(sys.argv[1]))
