# SPDX-License-Identifier: BSD-3-Clause
"""A label map becomes a mesh in the coordinates of the image."""

import gzip
import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from surfaces import run

import keepout

missing = [name for name in ("nibabel", "skimage") if importlib.util.find_spec(name) is None]
pytestmark = pytest.mark.skipif(bool(missing), reason=f"needs python3-{' and python3-'.join(missing)}")

script = Path(__file__).resolve().parents[2] / "examples" / "python" / "mesh_of_labels.py"

# An ellipsoid in an image with oblique and mirrored axes and three different spacings.
turn = np.linalg.qr(np.array([[0.9, -0.3, 0.1], [0.2, 0.9, -0.3], [0.1, 0.3, 1.1]]))[0]
affine = np.eye(4)
affine[:3, :3] = turn @ np.diag([-0.8, 1.0, 1.5])
affine[:3, 3] = [-40, 25, 100]
shape = (50, 40, 30)
center = np.array([24.0, 20.0, 14.0])
radii = np.array([15.0, 12.0, 8.0])  # [voxels]


def labels():
    index = np.moveaxis(np.indices(shape), 0, -1)
    return (((index - center) / radii) ** 2).sum(axis=-1) <= 1


def write_nifti(path, values):
    import nibabel

    nibabel.save(nibabel.Nifti1Image(values.astype(np.int16), affine), path)
    return path


def write_nrrd(path, values, encoding="gzip", flip=(-1, -1, 1), space="left-posterior-superior"):
    columns = [",".join(str(float(x)) for x in np.array(flip) * column) for column in affine[:3].T]
    header = f"""NRRD0004
# by hand
type: unsigned short
dimension: 3
space: {space}
sizes: {' '.join(map(str, shape))}
space directions: ({columns[0]}) ({columns[1]}) ({columns[2]})
kinds: domain domain domain
endian: big
encoding: {encoding}
space origin: ({columns[3]})
key:=value

"""
    data = values.astype(">u2").tobytes(order="F")
    path.write_bytes(header.encode() + (gzip.compress(data) if encoding == "gzip" else data))
    return path


def mesh_of(file, tmp_path, *options):
    said = run(sys.executable, script, file, tmp_path / "out.ply", *options)
    return keepout.load_mesh(tmp_path / "out.ply", space="RAS"), said


