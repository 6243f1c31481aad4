# SPDX-License-Identifier: BSD-3-Clause
"""Makes a mesh of a label map: the surface of one label of a segmentation, in mm.

python3 examples/python/mesh_of_labels.py LABELS.nii.gz MESH.ply
python3 examples/python/mesh_of_labels.py LABELS.nrrd MESH.ply --label 2 --smooth 0

Reads NIfTI with nibabel, and NRRD, whose data may be in one other file (.nhdr). Extracts the surface with the marching
cubes of scikit-image. Needs python3-nibabel and python3-skimage. Applies spacing, origin and direction of the image,
and writes the space of the mesh (SPACE=LPS or SPACE=RAS). The normals point out of the label.
"""

import argparse
import gzip
import math
import re
import sys
import zlib
from pathlib import Path

import numpy as np

SPACES = {"RAS": np.diag([1.0, 1.0, 1.0, 1.0]), "LPS": np.diag([-1.0, -1.0, 1.0, 1.0])}  # to RAS
NRRD_SPACES = {
    "right-anterior-superior": SPACES["RAS"],
    "left-posterior-superior": SPACES["LPS"],
    "left-anterior-superior": np.diag([-1.0, 1.0, 1.0, 1.0]),
}
NRRD_SPACES |= {"ras": SPACES["RAS"], "lps": SPACES["LPS"], "las": NRRD_SPACES["left-anterior-superior"]}
NRRD_TYPES = {
    **dict.fromkeys(["signed char", "int8", "int8_t"], "i1"),
    **dict.fromkeys(["uchar", "unsigned char", "uint8", "uint8_t"], "u1"),
    **dict.fromkeys(["short", "short int", "signed short", "int16", "int16_t"], "i2"),
    **dict.fromkeys(["ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"], "u2"),
    **dict.fromkeys(["int", "signed int", "int32", "int32_t"], "i4"),
    **dict.fromkeys(["uint", "unsigned int", "uint32", "uint32_t"], "u4"),
    **dict.fromkeys(["longlong", "long long", "long long int", "int64", "int64_t"], "i8"),
    **dict.fromkeys(["signed long long", "signed long long int"], "i8"),
    **dict.fromkeys(["ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"], "u8"),
}
MILLIMETERS = {"meter": 1000.0, "mm": 1.0, "micron": 0.001, "unknown": 1.0}


class Unreadable(Exception):
    """A file cannot be read; the message states the cause and what to do."""


def read_nifti(path):
    """Returns the labels, and the matrix (4, 4) from indices to RAS [mm]."""
    import nibabel

    if path.suffix.lower() == ".gz":
        gzip.decompress(path.read_bytes())  # nibabel ignores the checksum after the voxels
    try:
        image = nibabel.load(path)
    except (nibabel.filebasedimages.ImageFileError, nibabel.spatialimages.HeaderDataError):
        raise Unreadable("is no NIfTI file, or was cut short; name a .nii, .nii.gz or .nrrd file") from None
    if "qform_code" not in image.header:
        raise Unreadable("is not NIfTI; save it as .nii.gz or .nrrd")
    if image.header["qform_code"] == 0 and image.header["sform_code"] == 0:
        raise Unreadable("does not state where it is (qform_code and sform_code are 0); save it with its orientation")
    try:
        scale = MILLIMETERS[image.header.get_xyzt_units()[0]]
    except KeyError:
        raise Unreadable("has an unknown code of its unit (xyzt_units); save it again") from None
    return np.asanyarray(image.dataobj), np.diag([scale, scale, scale, 1.0]) @ image.affine


def vectors(fields, name, count):
    """Returns the vectors of a field as columns (3, count)."""
    try:
        parts = re.findall(r"\(([^()]*)\)", fields[name])
        return np.array([[float(number) for number in part.split(",")] for part in parts]).reshape(count, 3).T
    except ValueError:
        raise Unreadable(f"has '{name}: {fields[name]}', not {count} of three numbers in brackets") from None


