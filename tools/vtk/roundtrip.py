"""Compares io's reading and writing with real VTK's, file by file.

    python tools/vtk/roundtrip.py FILES [OUT]

FILES is a folder of VTK files (generate.py, generate_pyvista.py and generate_paraview.py make one each). The program
tools/vtk/probe.rs reads each of them, describes what it read, and writes it back as raw XML, packed XML, legacy, and plain and packed VTKHDF. For each file VTK's own reading of the original is
compared with the description and with VTK's reading of what was written: kind, geometry, every array's type, class,
names, values and role, bit for bit. Pieces of parallel files become one data set without seams here and not in VTK: they are
compared cell by cell, corner by corner, without ghost cells. Steps and blocks within a VTKHDF file are compared one by one. Lists (.vtm, .pvd, .vtpd) go through `morsmooth convert` and are
compared block by block; tables are compared column by column with NumPy.
Exit code 1 if anything is wrong or refused. Needs the packages vtk and numpy, and cargo.
"""

import collections
import json
import os
import re
import subprocess
import sys
import tempfile
from xml.etree import ElementTree

import numpy as np
import vtk
from vtk.util import numpy_support

vtk.vtkObject.GlobalWarningDisplayOff()
HERE = os.path.dirname(os.path.abspath(__file__))
READERS = {
    "vtp": vtk.vtkXMLPolyDataReader,
    "vtu": vtk.vtkXMLUnstructuredGridReader,
    "vti": vtk.vtkXMLImageDataReader,
    "vtr": vtk.vtkXMLRectilinearGridReader,
    "vts": vtk.vtkXMLStructuredGridReader,
    "vtk": vtk.vtkDataSetReader,
    "pvtu": vtk.vtkXMLPUnstructuredGridReader,
    "pvti": vtk.vtkXMLPImageDataReader,
    "pvtp": vtk.vtkXMLPPolyDataReader,
    "pvtr": vtk.vtkXMLPRectilinearGridReader,
    "pvts": vtk.vtkXMLPStructuredGridReader,
    "ply": vtk.vtkPLYReader,
    "stl": vtk.vtkSTLReader,
    "obj": vtk.vtkOBJReader,
    "vtkhdf": vtk.vtkHDFReader,
}
EXTENSIONS = {"PolyData": "vtp", "UnstructuredGrid": "vtu", "ImageData": "vti", "RectilinearGrid": "vtr", "StructuredGrid": "vts"}
LISTS = (".vtm", ".pvd", ".vtpd")
TABLES = (".csv", ".tsv")
MESHES = (".ply", ".stl", ".obj")
ROLES = ["Scalars", "Vectors", "Normals", "TCoords", "Tensors", "GlobalIds", "PedigreeIds"]


class Unreadable(Exception):
    """VTK itself says that it cannot read a file."""


def resolved(path):
    """The file itself, for a list of one file."""
    if not path.endswith(".pvd"):
        return path
    (entry,) = ElementTree.parse(path).getroot().find("Collection").findall("DataSet")
    return os.path.join(os.path.dirname(path), entry.get("file"))


def read(path):
    reader = READERS[path.rsplit(".", 1)[1]]()
    reader.SetFileName(path)
    if path.endswith(".vtk"):
        for switch in ("Scalars", "Vectors", "Fields", "Tensors", "Normals", "TCoords"):
            getattr(reader, f"ReadAll{switch}On")()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(path))
    reader.Update()
    if errors:
        raise Unreadable(path)
    return together(reader.GetOutputDataObject(0))


def together(output):
    """The parts of a VTKHDF file one behind the other; anything else as it is."""
    if not output.IsA("vtkPartitionedDataSet"):
        return output
    parts = [output.GetPartition(i) for i in range(output.GetNumberOfPartitions())]
    append = vtk.vtkAppendPolyData() if parts[0].IsA("vtkPolyData") else vtk.vtkAppendFilter()
    for part in parts:
        append.AddInputData(part)
    append.Update()
    result = append.GetOutput()
    result.SetFieldData(output.GetFieldData())
    return result


