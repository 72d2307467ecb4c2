"""Smooths the time steps of a series, or the members of an ensemble, spread over the ranks of ParaView's MPI.

    mpiexec -n 4 pvbatch --sym tools/paraview/series_mpi.py SERIES FOLDER --array NAME --persistence 10% [...]
    pvbatch tools/paraview/series_mpi.py SERIES FOLDER --array NAME --persistence 10% [...]

SERIES is a .pvd file, or a pattern such as 'run_*.vti' in quotes. FOLDER gets a file of each step with one more array, and FOLDER/
series.pvd with their times. Each rank takes every n-th step, and no rank waits for another before the end: the files are byte for
byte those of a run on one rank. Steps whose file is there already are not done again (--again does them all). A step that fails
is named, with its error in FOLDER/<step>.error.txt, and the others are done all the same; then the exit code is 1, and 2 if nothing
could be begun.

Every step is read whole by one rank. A step that is itself a parallel data set whose pieces are not joined is refused with advice.
Needs the Python package morsmooth on PYTHONPATH (README.md beside this file); without pvbatch, any Python with the packages
morsmooth, vtk and mpi4py will do.
"""

import argparse
import glob
import json
import os
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from vtkmodules.vtkIOXML import (
    vtkXMLImageDataReader,
    vtkXMLImageDataWriter,
    vtkXMLPImageDataReader,
    vtkXMLPolyDataReader,
    vtkXMLPolyDataWriter,
    vtkXMLPPolyDataReader,
    vtkXMLPRectilinearGridReader,
    vtkXMLPStructuredGridReader,
    vtkXMLPUnstructuredGridReader,
    vtkXMLRectilinearGridReader,
    vtkXMLRectilinearGridWriter,
    vtkXMLStructuredGridReader,
    vtkXMLStructuredGridWriter,
    vtkXMLUnstructuredGridReader,
    vtkXMLUnstructuredGridWriter,
)

KINDS = {
    ".vti": (vtkXMLImageDataReader, vtkXMLImageDataWriter),
    ".vtp": (vtkXMLPolyDataReader, vtkXMLPolyDataWriter),
    ".vtr": (vtkXMLRectilinearGridReader, vtkXMLRectilinearGridWriter),
    ".vts": (vtkXMLStructuredGridReader, vtkXMLStructuredGridWriter),
    ".vtu": (vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter),
    ".pvti": (vtkXMLPImageDataReader, vtkXMLImageDataWriter),
    ".pvtp": (vtkXMLPPolyDataReader, vtkXMLPolyDataWriter),
    ".pvtr": (vtkXMLPRectilinearGridReader, vtkXMLRectilinearGridWriter),
    ".pvts": (vtkXMLPStructuredGridReader, vtkXMLStructuredGridWriter),
    ".pvtu": (vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridWriter),
}


class Refusal(Exception):
    """What makes it useless to begin."""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("series", help=".pvd file, or a pattern in quotes")
    parser.add_argument("folder", type=Path, help="where the results go")
    parser.add_argument("--array", required=True, help="point array")
    wanted = parser.add_mutually_exclusive_group(required=True)
    wanted.add_argument("--persistence", help="keep extrema whose persistence exceeds this part of the range: 10%% or 0.1")
    wanted.add_argument("--persistence-abs", type=float, help="the same, in the units of the array")
    wanted.add_argument("--extrema", type=int, help="keep this many extrema, the most persistent ones")
    parser.add_argument("--mask", help="array whose zeros are holes")
    parser.add_argument("--select", choices=["data", "smooth"], default="data", help="field on which extrema are measured")
    parser.add_argument("--order", type=int, default=2, help="order of the energy, 1 to 4")
    parser.add_argument("--length", help="smoothing length as a part of the diagonal; by cross-validation if absent")
    parser.add_argument("--simplify", action="store_true", help="simplify only, do not smooth")
    parser.add_argument("--threads", type=int, help="threads of each rank; the cores of the machine shared out if absent")
    parser.add_argument("--again", action="store_true", help="do steps again whose files are there")
    return parser.parse_args()