def read_nrrd(path):
    """Returns the labels, and the matrix (4, 4) from indices to RAS [mm]. Source: "Definition of NRRD File Format"."""
    content = path.read_bytes()
    header, *rest = re.split(rb"\r?\n\r?\n", content, maxsplit=1)
    is_detached = re.search(rb"(?im)^data ?file:", header) is not None
    if not content.startswith(b"NRRD0") or not (rest or is_detached):
        raise Unreadable("is not NRRD, or was cut short")
    fields = {}
    for line in header.decode("ascii", "replace").splitlines()[1:]:
        name, colon, value = line.partition(": ")
        if colon and not line.startswith("#"):
            if name.lower() in fields:
                raise Unreadable(f"states '{name}' twice")
            fields[name.lower()] = value.strip()
    for name in ("type", "sizes", "encoding", "space", "space directions", "space origin"):
        if name not in fields:
            raise Unreadable(f"has no '{name}'; save it from a program that knows its space, such as 3D Slicer")
    for name in ("line skip", "byte skip", "lineskip", "byteskip"):
        if fields.get(name, "0") != "0":
            raise Unreadable(f"has '{name}', which is not read; save it as one .nrrd file")
    units = set(re.findall(r'"(.*?)"', fields.get("space units", "")))
    if units - {"mm"}:
        raise Unreadable(f"has lengths in {', '.join(sorted(units))}; save it in mm")
    sizes = fields["sizes"].split()
    if len(sizes) != 3:
        raise Unreadable(f"has {len(sizes)} axes, not 3; export it as one label map "
                         "(3D Slicer: Segmentations, Export/import models and labelmaps)")  # fmt: skip
    if not all(size.isascii() and size.isdecimal() for size in sizes):
        raise Unreadable(f"has 'sizes: {fields['sizes']}', not three whole numbers")
    kind = NRRD_TYPES.get(fields["type"])
    if kind is None:
        raise Unreadable(f"has numbers of the type '{fields['type']}', not integers, so it is no label map")
    if fields["space"].lower() not in NRRD_SPACES:
        raise Unreadable(f"is in the space '{fields['space']}'; save it as left-posterior-superior")
    data = rest[0] if rest else b""
    if is_detached:
        file = fields.get("data file", fields.get("datafile", ""))
        if re.search(r"^LIST|%\d*d", file):
            raise Unreadable(f"has its data in several files ('{file}'); save it as one .nrrd file")
        data = (path.parent / file).read_bytes()
    if fields["encoding"] in ("gzip", "gz"):
        data = gzip.decompress(data)
    elif fields["encoding"] != "raw":
        raise Unreadable(f"is encoded as '{fields['encoding']}'; save it as raw or gzip")
    shape = [int(size) for size in sizes]
    needed = math.prod(shape) * int(kind[1])
    if len(data) != needed:
        raise Unreadable(f"has {len(data)} bytes for {' x '.join(sizes)} voxels, which take {needed}; copy it again")
    labels = np.frombuffer(data, (">" if fields.get("endian") == "big" else "<") + kind)
    matrix = np.eye(4)
    matrix[:3, :3] = vectors(fields, "space directions", 3)
    matrix[:3, 3:] = vectors(fields, "space origin", 1)
    return labels.reshape(shape, order="F"), NRRD_SPACES[fields["space"].lower()] @ matrix


def chosen_label(labels, label):
    """Returns the requested label, or the only label of the image."""
    if labels.dtype.kind not in "iuf" or not np.isfinite(labels).all():
        raise Unreadable(f"has voxels that are no labels ({labels.dtype.name}, or NaN)")
    present = np.unique(labels[labels != 0])
    if len(present) == 0:
        raise Unreadable("has no labels: all of its voxels are 0")
    if label is None and len(present) == 1:
        return present[0]
    if label is None or label not in present:
        names = ", ".join(f"{number:g}" for number in present[:20])
        names += f" and {len(present) - 20} more" if len(present) > 20 else ""
        raise Unreadable(f"has the labels {names}; choose one of them with --label")
    return label