def values(array):
    """Type, components and values in the form that probe.rs writes."""
    if array is None:
        return None
    if isinstance(array, vtk.vtkStringArray):
        texts = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
        return {"t": "string", "n": array.GetNumberOfComponents(), "v": texts}
    if isinstance(array, vtk.vtkBitArray):
        bits = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
        return {"t": "Bit", "n": array.GetNumberOfComponents(), "v": bits}
    numbers = numpy_support.vtk_to_numpy(array)
    kind = numbers.dtype.kind.upper() + str(8 * numbers.dtype.itemsize)
    flat = numbers.ravel().tolist()
    if kind[0] == "F":
        flat = ["nan" if q != q else "inf" if q == np.inf else "-inf" if q == -np.inf else q for q in flat]
    return {"t": kind, "n": array.GetNumberOfComponents(), "v": flat}


def details(array):
    """What probe.rs does not describe: whether VTK takes the numbers for ids, and the names of components."""
    names = [array.GetComponentName(i) for i in range(array.GetNumberOfComponents())]
    return [array.GetClassName() == "vtkIdTypeArray", names]


def fields(data, of=values):
    arrays = (data.GetAbstractArray(i) for i in range(data.GetNumberOfArrays()))
    return {array.GetName() or "": of(array) for array in arrays}


def cells(array):
    if array is None or array.GetNumberOfCells() == 0:
        return None
    listed = lambda part: numpy_support.vtk_to_numpy(part).tolist()
    return {"c": listed(array.GetConnectivityArray()), "o": listed(array.GetOffsetsArray())[1:]}


def describe(dataset):
    kind = dataset.GetClassName()[3:].replace("StructuredPoints", "ImageData")
    result = {
        "type": kind,
        "point": fields(dataset.GetPointData()),
        "cell": fields(dataset.GetCellData()),
        "field": fields(dataset.GetFieldData()),
    }
    if kind in ("ImageData", "RectilinearGrid", "StructuredGrid"):
        result["extent"] = list(dataset.GetExtent())
    if kind == "ImageData":
        result["origin"], result["spacing"] = list(dataset.GetOrigin()), list(dataset.GetSpacing())
        matrix = dataset.GetDirectionMatrix()
        result["dir"] = [matrix.GetElement(i, j) for i in range(3) for j in range(3)]
    elif kind == "RectilinearGrid":
        for axis in "xyz":
            result[axis] = values(getattr(dataset, f"Get{axis.upper()}Coordinates")())
    else:
        points = dataset.GetPoints()
        result["points"] = values(points.GetData()) if points else {"t": "F32", "n": 3, "v": []}
    if kind == "PolyData":
        for part in ("Verts", "Lines", "Polys", "Strips"):
            result[part.lower()] = cells(getattr(dataset, f"Get{part}")())
    if kind == "UnstructuredGrid":
        result["cells"] = cells(dataset.GetCells())
        result["types"] = [dataset.GetCellType(i) for i in range(dataset.GetNumberOfCells())]
        result["poly"] = 42 in result["types"]
    return result


def extras(dataset):
    """Classes, component names, roles and faces: compared between VTK's two readings only."""
    result = {}
    for name in ("Point", "Cell"):
        data = getattr(dataset, f"Get{name}Data")()
        result[name] = fields(data, details)
        for role in ROLES:
            active = getattr(data, f"Get{role}")()
            result[name + role] = active.GetName() if active else None
    result["field"] = fields(dataset.GetFieldData(), details)
    if dataset.GetClassName() == "vtkUnstructuredGrid":
        faces = []
        for cell in range(dataset.GetNumberOfCells()):
            if dataset.GetCellType(cell) == 42:
                ids = vtk.vtkIdList()
                dataset.GetFaceStream(cell, ids)
                faces.append([ids.GetId(i) for i in range(ids.GetNumberOfIds())])
        result["faces"] = faces
    return result