class Ranks:
    """This process among all of them: ParaView's own MPI, or mpi4py's in a plain Python."""

    def __init__(self):
        from vtkmodules.vtkParallelCore import vtkMultiProcessController

        controller = vtkMultiProcessController.GetGlobalController()
        self.rank, self.count, self.barrier = 0, 1, lambda: None
        if controller is not None and controller.GetNumberOfProcesses() > 1:
            self.rank, self.count, self.barrier = controller.GetLocalProcessId(), controller.GetNumberOfProcesses(), controller.Barrier
            self._check_symmetric()
        elif controller is None and any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS")):
            from mpi4py import MPI

            self.rank, self.count, self.barrier = MPI.COMM_WORLD.Get_rank(), MPI.COMM_WORLD.Get_size(), MPI.COMM_WORLD.Barrier

    def _check_symmetric(self):
        try:
            from paraview.servermanager import vtkProcessModule
        except ImportError:
            from paraview.modules.vtkRemotingCore import vtkProcessModule
        module = vtkProcessModule.GetProcessModule()
        if module and not module.GetSymmetricMPIMode():
            raise Refusal("only rank 0 runs the script; expected all of them: pvbatch --sym tools/paraview/series_mpi.py ...")

    def threads(self):
        """Cores for each rank, if all ranks of a job are spread evenly over its machines."""
        here = next((int(os.environ[name]) for name in ("OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS") if name in os.environ), self.count)
        given = os.environ.get("SLURM_CPUS_PER_TASK")
        return int(given) if given else max(1, len(os.sched_getaffinity(0)) // here)


def steps(series):
    """(time, path) of every step, in the order of the series."""
    if not series.endswith(".pvd"):
        found = sorted(glob.glob(series), key=lambda path: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", path)])
        if not found:
            raise Refusal(f"found no file '{series}'; expected a .pvd file, or a pattern that fits some")
        return [(float(number), Path(path)) for number, path in enumerate(found)]
    try:
        entries = ElementTree.parse(series).getroot().iter("DataSet")
        listed = [(float(entry.get("timestep", number)), entry.get("part", "0"), entry.get("file")) for number, entry in enumerate(entries)]
    except (OSError, ElementTree.ParseError, ValueError) as error:
        raise Refusal(f"{series}: {error}") from error
    if any(part != "0" for _, part, _ in listed):
        raise Refusal(f"{series}: a time step has several parts; expected one data set a step")
    if not listed or any(file is None for _, _, file in listed):
        raise Refusal(f"{series}: found {len(listed)} data sets with names of files; expected at least one")
    return [(time, Path(series).parent / file) for time, _, file in listed]


def target(folder, path, names):
    """Where the result of a step goes; steps of one name in several folders keep apart."""
    suffix = path.suffix.replace(".p", ".", 1) if path.suffix.startswith(".pvt") else path.suffix
    stem = path.stem if names[path.stem] == 1 else "_".join(path.with_suffix("").parts[-2:])
    return folder / f"{stem}{suffix}"


def read(path):
    if path.suffix not in KINDS:
        raise ValueError(f"{path}: files {path.suffix} are not read here; expected one of {', '.join(KINDS)}")
    if not path.exists():
        raise FileNotFoundError(f"{path}: there is no such file")
    reader = KINDS[path.suffix][0]()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("VTK cannot read it"))
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    if errors or data.GetNumberOfPoints() == 0:
        raise ValueError(f"{path}: {errors[0] if errors else 'found no points'}")
    return data


def write(data, path):
    """Beside its place first, so that a file that is there is whole."""
    writer = KINDS[path.suffix][1]()
    waiting = path.with_name(f".{path.name}.part")
    writer.SetFileName(str(waiting))
    writer.SetInputData(data)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    if not writer.Write():
        waiting.unlink(missing_ok=True)
        raise OSError(f"{path}: VTK cannot write it")
    os.replace(waiting, path)


def work(args, path, place, threads):
    """One step. What is done for it depends on nothing but the step and the options."""
    import morsmooth

    data = read(path)
    if path.suffix in (".pvtu", ".pvtp") and any(fault.is_cut for fault in morsmooth.faults(data, threads=threads)):
        raise ValueError(
            f"{path}: its pieces are not joined, so there would be false extrema along their borders; expected one piece: "
            f"morsmooth convert {path.name} {path.stem}{path.suffix.replace('.p', '.', 1)} joins them"
        )
    wanted = {"persistence": args.persistence, "persistence_abs": args.persistence_abs, "extrema": args.extrema}
    report = {}
    common = {**wanted, "mask": args.mask, "threads": threads, "report": report}
    if args.simplify:
        result = morsmooth.simplify(data, args.array, **common)
    else:
        result = morsmooth.smooth(data, args.array, select=args.select, order=args.order, length=args.length, **common)
    write(result, place)
    before = report["simplify" if args.simplify else "smooth"]["before"]
    return {"before": before, "wanted": {kind: len(report["wanted"][kind]) for kind in ("minima", "maxima")}}


def main():
    """The exit code, and whether this is the rank that says it."""
    args = arguments()
    is_first = True
    try:
        ranks = Ranks()
        is_first = ranks.rank == 0
        listed = steps(args.series)
        try:
            import morsmooth  # noqa: F401
        except ImportError as error:
            raise Refusal(f"the Python package morsmooth cannot be imported ({error}); see tools/paraview/README.md") from error
        stems = [path.stem for _, path in listed]
        names = {stem: stems.count(stem) for stem in stems}
        places = [target(args.folder, path, names) for _, path in listed]
        if len(set(places)) < len(places):
            raise Refusal(f"{args.series}: two steps would have the same name in {args.folder}; expected names of their own")
        if any(place.exists() and place.samefile(path) for place, (_, path) in zip(places, listed) if path.exists()):
            raise Refusal(f"{args.folder}: the results would take the places of the steps; expected another folder")
        args.folder.mkdir(parents=True, exist_ok=True)
    except (Refusal, OSError) as refusal:
        if is_first:
            print(f"error: {refusal}", file=sys.stderr, flush=True)
        return 2, is_first
    threads = args.threads or ranks.threads()
    for number in range(ranks.rank, len(listed), ranks.count):
        (time, path), place = listed[number], places[number]
        trouble = place.with_name(f"{place.name}.error.txt")
        if place.exists() and not args.again:
            print(f"step {number} ({path.name}): there already", flush=True)
            continue
        trouble.unlink(missing_ok=True)
        # A file of an earlier run must not stand for a step that fails now.
        place.unlink(missing_ok=True)
        try:
            told = work(args, path, place, threads)
            print(f"step {number} ({path.name}), rank {ranks.rank}: {json.dumps(told)}", flush=True)
        except Exception as error:
            trouble.write_text(f"{type(error).__name__}: {error}\n")
    ranks.barrier()
    failed = [number for number, place in enumerate(places) if not place.exists()]
    if ranks.rank == 0:
        lines = [
            f'    <DataSet timestep="{time!r}" part="0" file="{place.name}"/>\n'
            for number, ((time, _), place) in enumerate(zip(listed, places))
            if number not in failed
        ]
        text = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n' + "".join(lines) + "  </Collection>\n</VTKFile>\n"
        (args.folder / "series.pvd").write_text(text)
        for number in failed:
            said = places[number].with_name(f"{places[number].name}.error.txt")
            words = said.read_text().strip() if said.exists() else "no rank has finished it"
            print(f"error: step {number} ({listed[number][1].name}): {words}", file=sys.stderr, flush=True)
        print(f"{len(listed) - len(failed)} of {len(listed)} steps in {args.folder}, {ranks.count} ranks", flush=True)
    ranks.barrier()
    return (1 if failed else 0), is_first


if __name__ == "__main__":
    status, is_first = main()
    # Leaving by sys.exit skips the end of MPI, of which mpiexec complains: only rank 0 does it, and only to say that something failed.
    if status and is_first:
        sys.exit(status)