def test_the_surface_is_where_the_image_is(tmp_path):
    plain, said = mesh_of(write_nifti(tmp_path / "a.nii.gz", 3 * labels()), tmp_path, "--smooth", "0")
    assert "label 3, " in said and "in LPS" in said
    found = plain.inspect()
    assert found.watertight and not found.inside_out and plain.warnings == []
    # In voxels, all vertices are within about a voxel of the surface of the ellipsoid.
    voxels = (plain.vertices - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    distance = np.abs(np.linalg.norm((voxels - center) / radii, axis=1) - 1)
    assert distance.max() < 1 / radii.min()
    volume = 4 / 3 * np.pi * np.prod(radii) * abs(np.linalg.det(affine[:3, :3]))
    assert found.signed_volume == pytest.approx(volume, rel=0.02)


def test_formats_and_spaces_agree(tmp_path):
    expected, _ = mesh_of(write_nifti(tmp_path / "a.nii", labels()), tmp_path)
    for file, options in [
        (write_nrrd(tmp_path / "lps.nrrd", labels()), []),
        (write_nrrd(tmp_path / "raw.nrrd", labels(), "raw"), ["--space", "RAS"]),
        (write_nrrd(tmp_path / "ras.nrrd", labels(), "raw", (1, 1, 1), "right-anterior-superior"), []),
    ]:
        mesh, _ = mesh_of(file, tmp_path, *options)
        np.testing.assert_allclose(mesh.vertices, expected.vertices, atol=1e-4)
        np.testing.assert_array_equal(mesh.triangles, expected.triangles)


@pytest.mark.parametrize("encoding, field, end", [("raw", "data file", "\n\n"), ("gzip", "datafile", "\n")])
def test_the_data_may_be_in_a_file_beside_the_header(tmp_path, encoding, field, end):
    expected, _ = mesh_of(write_nrrd(tmp_path / "a.nrrd", labels(), encoding), tmp_path)
    header, data = (tmp_path / "a.nrrd").read_bytes().split(b"\n\n", 1)
    (tmp_path / "my data.raw").write_bytes(data)
    (tmp_path / "a.nhdr").write_bytes(header + f"\n{field}: my data.raw{end}".encode())
    mesh, _ = mesh_of(tmp_path / "a.nhdr", tmp_path)
    np.testing.assert_array_equal(mesh.vertices, expected.vertices)


def test_a_label_is_chosen_and_closed_at_the_border(tmp_path):
    values = np.zeros(shape, int)
    values[:10, :, :] = 1
    values[30:35, 10:20, 5:9] = 2
    file = write_nifti(tmp_path / "a.nii", values)
    ended = subprocess.run([sys.executable, script, file, tmp_path / "m.ply"], capture_output=True, text=True)
    assert ended.returncode == 1 and "labels 1, 2; choose one of them with --label" in ended.stderr
    assert not (tmp_path / "m.ply").exists()
    mesh, _ = mesh_of(file, tmp_path, "--label", "1", "--smooth", "0")
    assert mesh.inspect().watertight
    assert mesh.inspect().signed_volume == pytest.approx(10 * 40 * 30 * 1.2, rel=0.01)


def test_what_is_no_label_map_is_one_sentence(tmp_path):
    good = write_nrrd(tmp_path / "good.nrrd", labels(), "raw").read_bytes()
    for old, new, says in [
        (b"NRRD0004", b"DRRN0004", "is not NRRD"),
        (b"unsigned short", b"float", "not integers"),
        (b"space: left-posterior-superior", b"space: scanner-xyz", "scanner-xyz"),
        (b"space origin", b"space roigin", "no 'space origin'"),
        (b"encoding: raw", b"encoding: bzip2", "bzip2"),
        (b"encoding: raw", b"encoding: gzip", "gzip"),
        (b"sizes: 50", b"sizes: 51", "has 120000 bytes for 51 x 40 x 30 voxels, which take 122400; copy it again"),
        (b"sizes: 50", b"sizes: -50", "has 'sizes: -50 40 30', not three whole numbers"),
        (good, good + b"x", "has 120001 bytes"),
        (b"space directions: (", b"space directions: (0,0,1) (", "not 3 of three numbers in brackets"),
        (b"space origin: (", b"space origin: (x,", "not 1 of three numbers in brackets"),
        (b"kinds: ", b'space units: "m" "m" "m"\nkinds: ', "lengths in m; save it in mm"),
        (b"kinds: ", b"space: LPS\nkinds: ", "states 'space' twice"),
        (b"space origin: (", b"space origin: (nan,0,0)\n#(", "place no voxels"),
        (b"kinds: ", b"data file: other.raw\nkinds: ", "other.raw"),
        (b"kinds: ", b"data file: LIST\nkinds: ", "in several files ('LIST'); save it as one .nrrd file"),
        (b"kinds: ", b"datafile: a%03d.raw 1 30 1\nkinds: ", "in several files"),
        (b"kinds: ", b"byte skip: 4\nkinds: ", "'byte skip', which is not read"),
        (b"sizes: 50", b"sizes: 2 50", "has 4 axes, not 3; export it as one label map (3D Slicer: Segmentations, "),
        (good, good[:40], "is not NRRD, or was cut short"),
    ]:
        (tmp_path / "bad.nrrd").write_bytes(good.replace(old, new))
        for file in ["bad.nrrd", "absent.nrrd"]:
            ended = subprocess.run(
                [sys.executable, script, tmp_path / file, tmp_path / "m.ply"], capture_output=True, text=True
            )
            assert ended.returncode == 1 and "Traceback" not in ended.stderr, ended.stderr
            assert (says in ended.stderr) == (file == "bad.nrrd"), ended.stderr
            assert len(ended.stderr.splitlines()) == 1
    damaged = bytearray(write_nifti(tmp_path / "good.nii.gz", labels()).read_bytes())
    damaged[-5] ^= 1  # in the checksum
    unit = bytearray(gzip.decompress((tmp_path / "good.nii.gz").read_bytes()))
    unit[123] = 77
    for file, content, says in [
        ("bad.nii", b"nothing", "is no NIfTI file"),
        ("bad.nii.gz", damaged, "is damaged (CRC check failed"),
        ("unit.nii", unit, "unknown code of its unit"),
    ]:
        (tmp_path / file).write_bytes(content)
        ended = subprocess.run(
            [sys.executable, script, tmp_path / file, tmp_path / "m.ply"], capture_output=True, text=True
        )
        assert ended.returncode == 1 and says in ended.stderr and "Traceback" not in ended.stderr, ended.stderr


def test_an_empty_map_and_an_output_that_cannot_be_written_are_named(tmp_path):
    for values, output, says in [
        (0 * labels(), "m.ply", "a.nii: has no labels: all of its voxels are 0"),
        (labels(), "no/m.ply", "m.ply: cannot be written (No such file or directory)"),
    ]:
        command = [sys.executable, script, write_nifti(tmp_path / "a.nii", values), tmp_path / output]
        ended = subprocess.run(command, capture_output=True, text=True)
        assert ended.returncode == 1 and says in ended.stderr and len(ended.stderr.splitlines()) == 1, ended.stderr


def test_labels_of_eight_bytes_are_read(tmp_path):
    expected, _ = mesh_of(write_nrrd(tmp_path / "a.nrrd", labels(), "raw"), tmp_path)
    header = (tmp_path / "a.nrrd").read_bytes().split(b"\n\n", 1)[0].replace(b"unsigned short", b"long long")
    (tmp_path / "b.nrrd").write_bytes(header + b"\n\n" + labels().astype(">i8").tobytes(order="F"))
    mesh, _ = mesh_of(tmp_path / "b.nrrd", tmp_path)
    np.testing.assert_array_equal(mesh.vertices, expected.vertices)


def test_parts_that_smoothing_removes_are_reported(tmp_path):
    values = np.zeros(shape, int)
    values[5:20, 5:20, 5:20] = 1
    values[20:45, 12, 12] = 1
    file = write_nifti(tmp_path / "a.nii", values)
    for smooth, lost in [("0.7", True), ("0", False)]:
        command = [sys.executable, script, file, tmp_path / "m.ply", "--smooth", smooth]
        ended = subprocess.run(command, capture_output=True, text=True, check=True)
        assert ("smoothing removes thin parts; keep them with --smooth 0" in ended.stderr) == lost, ended.stderr