def differences(expected, found, path=""):
    """Paths of what differs; numbers must be equal to the last bit."""
    if isinstance(expected, dict) and isinstance(found, dict):
        for key in sorted(set(expected) | set(found)):
            yield from differences(expected.get(key), found.get(key), f"{path}/{key}")
    elif expected != found:
        yield f"{path}: {str(found)[:60]} instead of {str(expected)[:60]}"


def legacy_form(description):
    """What the legacy format keeps of a description: extents start at 0."""
    result = dict(description)
    if "extent" in result:
        extent = result["extent"]
        if "origin" in result:
            result["origin"] = [o + e * s for o, e, s in zip(result["origin"], extent[::2], result["spacing"])]
        result["extent"] = [v for low, high in zip(extent[::2], extent[1::2]) for v in (0, high - low)]
    return result


def hdf_form(description):
    """What VTK finds of a description in a VTKHDF file: bits are bytes, texts are field data only, some
    extents start at 0, names are links."""
    result = dict(description)
    for part in ("point", "cell", "field"):
        renamed = {re.sub("[/.]", "_", name): dict(array) for name, array in result[part].items()}
        for array in renamed.values():
            array["t"] = array["t"].replace("Bit", "U8")
        result[part] = {name: array for name, array in renamed.items() if part == "field" or array["t"] != "string"}
    if "extent" in result and "origin" not in result:
        extent = result["extent"]
        result["extent"] = [v for low, high in zip(extent[::2], extent[1::2]) for v in (0, high - low)]
    return result


def hdf_extras(extras):
    """Roles and faces; the format has no room for names of components, or for which integers are ids."""
    return {key: value for key, value in extras.items() if key not in ("Point", "Cell", "field")}


def corners(description):
    """Every cell as its corners, each with its place and its values: the same whether pieces share points or not."""
    n = len(description["points"]["v"]) // 3
    columns = [np.array(description["points"]["v"]).reshape(n, 3).tolist()]
    for name in sorted(description["point"]):
        array = description["point"][name]
        columns.append(np.array(array["v"], dtype=object).reshape(n, array["n"]).tolist())
    found = []
    for part in ("cells", "verts", "lines", "polys", "strips"):
        cells = description.get(part)
        for start, end in zip([0] + cells["o"][:-1], cells["o"]) if cells else []:
            found.append([part] + [[column[point] for column in columns] for point in cells["c"][start:end]])
    return found


def without_ghosts(dataset):
    """What VTK read of a parallel file without the cells that another piece has too, and without the marks on them."""
    if dataset.IsA("vtkPolyData") or dataset.IsA("vtkUnstructuredGrid"):
        dataset.RemoveGhostCells()
    for data in (dataset.GetPointData(), dataset.GetCellData()):
        data.RemoveArray("vtkGhostType")
    return dataset


def unmarked(description):
    """The same of what was read here."""
    drop = lambda part: {name: array for name, array in description[part].items() if name != "vtkGhostType"}
    return {**description, "point": drop("point"), "cell": drop("cell")}


def seamless(description):
    """A description for comparisons in which the numbers of points do not count, nor normals, which differ at seams."""
    description = {**description, "point": {name: array for name, array in description["point"].items() if name != "Normals"}}
    result = {key: description[key] for key in ("type", "cell", "field", "types") if key in description}
    result["corners"] = corners(description)
    return result