def surface_of(labels, matrix, label, smooth):
    """Returns the vertices (n, 3) [mm] and the triangles (m, 3) of a label, wound so that normals point outwards."""
    from scipy.ndimage import binary_dilation, gaussian_filter
    from skimage.measure import marching_cubes

    inside = labels == label
    at = [np.flatnonzero(inside.any(axis=tuple({0, 1, 2} - {axis}))) for axis in range(3)]
    low = np.array([indices[0] for indices in at])
    box = inside[tuple(slice(indices[0], indices[-1] + 1) for indices in at)]
    border = 2 + int(np.ceil(4 * smooth))  # closes the surface at the border of the image
    values = np.pad(box, border).astype(np.float32)
    if smooth > 0:
        values = gaussian_filter(values, smooth)
        if values.max() <= 0.5:
            raise Unreadable(f"is too thin at label {label:g} to be smoothed by {smooth:g} voxels; give --smooth 0")
    count = np.count_nonzero(box)
    outside = np.pad(box, border) & (values <= 0.5)
    far = np.count_nonzero(outside & ~binary_dilation(values > 0.5, np.ones((3, 3, 3))))
    if far or np.count_nonzero(outside) > 0.1 * count:
        print(f"{np.count_nonzero(outside)} of {count} voxels of label {label:g} are outside of the surface, {far} by more "
              "than a voxel: smoothing removes thin parts; keep them with --smooth 0", file=sys.stderr)  # fmt: skip
    vertices, triangles, _, _ = marching_cubes(values, 0.5)
    vertices = (vertices.astype(np.float64) + low - border) @ matrix[:3, :3].T + matrix[:3, 3]
    corners = vertices[triangles]
    if np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) < 0:
        triangles = triangles[:, ::-1]
    return vertices, triangles


def write_ply(path, vertices, triangles, comments):
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    header = ["ply", "format binary_little_endian 1.0", *(f"comment {comment}" for comment in comments)]
    header += [f"element vertex {len(vertices)}", *(f"property float {axis}" for axis in "xyz")]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header\n"]
    path.write_bytes("\n".join(header).encode() + vertices.astype("<f4").tobytes() + faces.tobytes())


def main():
    parser = argparse.ArgumentParser(description="Makes a mesh of a label map: the surface of one label, in mm.")
    parser.add_argument("labels", type=Path, help="label map, NIfTI (.nii, .nii.gz) or NRRD (.nrrd)")
    parser.add_argument("mesh", type=Path, help="the mesh file to write (.ply)")
    parser.add_argument("--label", type=int, help="the label to extract, if there are several")
    parser.add_argument("--space", choices=sorted(SPACES), default="LPS", help="space of the mesh (default LPS)")
    parser.add_argument("--smooth", type=float, default=0.7, metavar="VOXELS",
                        help="standard deviation of a Gaussian filter, which rounds the steps between voxels and moves "
                        "the surface; 0 for none (default 0.7)")  # fmt: skip
    given = parser.parse_args()
    if not 0 <= given.smooth <= 10:
        parser.error(f"--smooth: expected a number from 0 to 10, not {given.smooth}")
    if given.mesh.suffix.lower() != ".ply":
        parser.error(f"the mesh is written as PLY: name a .ply file, not '{given.mesh}'")
    try:
        is_nrrd = given.labels.suffix.lower() in (".nrrd", ".nhdr")
        labels, matrix = (read_nrrd if is_nrrd else read_nifti)(given.labels)
        labels = labels.reshape(labels.shape[:3]) if labels.size == np.prod(labels.shape[:3]) else labels
        if labels.ndim != 3:
            raise Unreadable(f"has {labels.ndim} axes, not 3; export the segmentation as one label map")
        if not (np.isfinite(matrix).all() and np.linalg.det(matrix) != 0.0):
            raise Unreadable("has spacings, directions or an origin that place no voxels; save it again")
        label = chosen_label(labels, given.label)
        vertices, triangles = surface_of(labels, SPACES[given.space] @ matrix, label, given.smooth)
    except ImportError as error:
        sys.exit(f"{error}: install python3-nibabel and python3-skimage")
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        sys.exit(f"{given.labels}: is damaged ({error}); copy it again")
    except (Unreadable, OSError, OverflowError, ValueError) as error:
        sys.exit(f"{given.labels}: {error}")
    except MemoryError:
        sys.exit(f"{given.labels}: is larger than the memory of this machine; crop it to the label")
    try:
        write_ply(given.mesh, vertices, triangles, [f"SPACE={given.space}", f"label {label:g}"])
    except OSError as error:
        sys.exit(f"{given.mesh}: cannot be written ({error.strerror})")
    size = " x ".join(f"{length:.1f}" for length in np.ptp(vertices, axis=0))
    print(f"{given.mesh}: label {label:g}, {len(triangles)} triangles, {size} mm, in {given.space}")


if __name__ == "__main__":
    main()