def blocks(path):
    """Every data set of a list by the way to it."""
    if path.endswith(".pvd"):
        entries = ElementTree.parse(path).getroot().find("Collection").findall("DataSet")
        files = [os.path.join(os.path.dirname(path), entry.get("file")) for entry in entries]
        return {entry.get("timestep"): describe(read(file)) for entry, file in zip(entries, files)}
    if path.endswith(".vtpd"):
        reader = vtk.vtkXMLPartitionedDataSetReader()
        reader.SetFileName(path)
        reader.Update()
        whole = reader.GetOutput()
        return {str(place): describe(whole.GetPartition(place)) for place in range(whole.GetNumberOfPartitions())}
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(path)
    reader.Update()
    found = {}

    def walk(data, way):
        for place in range(data.GetNumberOfBlocks()):
            block, meta = data.GetBlock(place), data.GetMetaData(place)
            name = meta.Get(vtk.vtkCompositeDataSet.NAME()) if meta else None
            if block is not None and block.IsA("vtkMultiBlockDataSet"):
                walk(block, way + (place, name))
            else:
                found[str(way + (place, name))] = describe(block) if block is not None else None

    walk(reader.GetOutput(), ())
    return found


def table_faults(path, found):
    """Columns of a table of numbers that were not read as they stand; the column along which it lies is x."""
    rows = np.genfromtxt(path, delimiter="," if path.endswith(".csv") else "\t", names=True, deletechars="", replace_space=" ")
    read_back = {name: array["v"] for name, array in found["point"].items()}
    along = found["field"].get("table_along", {"v": [None]})["v"][0]
    read_back[along] = found["points"]["v"][::3]
    names = [name.strip('"') for name in rows.dtype.names]
    if [name for name in read_back if name is not None and name not in names]:
        yield f": columns {sorted(read_back)} instead of {sorted(names)}"
    for name, column in zip(names, rows.dtype.names):
        if read_back.get(name) != rows[column].tolist():
            yield f"/{name}: {str(read_back.get(name))[:60]} instead of {str(rows[column].tolist())[:60]}"


def probe(*words):
    """What tools/vtk/probe.rs prints."""
    command = ["cargo", "run", "-q", "--release", "--example", "vtk_probe", "--", *words]
    return subprocess.run(command, cwd=os.path.join(HERE, "../.."), stdout=subprocess.PIPE, text=True, check=True).stdout


def members(path):
    """Every step or block within a VTKHDF file, by its address, as VTK reads it."""
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    for step, time in enumerate(times):
        reader.UpdateTimeStep(time)
        yield str(step), describe(together(reader.GetOutputDataObject(0)))
    if times:
        return
    reader.Update()
    output = reader.GetOutputDataObject(0)
    iterator = output.NewIterator()
    while not iterator.IsDoneWithTraversal():
        block = describe(iterator.GetCurrentDataObject())
        # VTK 9.7 leaves the field data of blocks in the file.
        yield iterator.GetCurrentMetaData().Get(vtk.vtkCompositeDataSet.NAME()), {**block, "field": None}
        iterator.GoToNextItem()


def members_are_wrong(path):
    """Whether a step or block within a VTKHDF file is read otherwise than by VTK."""
    wrong = []
    for address, expected in members(path):
        found = json.loads(probe("--describe", f"{path}/{address}"))
        if expected["field"] is None:
            found["field"] = None
        wrong += [f"/{address}{one}" for one in differences(expected, found)]
    for one in wrong[:5]:
        print(f"member   {os.path.basename(path)}{one}")
    return bool(wrong)


def list_is_wrong(path, out):
    """Whether a list differs after `morsmooth convert`."""
    copy = os.path.join(out, "copy_" + os.path.basename(path))
    command = ["cargo", "run", "-q", "--release", "--bin", "morsmooth", "--", "convert", path, copy, "-q"]
    if subprocess.run(command, cwd=os.path.join(HERE, "../..")).returncode:
        return True
    wrong = list(differences(blocks(path), blocks(copy)))
    for one in wrong[:5]:
        print(f"list     {os.path.basename(path)}{one}")
    return bool(wrong)


def main():
    files = os.path.abspath(sys.argv[1])
    out = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else tempfile.mkdtemp()
    listing = probe(files, out)
    counts = {"reading": collections.Counter(), "writing": collections.Counter()}
    for line in listing.splitlines():
        status, name, *message = line.split("\t")
        if status == "refused" and name.endswith(LISTS):
            counts["reading"]["list wrong" if list_is_wrong(os.path.join(files, name), out) else "list ok"] += 1
            continue
        if status == "refused" and name.endswith(".vtkhdf") and "a collection of" in "".join(message):
            counts["reading"]["members wrong" if members_are_wrong(os.path.join(files, name)) else "members ok"] += 1
            continue
        if status != "read":
            counts["reading"][status] += 1
            print(f"{status:8} {name}: {' '.join(message)}")
            continue
        path = os.path.join(files, name)
        found = json.load(open(os.path.join(out, "json", name + ".json")))
        if name.endswith(TABLES):
            wrong = [f"wrong    {name}{one}" for one in table_faults(path, found)]
            counts["reading"]["table wrong" if wrong else "table ok"] += 1
            print(*wrong, sep="\n", end="\n" * bool(wrong))
            continue
        try:
            path = resolved(path)
            original = read(path)
        except Unreadable:
            counts["reading"]["VTK cannot"] += 1
            continue
        is_parallel = path.endswith((".pvtu", ".pvtp")) or name.startswith("parts")
        is_whole = path.endswith((".pvti", ".pvtr", ".pvts", ".pvtu", ".pvtp"))
        if is_whole:
            original = without_ghosts(original)
        expected, more = describe(original), extras(original)
        if is_parallel:
            wrong = list(differences(seamless(expected), seamless(unmarked(found))))
        else:
            wrong = list(differences(expected, unmarked(found) if is_whole else found))
        # VTK 9.7 does not read the axes of the pieces of a parallel image, and 9.2 does not write them into the list.
        wrong = [one for one in wrong if not (name.endswith(".pvti") and one.startswith("/dir:"))]
        # VTK 9.7 loses a cell without points that stands alone in a legacy file.
        wrong = [one for one in wrong if name != "cell_Empty.vtk"]
        # The places and cells of a .obj file are read, and no more.
        wrong = [one for one in wrong if not (name.endswith(".obj") and one.startswith(("/cell/", "/point/")))]
        # VTK's parser drops the sign of -inf in XML ascii; the file says -inf.
        wrong = [one for one in wrong if not (name.startswith("nan__ascii") and "nanf" in one)]
        # VTK 9.7 puts strips before polygons when it joins the cell arrays of pieces, but not when it joins the cells.
        wrong = [one for one in wrong if not (name == "poly_two_pieces.vtp" and "/cell/" in one)]
        counts["reading"]["wrong" if wrong else "ok"] += 1
        for one in wrong:
            print(f"wrong    {name}{one}")
        for form in ("raw", "zlib", "legacy", "hdf", "hdf_zlib"):
            extension = {"legacy": "vtk", "hdf": "vtkhdf", "hdf_zlib": "vtkhdf"}.get(form, EXTENSIONS[expected["type"]])
            path = os.path.join(out, form, f"{name}.{extension}")
            if not os.path.exists(path):
                counts["writing"][f"{form} not written"] += 1
                continue
            written = read(path)
            want, got = (found, describe(written))
            more_want, more_got = more, extras(written)
            if form == "legacy":
                want = legacy_form(want)
            if form.startswith("hdf"):
                want = hdf_form(want)
                more_want, more_got = hdf_extras(more_want), hdf_extras(more_got)
            is_changed = is_parallel or is_whole or name.endswith(MESHES)
            wrong = list(differences(want, got)) + ([] if is_changed else list(differences(more_want, more_got)))
            counts["writing"][f"{form} {'wrong' if wrong else 'ok'}"] += 1
            for one in wrong[:5]:
                print(f"{form:8} {name}{one}")
    print(json.dumps(counts, indent=1))
    return any("wrong" in key or key in ("panic", "refused") for part in counts.values() for key in part)


if __name__ == "__main__":
    sys.exit(main())
